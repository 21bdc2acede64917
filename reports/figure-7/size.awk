BEGIN { print "scene,order,size,array,us_per_ray,against_512x512" }
{
    name = at("program") == "broadcast" ? "broadcast " at("cells") : at("cells") == 3 ? "pipeline" : "8 pipelines"
    o = at("order"); sub(/:1$/, "", o); key[++rows] = at("scene") SUBSEP name SUBSEP o; size[rows] = at("size"); time[rows] = at("us_per_ray")
    if (at("size") == "512x512") full[at("scene"), name, o] = at("us_per_ray")
}
END {
    for (i = 1; i <= rows; i++) {
        split(key[i], part, SUBSEP)
        print part[1], part[3], size[i], part[2], sprintf("%.1f", time[i]), sprintf("%.3f", time[i] / full[key[i]])
    }
}
