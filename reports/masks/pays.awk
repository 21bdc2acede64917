BEGIN { print "scene,masks,host_mask_us,saved" }
!("masks" in column) { if (at("partition") == "work" && at("array_cells") == 16) cycles[at("scene")] = at("cycles"); next }
{ print at("scene"), at("masks"), at("host_mask_us"), sprintf("%.3f", 1 - at("cycles") / cycles[at("scene")]) }
