BEGIN { print "scene,grid_coefficient,fifo_words,times_as_long" }
{ key[++rows] = at("scene") "," at("grid_coefficient"); words[rows] = at("fifo_words"); time[rows] = at("us_per_ray") }
at("fifo_words") == 1048576 { least[key[rows]] = at("us_per_ray") }
END { for (i = 1; i <= rows; i++) if (words[i] < 1048576) print key[i], words[i], sprintf("%.3f", time[i] / least[key[i]]) }
