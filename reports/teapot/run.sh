#!/bin/sh
. ../sweeps.sh
rm -f all.csv
echo "machine,cells,partition,grid_coefficient,rays,seconds" > all.csv

# image MACHINE PARTITION GRID CELLS FLAGS...: notes the simulated time of the whole image.
image() {
    machine=$1; partition=$2; grid=$3; cells=$4; shift 4
    $pcs_sim image teapot.ron --size 512x512 --grid-coefficient "$grid" "$@" -o teapot.png --stats stats.json --force > /dev/null
    awk -F'[:,]' -v row="$machine,$cells,$partition,$grid" '
        /"rays":/ && !rays { rays = $2 + 0 }
        /"seconds":/ && !seconds { seconds = $2 }
        END { printf "%s,%d,%.1f\n", row, rays, seconds }' stats.json >> all.csv
}

for grid in 10 50; do
    image "PCS broadcast" - $grid 1 --mode broadcast --cells 1
    image "PCS macro-pipeline" - $grid 3 --mode pipeline
done
image "the same behind a SUN3" - 10 3 --mode pipeline --machine ../../pcs-programs/pcs-sun3.ron
for partition in regular work; do
    for cells in 2 4 8 16 32 64; do
        image "PCS broadcast" $partition 10 $cells --mode broadcast --cells $cells --partition $partition
    done
    for cells in 6 12 24 48 63; do
        image "PCS groups of three" $partition 10 $cells --program hybrid-3 --cells $cells --partition $partition
    done
done
# The rays of the image by kind, which are the same in every run.
awk -F'[:,]' '
    BEGIN { print "kind,rays" }
    /"(primary|shadow|reflected|refracted)": \{/ { gsub(/[ "]/, "", $1); kind = $1 }
    kind != "" && /"rays":/ { print kind "," $2 + 0; kind = "" }' stats.json > kinds.csv
rm stats.json
table times best.awk published.csv all.csv
plot times times "The teapot, 512 x 512, three lights: seconds for the whole image" x=cells y=seconds by=machine
