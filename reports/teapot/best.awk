# The published times, and the best of all partitions and grids, in each order.
BEGIN { print "machine,cells,seconds,partition,grid_coefficient,times_sun3" }
{ m = at("machine") (("order" in column) && at("order") == "shuffle" ? " shuffled" : ""); k = m "," at("cells"); t = at("seconds") + 0 }
!(k in best) { order[++rows] = k }
!(k in best) || t < best[k] {
    best[k] = t; text[k] = at("seconds")
    how[k] = ("partition" in column) ? at("partition") "," at("grid_coefficient") : "-,-"
}
END { for (i = 1; i <= rows; i++) { k = order[i]; print k, text[k], how[k], sprintf("%.1f", 8877 / best[k]) } }
