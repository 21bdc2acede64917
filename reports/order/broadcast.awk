# Each array beside one cell on the same grid; its time over the work of its busiest cell; what the mean cell works of what the busiest does
# (balance); and the grid's start, which each cell pays for each ray, as a share of the time (floor).
BEGIN { print "scene,order,cells,partition,us_per_ray,speed_up,efficiency,over_busiest,balance,floor" }
{ s = at("scene"); t = at("us_per_ray"); n = at("array_cells") }
n == 1 { if (at("grid_coefficient") == 50) alone[s] = t; next }
{
    o = at("order"); sub(/:1$/, "", o)
    print s, o, n, at("partition"), sprintf("%.1f,%.2f,%.3f,%.3f,%.3f,%.3f", t, alone[s] / t, alone[s] / t / n, 1 / at("busiest_cell_works"), \
        at("mean_works") / at("busiest_cell_works"), 30 / t)
}
