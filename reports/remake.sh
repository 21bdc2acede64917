#!/bin/sh
# Remakes all reports: ./remake.sh, or ./remake.sh NAME... for some. The times that a report measures are this machine's;
# everything else comes out as the same bytes. reference-image takes its measurements and is remade only by its name.
set -eu
cd "$(dirname "$0")"
cargo build --release --quiet
pcs_sim=${CARGO_TARGET_DIR:-$PWD/../target}/release/pcs-sim
[ $# -gt 0 ] || set -- order figure-7 macro-pipeline slabs broadcast hybrid links traffic teapot beyond cut polygon-count capitan ipsc2 screen-rectangles masks rules oversampling
for report; do
    echo "$report"
    (cd "$report" && sh ./run.sh "$pcs_sim")
done
