# The published times beside ours.
BEGIN { print "nodes,published,seconds,off,efficiency,published_efficiency,paging,tail" }
FILENAME ~ /published/ { if (FNR > 1 && at("machine") == "iPSC/2") published[at("nodes")] = at("seconds"); next }
FNR > 1 {
    known = published[at("nodes")]
    printf "%d,%d,%.1f,%.4f,%.3f,%.3f,%.3f,%.3f\n", at("nodes"), known, at("seconds"), at("seconds") / known - 1, at("efficiency"), published[1] / known / at("nodes"), at("paging"), at("tail")
}
