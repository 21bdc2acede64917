BEGIN { print "scene,own_slabs,own_intersections,own_cycles,a4b_rays,a4b_cycles,both_cycles,pipeline_both" }
{ s = at("scene"); if (!(s in seen)) { order[++scenes] = s; seen[s] = 1 } }
at("mode") == "pipeline" { if (at("rules") == "own+a4b") pipeline[s] = at("cycles"); next }
at("rules") == "own" { slabs[s] = at("slab_tests"); tests[s] = at("intersection_tests"); own[s] = at("cycles") }
at("rules") == "a4b" { rays[s] = at("rays"); cones[s] = at("cycles") }
at("rules") == "own+a4b" { both[s] = at("cycles") }
END {
    for (i = 1; i <= scenes; i++) {
        s = order[i]
        print s, slabs[s], tests[s], own[s], rays[s], cones[s], both[s], pipeline[s]
    }
}
