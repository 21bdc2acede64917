# 16 cells as P arrays of 16 / P cells, each with a copy of the scene and every P-th ray of the random order: each takes a P-th of the
# time that one takes for all rays.
BEGIN { print "scene,copies,cells_of_each,us_per_ray,speed_up,kwords_a_cell,of_the_scene" }
{ s = at("scene"); n = at("array_cells"); t = at("us_per_ray"); words = at("fullest_memory_words") / 1000; p = 16 / n }
n == 1 { alone[s] = t; whole[s] = words }
{ print s, p, n, sprintf("%.2f,%.2f,%.1f,%.4f", t / p, alone[s] * p / t, words, words / whole[s]) }
