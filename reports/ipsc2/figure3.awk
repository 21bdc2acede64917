# Figure 3 of RR-0992 as it must have looked: the speed-up of each version over the nodes, the ideal, and what the authors said of it: 50 % with
# 30 to 40 processors.
BEGIN { print "nodes,speed-up,version" }
FILENAME ~ /speed/ && FNR > 1 {
    name = at("flow") == "classes" ? "regions" : "regions with unlimited queues"
    printf "%d,%.3f,%s\n", at("nodes"), at("speed_up"), name
    if (at("flow") == "classes") printf "%d,%d,ideal\n", at("nodes"), at("nodes")
    if (at("flow") == "classes" && at("nodes") >= 30 && at("nodes") <= 40) printf "%d,%.1f,said: 50 %%\n", at("nodes"), at("nodes") / 2
}
FILENAME ~ /memory/ && FNR > 1 { printf "%d,%.3f,shared memory\n", at("nodes"), at("speed_up") }
FILENAME ~ /published/ && FNR > 1 && at("machine") == "iPSC/2" { printf "%d,%.3f,shared memory (published)\n", at("nodes"), 6294 / at("seconds") }
