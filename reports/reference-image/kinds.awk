# The rays of an image by kind, from a timed run's tables, whose columns are two spaces apart or more.
BEGIN { print "kind,rays,hits" }
/^(primary|shadow|reflected|refracted) / { split($0, cell, /  +/); kind = $1; rays = cell[1] == kind ? cell[2] : cell[1]
    sub(/^[a-z]+ */, "", rays); hits = cell[1] == kind ? cell[3] : cell[2]; gsub(/ /, "", rays); gsub(/ /, "", hits); print kind, rays, hits }
