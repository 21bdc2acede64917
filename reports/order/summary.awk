# Over all scenes of a table: the least, the middle and the most. `keys` are the columns that tell its rows apart, `of` the ones that are
# summed up.
{
    k = ""; split(keys, key, ",")
    for (i = 1; i in key; i++) k = k at(key[i]) ","
    values = split(of, what, ",")
    for (j = 1; j <= values; j++) {
        if (at(what[j]) == "") continue
        g = what[j] "," k
        if (!(g in n)) group[++groups] = g
        v[g, ++n[g]] = at(what[j]) + 0
    }
}
function order(g,    i, j, x) {
    for (i = 2; i <= n[g]; i++) {
        x = v[g, i]
        for (j = i - 1; j >= 1 && v[g, j] > x; j--) v[g, j + 1] = v[g, j]
        v[g, j + 1] = x
    }
}
END {
    print "what," keys ",scenes,least,median,most"
    for (i = 1; i <= groups; i++) {
        g = group[i]; m = n[g]; order(g)
        printf "%s%d,%.3f,%.3f,%.3f\n", g, m, v[g, 1], (v[g, int((m + 1) / 2)] + v[g, int(m / 2) + 1]) / 2, v[g, m]
    }
}
