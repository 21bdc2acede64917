#!/bin/sh
. ../sweeps.sh
sweep one-cell
sweep cells
sweep many
sweep reference
sweep copies
sweep image-one-cell
sweep images
table speed speed.awk one-cell.csv cells.csv many.csv
table summary summary.awk speed.csv
table steps speed.awk reference.csv
table arrays copies.awk copies.csv
table images-speed speed.awk image-one-cell.csv images.csv
table images-summary summary.awk images-speed.csv
