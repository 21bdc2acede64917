#!/bin/sh
. ../sweeps.sh
sweep rules
sweep a5
table saved saved.awk rules.csv
table scenes scenes.awk saved.csv
table boxes boxes.awk a5.csv
