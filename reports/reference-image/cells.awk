# Where the cells of each run spent their time, as shares of it.
BEGIN { print "command,cell,works,waits,blocked" }
function share(percent) { return sprintf("%.3f", percent / 100) }
FNR == 1 { command = FILENAME; sub(/\.txt$/, "", command) }
/^[0-9]+ / && / %/ { gsub(/ %/, ""); print command, $1, share($3 + $4 + $5 + $6 + $7), share($8 + $9), share($10 + $11) }
