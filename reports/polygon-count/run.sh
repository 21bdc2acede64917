#!/bin/sh
# Remakes this folder's table, fit and plot: ./run.sh [pcs-sim]. The reference scene from 1 000 to 1 000 000 polygons.
set -eu
cd "$(dirname "$0")"
pcs_sim=${1:-pcs-sim}
echo "polygons,rays,voxels_per_ray,slab_tests_per_ray,intersection_tests_per_ray,us_per_ray" > cost.csv
for size in 1 3 10 30 100 300 1000; do
    $pcs_sim image reference --size-factor $size --size 256x256 --mode broadcast --cells 1 --force \
        -o image.png --stats stats.json > /dev/null
    awk -F'[:,]' '
        /"rays"/ && !rays { rays = $2 }
        /"seconds"/ { seconds = $2 }
        /"voxels"/ { voxels = $2 }
        /"slab_tests"/ { slabs = $2 }
        /"intersection_tests"/ { tests = $2 }
        /"polygons"/ { if ($2 + 0 > 0 && !polygons) polygons = $2 }
        END { printf "%d,%d,%.3f,%.3f,%.3f,%.2f\n",
              polygons, rays, voxels / rays, slabs / rays, tests / rays, 1e6 * seconds / rays }
    ' stats.json >> cost.csv
done
rm image.png stats.json
cat cost.csv
# The exponent: the slope of the least squares line through the logarithms. The plot: both axes logarithmic.
awk -F, -v svg=cost.svg '
    NR > 1 { n++; P[n] = $1; C[n] = $6; V[n] = $3; x = log($1); y = log($6); v = log($3)
             sx += x; sy += y; sv += v; sxx += x * x; sxy += x * y; sxv += x * v }
    END {
        cost = (n * sxy - sx * sy) / (n * sxx - sx * sx); voxels = (n * sxv - sx * sv) / (n * sxx - sx * sx)
        printf "exponent of the cost per ray: %.3f; of the voxels per ray: %.3f; of the cube root: 0.333\n", cost, voxels
        base = (sy - cost * sx) / n
        print "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 480 340\" font-family=\"sans-serif\" font-size=\"12\">" > svg
        print "<rect width=\"480\" height=\"340\" fill=\"white\"/>" > svg
        for (d = 3; d <= 6; d++) { px = 60 + (d - 3) * 130
            printf "<path d=\"M%d 20V290\" stroke=\"#ddd\"/><text x=\"%d\" y=\"308\" text-anchor=\"middle\">10^%d</text>\n", px, px, d > svg }
        for (k = 0; k < 6; k++) { us = 100 * 2 ^ k; py = 290 - k * 54
            printf "<path d=\"M60 %dH450\" stroke=\"#ddd\"/><text x=\"54\" y=\"%d\" text-anchor=\"end\">%d</text>\n", py, py + 4, us > svg }
        for (end = 3; end <= 6; end += 3) line = line sprintf("%.1f,%.1f ", 60 + (end - 3) * 130, Y(exp(base + cost * end * log(10))))
        printf "<polyline points=\"%s\" fill=\"none\" stroke=\"#c33\" stroke-dasharray=\"5 4\"/>\n", line > svg
        for (i = 1; i <= n; i++) printf "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"4\" fill=\"#236\"/>\n", 60 + (log(P[i]) / log(10) - 3) * 130, Y(C[i]) > svg
        printf "<text x=\"255\" y=\"330\" text-anchor=\"middle\">polygons</text><text x=\"70\" y=\"36\">simulated time per ray, in us; dashed: P^%.3f</text></svg>\n", cost > svg
    }
    function Y(us) { return 290 - 54 * log(us / 100) / log(2) }
' cost.csv | tee fit.txt
awk -v OFS=, -f exponents.awk cost.csv > exponents.csv
