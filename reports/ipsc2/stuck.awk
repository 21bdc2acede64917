# Which queues that block get through, and how efficiently: points that got stuck are not among those that the table of points has.
BEGIN { print "nodes,queue_rays,scan,strided" }
FNR > 1 { came[at("nodes"), at("queue_rays"), at("pixel_order")] = sprintf("%.3f", at("efficiency")) }
function told(nodes, slots, order) { return (nodes, slots, order) in came ? came[nodes, slots, order] : "stuck" }
END {
    n = split("4 8 16 32 64", nodes, " ")
    m = split("1 16 256 1024 4096", slots, " ")
    for (i = 1; i <= n; i++)
        for (j = 1; j <= m; j++)
            printf "%d,%d,%s,%s\n", nodes[i], slots[j], told(nodes[i], slots[j], "scan"), told(nodes[i], slots[j], "strided")
}
