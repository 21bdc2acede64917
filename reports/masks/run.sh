#!/bin/sh
. ../sweeps.sh
sweep without
sweep with
sweep hybrid
sweep hybrid-masked
sweep host
table saved saved.awk without.csv hybrid.csv with.csv hybrid-masked.csv
table scenes scenes.awk saved.csv
table pays pays.awk without.csv host.csv
plot saved saved "Broadcast, sub-volumes of equal work, masks by boxes: share of the cycles that is saved" \
    x=cells y=saved by=scene mode=broadcast partition=work masks=boxes log=none
