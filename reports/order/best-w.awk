# The best W of those tried, a scene, an order and a grid.
BEGIN { print "scene,order,grid_coefficient,best_w,faster_than_without,faster_than_one_cell" }
{ k = at("scene") "," at("order") "," at("grid_coefficient"); f = at("faster_than_without") + 0 }
!(k in best) { rows[++count] = k }
!(k in best) || f > best[k] { best[k] = f; rest[k] = at("w") "," at("faster_than_without") "," at("faster_than_one_cell") }
END { for (i = 1; i <= count; i++) print rows[i], rest[rows[i]] }
