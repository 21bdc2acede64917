# Which program is fastest.
BEGIN { print "scene,order,cells,winner,us_per_ray" }
{ k = at("scene") "," at("order") "," at("cells"); t = at("us_per_ray") + 0 }
!(k in best) { rows[++count] = k }
!(k in best) || t < best[k] { best[k] = t; winner[k] = at("program") }
END { for (i = 1; i <= count; i++) print rows[i], winner[rows[i]], best[rows[i]] }
