#!/bin/sh
. ../sweeps.sh
sweep sequential
table gain gain.awk sequential.csv
table best best.awk sequential.csv
plot gain gain "What slabs gain behind the same grid, as a share of the time without them; one cell" \
    x=grid_coefficient y=gain by=scene
