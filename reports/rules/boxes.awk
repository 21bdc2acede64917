BEGIN { print "scene,cells,starts_left,saved" }
at("masks") == "off" { grid[at("scene")] = at("grid_us"); cycles[at("scene")] = at("cycles"); next }
{ s = at("scene"); print s, at("array_cells"), sprintf("%.3f,%.3f", at("grid_us") / grid[s], 1 - at("cycles") / cycles[s]) }
