BEGIN { print "scene,host_filter_us,saved" }
at("screen_rectangles") == "off" { cycles[at("scene")] = at("cycles"); next }
{ print at("scene"), at("host_filter_us"), sprintf("%.3f", 1 - at("cycles") / cycles[at("scene")]) }
