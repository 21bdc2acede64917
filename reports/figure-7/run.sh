#!/bin/sh
. ../sweeps.sh
sweep one-cell
sweep arrays
sweep sizes
table modes modes.awk one-cell.csv arrays.csv
table size size.awk sizes.csv
