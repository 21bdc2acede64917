#!/bin/sh
. ../sweeps.sh
sweep cells
sweep pipeline
awk -F, -v OFS=, 'NR == 1 { print "program," $0; next } { print "hybrid-3," $0 }' pipeline.csv > one-group.csv
table best best.awk cells.csv one-group.csv
rm one-group.csv
sort -t, -k1,1 -k2,2n -k3,3 best.csv | awk -F, '/^scene,/ { print; next } { rows[++n] = $0 } END { for (i = 1; i <= n; i++) print rows[i] }' > sorted.csv
(grep '^scene,' sorted.csv; grep -v '^scene,' sorted.csv) > best.csv
rm sorted.csv
table winners winners.awk best.csv
plot best reference "Scene reference, the best partition and grid of each: µs a ray" x=cells y=us_per_ray by=program scene=reference
plot best gears "Scene gears, the best partition and grid of each: µs a ray" x=cells y=us_per_ray by=program scene=gears
