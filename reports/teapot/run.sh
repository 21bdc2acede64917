#!/bin/sh
. ../sweeps.sh

# image TABLE SCENE MACHINE PARTITION ORDER GRID CELLS FLAGS...: notes the simulated time of the whole image.
image() {
    to=$1 scene=$2 machine=$3 partition=$4 order=$5 grid=$6 cells=$7; shift 7
    $pcs_sim image $scene --size 512x512 --order $order --grid-coefficient "$grid" "$@" -o image.png --stats stats.json --force > /dev/null
    awk -F'[:,]' -v row="$machine,$cells,$partition,${order%:*},$grid" '
        /"rays":/ && !rays { rays = $2 + 0 }
        /"polygons":/ && $2 + 0 > 0 && !polygons { polygons = $2 + 0 }
        /"seconds":/ && !seconds { seconds = $2 }
        END { printf "%s,%d,%d,%.1f\n", row, polygons, rays, seconds }' stats.json >> $to.csv
}

# three TABLE SCENE: one cell, the macro-pipeline, and 64 cells in both orders.
three() {
    image $1 "$2" "PCS broadcast" - raster 10 1 --mode broadcast --cells 1
    image $1 "$2" "PCS macro-pipeline" - raster 10 3 --mode pipeline
    for order in raster shuffle:1; do
        image $1 "$2" "PCS broadcast" work $order 10 64 --mode broadcast --cells 64 --partition work
    done
}

for table in all smaller tetra; do
    echo "machine,cells,partition,order,grid_coefficient,polygons,rays,seconds" > $table.csv
done
for grid in 10 50; do
    image all teapot.ron "PCS broadcast" - raster $grid 1 --mode broadcast --cells 1
    image all teapot.ron "PCS macro-pipeline" - raster $grid 3 --mode pipeline
done
mv image.png teapot.png
image all teapot.ron "the same behind a SUN3" - raster 10 3 --mode pipeline --machine ../../pcs-programs/pcs-sun3.ron
for partition in regular work; do
    for cells in 2 4 8 16 32 64; do
        image all teapot.ron "PCS broadcast" $partition raster 10 $cells --mode broadcast --cells $cells --partition $partition
    done
    for cells in 6 12 24 48 63; do
        image all teapot.ron "PCS groups of three" $partition raster 10 $cells --program hybrid-3 --cells $cells --partition $partition
    done
done
for cells in 4 16 64; do
    image all teapot.ron "PCS broadcast" work shuffle:1 10 $cells --mode broadcast --cells $cells --partition work
done
for cells in 6 24; do
    image all teapot.ron "PCS groups of three" work shuffle:1 10 $cells --program hybrid-3 --cells $cells --partition work
done
# The rays of the image by kind, which are the same in every run.
awk -F'[:,]' '
    BEGIN { print "kind,rays" }
    /"(primary|shadow|reflected|refracted)": \{/ { gsub(/[ "]/, "", $1); kind = $1 }
    kind != "" && /"rays":/ { print kind "," $2 + 0; kind = "" }' stats.json > kinds.csv
# The teapot of which the databases' generator makes a quarter of the polygons, and the largest scene that they told the time of.
three smaller teapot-6.ron
three tetra "tetra --size-factor 10"
rm stats.json image.png
table times best.awk published.csv all.csv
plot times times "The teapot, 512 x 512, three lights: seconds for the whole image" x=cells y=seconds by=machine
