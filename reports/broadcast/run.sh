#!/bin/sh
. ../sweeps.sh
sweep one-cell
sweep cells
sweep depth
table losses losses.awk one-cell.csv cells.csv
table causes causes.awk losses.csv
table deeper deeper.awk depth.csv
plot losses speed-up "Broadcast, scene reference: speed-up over one cell" x=cells y=speed_up by=partition scene=reference
plot causes causes "Broadcast, scene reference, sub-volumes of equal work: shares of all cells' time" \
    x=cells y=share by=cause scene=reference partition=work
rm causes.csv
