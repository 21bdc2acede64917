#!/bin/sh
. ../sweeps.sh
sweep cells
table words words.awk cells.csv
plot words words "Scene reference: words a ray through the busiest link" x=cells y=words_a_ray by=program scene=reference
