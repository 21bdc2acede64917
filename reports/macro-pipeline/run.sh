#!/bin/sh
. ../sweeps.sh
sweep grids
sweep fifos
# What the FIFOs behind P1 and behind P2 would have to hold so that nobody ever waits for room.
echo "scene,order,behind_p1,behind_p2" > behind.csv
for scene in balls gears lattice mountain rings shells sombrero teapot tetra tree room table valve chapel reference; do
    for order in raster shuffle:1; do
        $pcs_sim --mode pipeline --scene $scene --size 128x128 --order $order --enough --stats stats.json --force > /dev/null
        awk -F'[:,]' -v row="$scene,${order%:*}" '
            /"name": "Y/ { gsub(/[ "]/, "", $2); fifo = $2 }
            /"enough":/ { enough[fifo] = $2 + 0 }
            END { print row "," enough["Y1"] "," enough["Y2"] }' stats.json >> behind.csv
    done
done
rm stats.json
table behind-ratio behind.awk behind.csv
table loads loads.awk grids.csv
table best best.awk grids.csv
table depth depth.awk fifos.csv
plot loads loads-reference "Macro-pipeline, scene reference: µs of work a ray in each cell, and what a ray takes" \
    x=grid_coefficient y=us_per_ray by=what scene=reference
plot depth depth "Macro-pipeline, grid coefficient 50: time against FIFOs without limit" \
    x=fifo_words y=times_as_long by=scene facet=order grid_coefficient=50
