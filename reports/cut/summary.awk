# Over all scenes of a table of speeds: the least, the middle and the most times as fast as one cell.
BEGIN { print "cells,order,partition,numbering,bounded,scenes,least,median,most,busiest_works" }
{
    k = at("cells") "," at("order") "," at("partition") "," at("numbering") "," at("bounded")
    if (!(k in n)) order[++rows] = k
    v[k, ++n[k]] = at("speed_up") + 0; w[k, n[k]] = at("busiest_works") + 0
}
# The middle one of n numbers, or the mean of the middle two, which are sorted on the way.
function middle(all, k, n,    i, j, x) {
    for (i = 2; i <= n; i++) {
        x = all[k, i]
        for (j = i - 1; j >= 1 && all[k, j] > x; j--) all[k, j + 1] = all[k, j]
        all[k, j + 1] = x
    }
    return (all[k, int((n + 1) / 2)] + all[k, int(n / 2) + 1]) / 2
}
END {
    for (i = 1; i <= rows; i++) {
        k = order[i]; m = middle(v, k, n[k]); b = middle(w, k, n[k])
        print k, n[k], sprintf("%.2f,%.2f,%.2f,%.3f", v[k, 1], m, v[k, n[k]], b)
    }
}
