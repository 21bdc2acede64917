#!/bin/sh
. ../sweeps.sh
sweep grids
sweep fifos
table loads loads.awk grids.csv
table best best.awk grids.csv
table depth depth.awk fifos.csv
plot loads loads-reference "Macro-pipeline, scene reference: µs of work a ray in each cell, and what a ray takes" \
    x=grid_coefficient y=us_per_ray by=what scene=reference
plot depth depth "Macro-pipeline, grid coefficient 50: time against FIFOs without limit" \
    x=fifo_words y=times_as_long by=scene grid_coefficient=50
