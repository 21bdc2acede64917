# Of the time of all cells: the work of one cell alone (efficiency), the grid's start paid again in each further cell
# (floor), more or less work than one cell had (extra), words, what the mean cell works less than the busiest
# (imbalance), and the time in which even the busiest does not work (in_step).
BEGIN { print "scene,partition,cells,us_per_ray,speed_up,efficiency,floor,extra,moving,imbalance,in_step,copies" }
{ work = at("grid_us") + at("slabs_us") + at("intersection_us"); n = at("array_cells") }
n == 1 { time[at("scene")] = at("us_per_ray"); alone[at("scene")] = work; next }
{
    s = at("scene"); all = n * at("us_per_ray"); floor = 30 * (n - 1)
    mean = (work + at("moving_us")) / all; busiest = at("busiest_cell_works")
    print s, at("partition"), n, sprintf("%.1f,%.2f,%.3f,%.3f,%.3f,%.3f,%.3f,%.3f,%.2f", at("us_per_ray"), \
        time[s] / at("us_per_ray"), time[s] / all, floor / all, (work - alone[s] - floor) / all, at("moving_us") / all, \
        busiest - mean, 1 - busiest, at("placed_polygons") / at("polygons"))
}
