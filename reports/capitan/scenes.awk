# For each seed the segments of the smaller image, and how far off the farthest of the nine times is.
BEGIN { print "seed,segments,farthest_off" }
FILENAME == "published.csv" { if (FNR > 1) published[at("size"), at("workers")] = at("seconds"); next }
(at("size"), at("workers")) in published {
    s = at("seed"); off = at("seconds") / published[at("size"), at("workers")] - 1; if (off < 0) off = -off
    if (!(s in worst)) { order[++count] = s; worst[s] = 0 }
    if (off > worst[s]) worst[s] = off
    if (at("size") == "100x100") segments[s] = at("work_items")
}
END { for (i = 1; i <= count; i++) printf "%s,%s,%.4f\n", order[i], segments[order[i]], worst[order[i]] }
