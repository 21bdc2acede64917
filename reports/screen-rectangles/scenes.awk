BEGIN { print "scene,sent,not_sent,hit,pipeline,broadcast,hybrid,of_scene_sent" }
at("rectangles") == "scene" { whole[at("scene")] = at("sent"); next }
{ s = at("scene"); saved[s, at("mode")] = at("saved") }
!(s in sent) { order[++scenes] = s; sent[s] = at("sent"); not_sent[s] = at("not_sent"); hit[s] = at("hit") }
END {
    for (i = 1; i <= scenes; i++) {
        s = order[i]
        print s, sent[s], not_sent[s], hit[s], saved[s, "pipeline"], saved[s, "broadcast"], saved[s, "hybrid"], whole[s]
    }
}
