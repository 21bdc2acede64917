# The teapot on all machines: what was published, what the teapot's report has, and the farm.
BEGIN { print "machine,processors,seconds,times_sun3" }
function row(machine, processors, seconds) {
    printf "%s,%d,%.1f,%.2f\n", machine, processors, seconds, 8877 / seconds
}
FILENAME ~ /published/ { if (FNR > 1) row(at("machine") (at("machine") == "SUN3" ? " (published)" : ""), at("cells"), at("seconds")); next }
FILENAME ~ /times/ { if (FNR > 1 && at("machine") ~ /^PCS (broadcast|macro-pipeline)$/) row(at("machine"), at("cells"), at("seconds")); next }
FNR > 1 {
    if (at("workers") == 1) row("one processor (simulated)", 1, at("one_program_seconds"))
    row("CAPITAN", at("workers"), at("seconds"))
}
