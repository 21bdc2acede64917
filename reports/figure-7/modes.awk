BEGIN { print "scene,voxels,slab_tests,intersection_tests,one_cell,p1,p2,p3,pipeline,broadcast_3,broadcast_24,pipelines_8" }
function rounded(x) { return sprintf("%.1f", x) }
FILENAME ~ /one-cell/ {
    order[++scenes] = s = at("scene"); n = at("ray_count")
    counts[s] = rounded(at("voxels") / n) "," rounded(at("slab_tests") / n) "," rounded(at("intersection_tests") / n)
    time[s, "one"] = rounded(at("us_per_ray")); next
}
{ s = at("scene"); time[s, at("program"), at("cells")] = rounded(at("us_per_ray")) }
at("program") == "hybrid-3" && at("cells") == 3 {
    stages[s] = rounded(at("grid_us")) "," rounded(at("slabs_us")) "," rounded(at("intersection_us"))
}
END {
    for (i = 1; i <= scenes; i++) {
        s = order[i]
        print s, counts[s], time[s, "one"], stages[s], time[s, "hybrid-3", 3], time[s, "broadcast", 3], \
            time[s, "broadcast", 24], time[s, "hybrid-3", 24]
    }
}
