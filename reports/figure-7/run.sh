#!/bin/sh
. ../sweeps.sh
sweep one-cell
sweep arrays
sweep sizes
awk 'BEGIN { print "ox,oy,oz,dx,dy,dz"; for (i = 0; i < 1000; i++) print "100,3,5,0.6,0.64,0.48" }' > missed-rays.csv
sweep missed
rm missed-rays.csv
table modes modes.awk one-cell.csv arrays.csv
table floor floor.awk missed.csv
table size size.awk sizes.csv
