BEGIN { print "scene,cells,fifo_words,us_per_ray,busiest_works" }
{ print at("scene"), at("cells"), at("fifo_words"), sprintf("%.1f,%.3f", at("us_per_ray"), at("busiest_cell_works")) }
