#!/bin/sh
# Remakes this folder's picture and figures: ./run.sh [pcs-sim]. Each command is run three times, in turns, so that
# whatever else the machine does falls on all of them alike.
set -eu
cd "$(dirname "$0")"
pcs_sim=${1:-pcs-sim}
image="image reference --size 512x512 --samples 2 --force"
times=times.csv
echo "run,command,wall_s,user_s" > $times

# timed NAME FLAGS...: runs the image with the flags and notes its times.
timed() {
    name=$1; shift
    bash -c "TIMEFORMAT='%R,%U'; time $pcs_sim $image $* > $name.txt" 2> $name.time
    echo "$run,$name,$(tail -1 $name.time)" >> $times
    rm $name.time
}

for run in 1 2 3; do
    timed untimed-1-thread -o reference.png --timing off --threads 1
    timed untimed -o reference.png --timing off
    timed pipeline -o pipeline.png --mode pipeline
    timed broadcast -o broadcast.png --mode broadcast --cells 16
done
timed sun3 -o sun3.png --mode pipeline --machine ../../pcs-programs/pcs-sun3.ron
for other in pipeline broadcast sun3; do
    cmp reference.png $other.png
    rm $other.png
done
cat $times
# What the page says, as tables.
table() {
    awk -v OFS=, -f "$1.awk" $2 > "$1.csv"
}
table results "pipeline.txt broadcast.txt sun3.txt"
table kinds untimed.txt
table cells "pipeline.txt broadcast.txt sun3.txt"
table medians times.csv
