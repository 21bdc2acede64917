BEGIN { print "scene,grid_coefficient,t1,t2,gain,voxels,nb_filter1" }
at("program") != "broadcast" { t1[at("scene"), at("grid_coefficient")] = at("us_per_ray"); next }
{
    one = t1[at("scene"), at("grid_coefficient")]
    print at("scene"), at("grid_coefficient"), sprintf("%.1f,%.1f,%.3f,%.1f,%.2f", one, at("us_per_ray"), \
        1 - at("us_per_ray") / one, at("voxels") / at("ray_count"), at("slab_tests") / at("ray_count"))
}
