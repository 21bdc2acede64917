#!/bin/sh
. ../sweeps.sh
size=64x64 against="--against truth.pfm"

# image SCENE BY MODE FLAGS...: makes an image with 3 x 3 samples where BY asks for them, and notes what it took and how far it is off
# from the truth, if there is one.
image() {
    scene=$1; by=$2; mode=$3; shift 3
    $pcs_sim image $scene --size-factor $factor --size $size --mode $mode --screen-rectangles objects "$@" $against -o image.png --stats stats.json \
        --force > image.txt
    awk -v row="$scene,$size,$by,$mode" '
        FILENAME == "image.txt" && /^off from/ { split($0, word, / /); for (i in word) if (word[i] == "square") square = word[i + 1] }
        FILENAME == "stats.json" { gsub(/[",]/, "") }
        /^  cycles:/ { cycles = $2 }
        /^  samples:/ { samples = $2 }
        /^  refined_pixels:/ { refined = $2 }
        /^  rays_by_kind:/ { kinds = 1 }
        kinds && /^    [a-z]+: \{/ { kind = $1 }
        kinds && /^      rays:/ { rays[kind] = $2; all += $2 }
        kinds && /^      hits:/ { hits[kind] = $2 }
        /^  bottleneck:/ { kinds = 0 }
        END {
            print row "," samples "," refined + 0 "," all "," rays["primary:"] "," hits["primary:"] "," rays["shadow:"] "," \
                hits["shadow:"] "," cycles "," square
        }' image.txt stats.json >> images.csv
}

echo "scene,size,by,mode,samples,refined,rays,primary,primary_hit,shadow,shadow_hit,cycles,mean_square" > images.csv
# Smaller than usual where they are large: these are 270 images.
for scene in balls:2 chapel:1 gears:2 lattice:4 mountain:5 reference:10 rings:3 room:1 shells:4 sombrero:1 table:1 teapot:6 tetra:5 tree:6 \
    valve:1; do
    factor=${scene#*:} scene=${scene%:*}
    $pcs_sim image $scene --size-factor $factor --size $size --samples 8 --timing off -o truth.pfm --force > /dev/null
    for mode in pipeline broadcast hybrid; do
        image $scene none $mode
        for by in object surface lao whitted; do
            image $scene $by $mode --samples 3 --adaptive-by $by
        done
        image $scene all $mode --samples 3
    done
done
# The thesis's table: its size of the image, a scene of as many primitives; and smaller images of it.
factor=2 against=""
mv images.csv small.csv
echo "scene,size,by,mode,samples,refined,rays,primary,primary_hit,shadow,shadow_hit,cycles,mean_square" > images.csv
for size in 640x512 320x256 160x128 80x64; do
    image valve none pipeline
    image valve whitted pipeline --samples 3 --adaptive-by whitted
    image valve lao pipeline --samples 3 --adaptive-by lao
done
mv images.csv valve.csv
mv small.csv images.csv
rm truth.pfm image.png image.txt stats.json
table table table.awk valve.csv
table scenes scenes.awk images.csv
table means means.awk scenes.csv
plot means means "All scenes: times as long as one sample a pixel, and the share of the squared error that is left" \
    x=times_as_long y=error_left by=mode log=y
