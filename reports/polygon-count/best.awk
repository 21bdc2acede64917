# The best grid of each size, and the paper's.
BEGIN { print "scene,polygons,at_grid,us_per_ray,at_50" }
{ k = at("scene") "," at("polygons"); t = at("us_per_ray") + 0; g = at("grid_coefficient") }
!(k in best) { rows[++count] = k }
!(k in best) || t < best[k] { best[k] = t; grid[k] = g }
g == 50 { fifty[k] = t }
END { for (i = 1; i <= count; i++) { k = rows[i]; print k, grid[k], sprintf("%.1f,%.1f", best[k], fifty[k]) } }
