# Where the workers' time goes in the smaller image, a row for each part.
BEGIN { print "workers,what,share"; n = split("computing messages waiting_scene waiting_master idle", parts, " ") }
at("size") == "100x100" { for (i = 1; i <= n; i++) print at("workers"), parts[i], at(parts[i]) }
