# The fastest number of workers, and the fewest that come within 5 % of it.
BEGIN { print "size,scene_by,workers,seconds,speed_up,enough,enough_seconds,eight_seconds" }
{
    k = at("size") "," at("scene_by"); t = at("seconds") + 0; n = at("workers") + 0
    if (!(k in best)) { order[++count] = k; best[k] = t + 1 }
    if (t < best[k]) { best[k] = t; at_best[k] = n; gain[k] = at("speed_up") }
    time[k, n] = t; if (n > most) most = n
}
END {
    for (i = 1; i <= count; i++) {
        k = order[i]
        for (n = 1; n <= most && time[k, n] > 1.05 * best[k]; n++);
        printf "%s,%d,%.2f,%.2f,%d,%.2f,%.2f\n", k, at_best[k], best[k], gain[k], n, time[k, n], time[k, 8]
    }
}
