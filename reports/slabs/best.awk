BEGIN { print "scene,t0,best_t1,at_grid_1,words_1,best_t2,at_grid_2,words_2,gain" }
{ s = at("scene"); k = (at("program") == "broadcast") ? 2 : 1; t = at("us_per_ray") + 0 }
!(s in t0) { order[++scenes] = s; t0[s] = 1 + 30 * at("polygons") }
!((s, k) in best) || t < best[s, k] { best[s, k] = t; grid[s, k] = at("grid_coefficient"); words[s, k] = at("fullest_memory_words") }
END {
    for (i = 1; i <= scenes; i++) {
        s = order[i]
        print s, t0[s], sprintf("%.1f", best[s, 1]), grid[s, 1], words[s, 1], sprintf("%.1f", best[s, 2]), grid[s, 2], \
            words[s, 2], sprintf("%.3f", 1 - best[s, 2] / best[s, 1])
    }
}
