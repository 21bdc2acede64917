BEGIN { print "scene,mode,cells,partition,masks,starts_left,saved" }
{ key = at("scene") SUBSEP at("mode") SUBSEP at("array_cells") SUBSEP at("partition") }
at("masks") == "off" { cycles[key] = at("cycles"); grid[key] = at("grid_us"); next }
{
    print at("scene"), at("mode"), at("array_cells"), at("partition"), at("masks"), \
        sprintf("%.3f,%.3f", at("grid_us") / grid[key], 1 - at("cycles") / cycles[key])
}
