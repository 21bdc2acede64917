BEGIN { print "scene,order,grid_coefficient,fifo_words,times_as_long,over_busiest" }
{
    o = at("order"); sub(/:1$/, "", o); key[++rows] = at("scene") "," o "," at("grid_coefficient")
    words[rows] = at("fifo_words"); time[rows] = at("us_per_ray"); over[rows] = 1 / at("busiest_cell_works")
}
at("fifo_words") == 1048576 { least[key[rows]] = at("us_per_ray") }
END { for (i = 1; i <= rows; i++) print key[i], words[i], sprintf("%.3f,%.3f", time[i] / least[key[i]], over[i]) }
