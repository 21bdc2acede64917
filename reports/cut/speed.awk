# Each array beside one cell: how many times as fast, and how much of the time its busiest cell works. Order "shuffle" is shuffle:1.
BEGIN { print "scene,order,cells,partition,numbering,bounded,us_per_ray,speed_up,busiest_works" }
{ n = at("array_cells"); s = at("scene"); t = at("us_per_ray") }
n == 1 { if (!(s in alone)) alone[s] = t; next }
{
    o = at("order"); sub(/:.*/, "", o)
    print s, o, n, at("partition"), at("numbering"), at("bounded_walk") == "true" ? "yes" : "no", sprintf("%.1f,%.2f,%.3f", \
        t, alone[s] / t, at("busiest_cell_works"))
}
