# The published times beside the simulated ones.
BEGIN { print "size,workers,published,seconds,off,speed_up,efficiency,computing,messages,waiting_scene,waiting_master,idle,master_held,limits" }
FILENAME == "published.csv" { if (FNR > 1) published[at("size"), at("workers")] = at("seconds"); next }
(at("size"), at("workers")) in published {
    p = published[at("size"), at("workers")]
    printf "%s,%s,%s,%.2f,%.4f,%.3f,%.3f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%s\n", at("size"), at("workers"), p, at("seconds"), \
        at("seconds") / p - 1, at("speed_up"), at("efficiency"), at("computing"), at("messages"), at("waiting_scene"), \
        at("waiting_master"), at("idle"), at("master_held"), at("limits")
}
