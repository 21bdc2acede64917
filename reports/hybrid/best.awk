# The best of both partitions and both grids, µs a ray.
BEGIN { print "scene,cells,program,us_per_ray,partition,grid_coefficient,fullest_memory_words" }
{
    program = ("program" in column) ? at("program") : at("mode") == "pipeline" ? "hybrid-3" : at("mode")
    k = at("scene") "," at("array_cells") "," program; t = at("us_per_ray") + 0
}
!(k in best) { order[++rows] = k }
!(k in best) || t < best[k] {
    best[k] = t
    rest[k] = (("partition" in column) ? at("partition") : "-") "," at("grid_coefficient") "," at("fullest_memory_words")
}
END { for (i = 1; i <= rows; i++) print order[i], sprintf("%.1f", best[order[i]]), rest[order[i]] }
