BEGIN { print "scene,cells,broadcast,hybrid,hybrid_3,winner" }
{ k = at("scene") "," at("cells"); t[k, at("program")] = at("us_per_ray") }
!(k in seen) { seen[k] = 1; order[++rows] = k }
END {
    for (i = 1; i <= rows; i++) {
        k = order[i]; b = t[k, "broadcast"]; h = t[k, "hybrid"]; p = t[k, "hybrid-3"]
        least = b + 0; winner = "broadcast"
        if (h != "" && h + 0 < least) { least = h + 0; winner = "hybrid" }
        if (p != "" && p + 0 < least) { least = p + 0; winner = "hybrid-3" }
        print k, b, h, p, winner
    }
}
