# The grid's steps a ray, for walks to the end of the grid and for walks that stop at the hit, over the annex's bound: the cube root of the
# number of voxels.
BEGIN { print "scene,voxels_to_the_end,voxels_to_the_hit,bound,to_the_end_over_bound,to_the_hit_over_bound" }
at("grid_coefficient") != 50 { next }
{ s = at("scene"); v = at("voxels") / at("ray_count") }
FILENAME ~ /sequential/ { if (at("program") == "broadcast") { hit[s] = v; order[++scenes] = s; bound[s] = (50 * at("polygons")) ^ (1 / 3) } next }
at("order") == "raster" { all[s] = v }
END {
    for (i = 1; i <= scenes; i++) {
        s = order[i]
        print s, sprintf("%.1f,%.1f,%.1f,%.2f,%.2f", all[s], hit[s], bound[s], all[s] / bound[s], hit[s] / bound[s])
    }
}
