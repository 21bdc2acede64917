BEGIN { print "scene,grid_coefficient,p1,p2,p3,a_ray,busiest_works,at_50,memory_words" }
{ s = at("scene"); t = at("us_per_ray") + 0 }
!(s in best) { order[++scenes] = s }
!(s in best) || t < best[s] {
    best[s] = t
    row[s] = at("grid_coefficient") "," sprintf("%.1f,%.1f,%.1f,%.1f,%.3f", at("grid_us"), at("slabs_us"), \
        at("intersection_us"), t, at("busiest_cell_works")); memory[s] = at("fullest_memory_words")
}
at("grid_coefficient") == 50 { fifty[s] = sprintf("%.1f", t) }
END { for (i = 1; i <= scenes; i++) { s = order[i]; print s, row[s], fifty[s], memory[s] } }
