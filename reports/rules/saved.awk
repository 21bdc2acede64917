BEGIN { print "scene,mode,cells,rules,rays,slab_tests,intersection_tests,cycles" }
{ key = at("scene") SUBSEP at("mode") }
at("rules") == "none" {
    rays[key] = at("ray_count"); slabs[key] = at("slab_tests"); tests[key] = at("intersection_tests"); cycles[key] = at("cycles"); next
}
{
    print at("scene"), at("mode"), at("array_cells"), at("rules"), sprintf("%.3f,%.3f,%.3f,%.3f", \
        1 - at("ray_count") / rays[key], 1 - at("slab_tests") / slabs[key], \
        1 - at("intersection_tests") / tests[key], 1 - at("cycles") / cycles[key])
}
