# The exponent of the polygons: the slope of the least squares line through the logarithms.
BEGIN { print "scene,on_the_best_grid,on_the_grid_of_50" }
function add(s, k, y) { sy[s, k] += y; sxy[s, k] += x * y }
function slope(s, k) { return (n[s] * sxy[s, k] - sx[s] * sy[s, k]) / (n[s] * sxx[s] - sx[s] * sx[s]) }
{
    s = at("scene"); x = log(at("polygons"))
    if (!(s in n)) order[++scenes] = s
    n[s]++; sx[s] += x; sxx[s] += x * x; add(s, 1, log(at("us_per_ray"))); add(s, 2, log(at("at_50")))
}
END { for (i = 1; i <= scenes; i++) { s = order[i]; print s, sprintf("%.3f,%.3f", slope(s, 1), slope(s, 2)) } }
