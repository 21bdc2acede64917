# The macro-pipeline at the paper's grid and at its best one, in each order, against one cell on that grid and on that cell's best grid.
BEGIN { print "scene,order,at_grid,us_per_ray,over_busiest,against_one_cell,at_50,against_one_cell_at_50,over_busiest_at_50,p1,p2,p3,p3_least" }
{ s = at("scene"); g = at("grid_coefficient"); t = at("us_per_ray") + 0 }
FILENAME ~ /sequential/ {
    if (at("program") != "broadcast") next
    if (!(s in one) || t < one[s]) one[s] = t
    if (g == 50) one_50[s] = t
    next
}
{
    o = at("order"); sub(/:1$/, "", o); k = s "," o
    if (!(k in best)) rows[++count] = k
    scene[k] = s
    if (!(k in best) || t < best[k]) { best[k] = t; grid[k] = g; over[k] = 1 / at("busiest_cell_works"); p1[k] = at("grid_us"); p2[k] = at("slabs_us"); p3[k] = at("intersection_us") }
    if (g == 50) { fifty[k] = t; over_50[k] = 1 / at("busiest_cell_works") }
}
END {
    for (i = 1; i <= count; i++) {
        k = rows[i]; s = scene[k]
        print k, grid[k], sprintf("%.1f,%.3f,%.3f,%.1f,%.3f,%.3f,%.1f,%.1f,%.1f", best[k], over[k], one[s] / best[k], fifty[k], one_50[s] / fifty[k], over_50[k], p1[k], p2[k], p3[k]), \
            (p3[k] + 0 < p1[k] + 0 && p3[k] + 0 < p2[k] + 0) ? "yes" : "no"
    }
}
