BEGIN { print "scene,masks,host_mask_us,saved" }
at("masks") == "off" { if (at("partition") == "work" && at("array_cells") == 16) cycles[at("scene")] = at("cycles"); next }
!("host_mask_us" in column) { next }
{ print at("scene"), at("masks"), at("host_mask_us"), sprintf("%.3f", 1 - at("cycles") / cycles[at("scene")]) }
