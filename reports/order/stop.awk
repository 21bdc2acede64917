# Stop words against the macro-pipeline without them and one cell, on the same grid and in the same order.
BEGIN { print "scene,order,grid_coefficient,w,us_per_ray,faster_than_without,faster_than_one_cell" }
{ s = at("scene"); g = at("grid_coefficient"); t = at("us_per_ray"); o = ("order" in column) ? at("order") : ""; sub(/:1$/, "", o) }
FILENAME ~ /sequential|one-cell/ { if (!("program" in column) || at("program") == "broadcast") one[s, g] = t; next }
FILENAME ~ /pipelines/ { without[s, o, g] = t; next }
{
    print s, o, g, at("stop_words"), sprintf("%.1f,%.3f,%.3f", t, without[s, o, g] / t, one[s, g] / t)
}
