# The better of two cuts of each program: its time against broadcast's, and what the fullest cell must hold. Scenes that broadcast cannot cut into so
# many parts are left out.
BEGIN { print "scene,order,cells,program,us_per_ray,against_broadcast,kwords,words_against_broadcast" }
{
    o = at("order"); sub(/:1$/, "", o); a = at("scene") "," o "," at("cells"); p = at("program"); k = a "," p; t = at("us_per_ray") + 0
}
!(k in best) { rows[++count] = k; array[k] = a }
!(k in best) || t < best[k] { best[k] = t; words[k] = at("fullest_memory_words") / 1000 }
END {
    for (i = 1; i <= count; i++) {
        k = rows[i]; b = array[k] ",broadcast"; if (!(b in best)) continue
        print k, sprintf("%.1f,%.3f,%.1f,%.3f", best[k], best[k] / best[b], words[k], words[k] / words[b])
    }
}
