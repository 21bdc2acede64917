# Times against links of 160 Mbyte/s.
BEGIN { print "scene,order,cells,link_mb_s,us_per_ray,times_as_long" }
{
    o = at("order"); sub(/:1$/, "", o)
    key[++rows] = at("scene") "," o "," at("cells"); rate[rows] = at("link_mb_s"); time[rows] = at("us_per_ray")
}
at("link_mb_s") == 160 { least[key[rows]] = at("us_per_ray") }
END { for (i = 1; i <= rows; i++) print key[i], rate[i], sprintf("%.2f,%.3f", time[i], time[i] / least[key[i]]) }
