BEGIN { print "scene,cells,fifo_words,k,us_per_ray,faster" }
{ k = at("scene") "," at("cells") "," at("fifo_words") "," at("forward_ahead"); order[++rows] = k; time[k] = at("us_per_ray")
  base[k] = at("scene") "," at("cells") "," at("fifo_words") ",0" }
END { for (i = 1; i <= rows; i++) { k = order[i]; print k, sprintf("%.1f,%.4f", time[k], time[base[k]] / time[k]) } }
