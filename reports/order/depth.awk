# The time over the work of the busiest cell, by the depth of FIFOs.
BEGIN { print "scene,order,cells,fifo_words,us_per_ray,over_busiest" }
{
    o = at("order"); sub(/:1$/, "", o)
    print at("scene"), o, at("cells"), at("fifo_words"), sprintf("%.1f,%.3f", at("us_per_ray"), 1 / at("busiest_cell_works"))
}
