BEGIN { print "scene,mode,rectangles,sent,not_sent,hit,saved,us_per_sample" }
at("screen_rectangles") == "off" { cycles[at("scene"), at("mode")] = at("cycles"); rays = at("ray_count"); next }
{
    print at("scene"), at("mode"), at("screen_rectangles"), at("ray_count"), \
        sprintf("%.3f,%.3f,%.3f,%.1f", 1 - at("ray_count") / rays, at("hits") / at("ray_count"), \
        1 - at("cycles") / cycles[at("scene"), at("mode")], 1e6 * at("seconds") / rays)
}
