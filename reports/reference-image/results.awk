# What each command printed of its run.
BEGIN { print "command,polygons,rays,rays_a_pixel,seconds,cycles,ms_a_ray,fullest_memory_words" }
function number(text) { gsub(/[^0-9.]/, "", text); return text }
function between(start, end) { return number(substr($0, index($0, start) + length(start), index($0, end) - index($0, start) - length(start))) }
FNR == 1 { command = FILENAME; sub(/\.txt$/, "", command); polygons = between("(", " polygons)"); rays = between("), ", " rays,")
           pixel = between("rays, ", " a pixel") }
/^simulated time/ { seconds = number($3); cycles = between("(", " cycles of") }
/^memory:/ { print command, polygons, rays, pixel, seconds, cycles, sprintf("%.3f", 1000 * seconds / rays), between("memory:", " words") }
