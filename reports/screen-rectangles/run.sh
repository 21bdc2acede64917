#!/bin/sh
. ../sweeps.sh
sweep rays
sweep host
table saved saved.awk rays.csv
table scenes scenes.awk saved.csv
table pays pays.awk host.csv
plot saved saved "Rectangles of objects: share of the cycles that is saved by not sending rays" x=not_sent y=saved by=mode rectangles=objects log=none
