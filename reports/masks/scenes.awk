BEGIN { print "scene,cells_8,cells_16,cells_32,work_8,work_16,work_32,hybrid_work_32,pipeline" }
at("masks") != "boxes" { next }
{ s = at("scene"); saved[s, at("mode"), at("partition"), at("cells")] = at("saved") }
!(s in seen) { order[++scenes] = s; seen[s] = 1 }
END {
    for (i = 1; i <= scenes; i++) {
        s = order[i]
        print s, saved[s, "broadcast", "regular", 8], saved[s, "broadcast", "regular", 16], saved[s, "broadcast", "regular", 32], \
            saved[s, "broadcast", "work", 8], saved[s, "broadcast", "work", 16], saved[s, "broadcast", "work", 32], \
            saved[s, "hybrid", "work", 32], saved[s, "pipeline", "regular", 3]
    }
}
