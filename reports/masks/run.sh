#!/bin/sh
. ../sweeps.sh
sweep_where_some_fail broadcast
sweep hybrid
sweep pipeline
sweep host
table saved saved.awk broadcast.csv hybrid.csv pipeline.csv
table scenes scenes.awk saved.csv
table pays pays.awk broadcast.csv host.csv
plot saved saved "Broadcast, sub-volumes of equal work, masks by boxes: share of the cycles that is saved" \
    x=cells y=saved by=scene mode=broadcast partition=work masks=boxes log=none
