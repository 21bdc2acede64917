BEGIN { print "scene,by,mode,oversampled,times_as_long,mean_square,error_left" }
at("by") == "none" { cycles = at("cycles"); pixels = at("samples"); error = at("mean_square") }
{
    print at("scene"), at("by"), at("mode"), sprintf("%.3f,%.2f,%.3f,%.3f", at("by") == "all" ? 1 : at("refined") / pixels, \
        at("cycles") / cycles, at("mean_square"), at("mean_square") / error)
}
