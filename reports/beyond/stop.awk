BEGIN { print "scene,grid_coefficient,w,us_per_ray,faster_than_without,faster_than_one_cell,busiest_works" }
{ k = at("scene") "," at("grid_coefficient") }
FILENAME ~ /one-cell/ { one[k] = at("us_per_ray"); next }
FILENAME ~ /without/ { without[k] = at("us_per_ray"); next }
{
    print k, at("stop_words"), sprintf("%.1f,%.2f,%.2f", at("us_per_ray"), without[k] / at("us_per_ray"), \
        one[k] / at("us_per_ray")), sprintf("%.3f", at("busiest_cell_works"))
}
