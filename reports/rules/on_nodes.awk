BEGIN { print "scene,nodes,own_work,own_cycles,a4b_rays,a4b_ray_messages,a4b_work,a4b_cycles,both_cycles" }
{ s = at("scene"); cycles = at("cycles") }
at("rules") == "none" { all[s] = cycles; work[s] = at("one_node_seconds"); rays[s] = at("ray_count"); sent[s] = at("virtual_objects") }
at("rules") == "own" { own[s] = 1 - cycles / all[s]; work_own[s] = 1 - at("one_node_seconds") / work[s] }
at("rules") == "a4b" {
    a4b[s] = 1 - cycles / all[s]; work_a4b[s] = 1 - at("one_node_seconds") / work[s]
    fewer_rays[s] = 1 - at("ray_count") / rays[s]; fewer_sent[s] = 1 - at("virtual_objects") / sent[s]
}
at("rules") == "own+a4b" {
    print s, at("nodes"), sprintf("%.3f,%.3f,%.3f,%.3f,%.3f,%.3f,%.3f", \
        work_own[s], own[s], fewer_rays[s], fewer_sent[s], work_a4b[s], a4b[s], 1 - cycles / all[s])
}
