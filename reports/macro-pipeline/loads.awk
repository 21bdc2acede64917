BEGIN { print "scene,grid_coefficient,what,us_per_ray" }
function line(what, us) { print at("scene"), at("grid_coefficient"), what, sprintf("%.1f", us) }
{ line("P1 grid", at("grid_us")); line("P2 slabs", at("slabs_us")); line("P3 intersection", at("intersection_us"))
  line("a ray", at("us_per_ray")) }
