# Times under other readings of the machine, against the standard one.
BEGIN { print "scene,order,array,machine,us_per_ray,times_as_long" }
{
    o = at("order"); sub(/:1$/, "", o); m = at("machine"); gsub(/.*\/|\.ron$/, "", m)
    key[++rows] = at("scene") "," o "," (at("mode") == "pipeline" ? "pipeline" : "broadcast " at("cells"))
    name[rows] = m; time[rows] = at("us_per_ray")
}
m == "pcs" { least[key[rows]] = at("us_per_ray") }
END { for (i = 1; i <= rows; i++) if (name[i] != "pcs") print key[i], name[i], sprintf("%.2f,%.3f", time[i], time[i] / least[key[i]]) }
