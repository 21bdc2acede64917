#!/bin/sh
. ../sweeps.sh
sweep one-cell
sweep without
sweep stop-words
sweep ahead
sweep channels
table stop stop.awk one-cell.csv without.csv stop-words.csv
table rays-ahead rays-ahead.awk ahead.csv
table channels-apart channels.awk channels.csv
plot stop stop "Macro-pipeline, grid coefficient 50: times as fast as without stop words" \
    x=w y=faster_than_without by=scene grid_coefficient=50
