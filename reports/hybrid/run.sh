#!/bin/sh
. ../sweeps.sh
sweep pipeline
sweep three
sweep cells
table best best.awk pipeline.csv three.csv cells.csv
table winners winners.awk best.csv
plot best reference "Scene reference, the best partition and grid of each: µs a ray" x=cells y=us_per_ray by=program scene=reference
plot best tree "Scene tree, the best partition and grid of each: µs a ray" x=cells y=us_per_ray by=program scene=tree
