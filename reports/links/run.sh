#!/bin/sh
. ../sweeps.sh
sweep pipeline
sweep arrays
table slower slower.awk pipeline.csv arrays.csv
plot slower teapot "Scene teapot: time against links of 160 Mbyte/s" x=link_mb_s y=times_as_long by=array scene=teapot
