BEGIN { print "scene,array,link_mb_s,us_per_ray,times_as_long" }
{
    array = (("cells" in column) ? at("program") " " at("cells") : "pipeline")
    key[++rows] = at("scene") "," array; rate[rows] = at("link_mb_s"); time[rows] = at("us_per_ray")
}
at("link_mb_s") == 160 { least[key[rows]] = at("us_per_ray") }
END { for (i = 1; i <= rows; i++) print key[i], rate[i], sprintf("%.1f,%.3f", time[i], time[i] / least[key[i]]) }
