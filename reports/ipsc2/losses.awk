# What the nodes' time goes to, in percent.
BEGIN { print "nodes,share,what" }
FNR > 1 && at("flow") == "classes" {
    n = split("one_node regions messages blocked waiting tail", names, " ")
    split("one node's work|entering regions|messages|blocked|waiting|tail", told, "|")
    for (i = 1; i <= n; i++) printf "%d,%.2f,%s\n", at("nodes"), 100 * at(names[i]), told[i]
}
