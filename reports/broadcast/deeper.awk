BEGIN { print "scene,order,cells,fifo_words,us_per_ray,busiest_works" }
{ o = ("order" in column) ? "shuffle" : "raster"; print at("scene"), o, at("cells"), at("fifo_words"), sprintf("%.1f,%.3f", at("us_per_ray"), at("busiest_cell_works")) }
