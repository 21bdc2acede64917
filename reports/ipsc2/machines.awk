# The teapot on all machines: as published, PCS, CAPITAN, and the iPSC/2's programs.
BEGIN { print "machine,processors,seconds,times_sun3" }
function row(machine, processors, seconds) { printf "%s,%d,%.1f,%.2f\n", machine, processors, seconds, 8877 / seconds }
FILENAME ~ /capitan/ { if (FNR > 1 && at("machine") != "iPSC/2") row(at("machine"), at("processors"), at("seconds")); next }
FILENAME ~ /speed/ { if (FNR > 1 && at("flow") == "classes") row("iPSC/2 regions", at("nodes"), at("seconds")); next }
FILENAME ~ /line/ { if (FNR > 1) row("iPSC/2 row of nodes", at("cells"), at("seconds")); next }
FNR > 1 { row("iPSC/2 shared memory", at("nodes"), at("seconds")) }
