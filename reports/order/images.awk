# Whole images: each array against one cell on the same grid, and its time over the work of its busiest cell.
BEGIN { print "scene,order,array,partition,grid_coefficient,us_per_ray,speed_up,over_busiest" }
{ s = at("scene"); g = ("grid_coefficient" in column) ? at("grid_coefficient") : 50; t = at("us_per_ray") }
FILENAME ~ /one-cell/ { alone[s, g] = t; next }
{
    o = at("order"); sub(/:1$/, "", o)
    a = at("mode") == "pipeline" ? "pipeline" : at("array_cells")
    print s, o, a, ("partition" in column) ? at("partition") : "-", g, sprintf("%.2f,%.3f,%.3f", t, alone[s, g] / t, 1 / at("busiest_cell_works"))
}
