# What slabs gain where each variant has its best grid, and where both have the paper's.
BEGIN { print "scene,all,best_t1,at_grid_1,words_1,best_t2,at_grid_2,words_2,gain,gain_at_50,words_2_over_1,coarser" }
{ s = at("scene"); k = (at("program") == "broadcast") ? 2 : 1; t = at("us_per_ray") + 0; g = at("grid_coefficient") }
!(s in seen) { seen[s] = 1; order[++scenes] = s }
!((s, k) in best) || t < best[s, k] { best[s, k] = t; grid[s, k] = g; words[s, k] = at("fullest_memory_words") }
g == 50 { fifty[s, k] = t }
END {
    for (i = 1; i <= scenes; i++) {
        s = order[i]
        print s, "scenes", sprintf("%.1f", best[s, 1]), grid[s, 1], words[s, 1], sprintf("%.1f", best[s, 2]), grid[s, 2], words[s, 2], \
            sprintf("%.3f,%.3f,%.2f", 1 - best[s, 2] / best[s, 1], 1 - fifty[s, 2] / fifty[s, 1], words[s, 2] / words[s, 1]), (grid[s, 2] + 0 < grid[s, 1] + 0) ? "yes" : "no"
    }
}
