#!/bin/sh
. ../sweeps.sh
sweep one-cell
sweep cells
sweep numbers
sweep reference
sweep copies
sweep image-one-cell
sweep images
table speed speed.awk one-cell.csv cells.csv numbers.csv
table summary summary.awk speed.csv
table steps speed.awk reference.csv
table arrays copies.awk copies.csv
table images-speed speed.awk image-one-cell.csv images.csv
table images-summary summary.awk images-speed.csv
plot steps steps "Broadcast, scene reference, random order: speed-up over one cell" x=cells y=speed_up by=partition facet=bounded \
    order=shuffle
plot arrays arrays "16 cells as arrays with a copy of the scene each: speed-up over words a cell" x=kwords_a_cell y=speed_up \
    by=scene log=x
