BEGIN { print "scene,cells,words_of_x,words_of_y,us_per_ray,faster" }
{ k = at("scene") "," at("cells") }
!(k in base) { base[k] = at("us_per_ray") }
{ print k, at("x_fifo_words"), at("y_fifo_words"), sprintf("%.1f,%.3f", at("us_per_ray"), base[k] / at("us_per_ray")) }
