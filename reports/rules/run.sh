#!/bin/sh
. ../sweeps.sh
sweep rules
sweep a5
sweep nodes
table saved saved.awk rules.csv
table scenes scenes.awk saved.csv
table boxes boxes.awk a5.csv
table on_nodes on_nodes.awk nodes.csv
