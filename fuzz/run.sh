#!/usr/bin/env bash
# Fuzzes every target for so many seconds each (20 unless said), two at a time: `fuzz/run.sh SECONDS [TARGET...]`.
# Inputs that are found lie in fuzz/artifacts/TARGET; the exit status is 1 if there are any. A plain stable compiler does, with a
# C++ compiler for libFuzzer; `fuzz/run.sh 0` just builds the targets and runs each on its corpus.
set -euo pipefail
cd "$(dirname "$0")"
seconds=${1:-20}
targets=("${@:2}")
[ ${#targets[@]} -gt 0 ] || mapfile -t targets < <(basename -s .rs fuzz_targets/*.rs)

# What cargo-fuzz gives the compiler, but for the sanitizers, which only nightly ones have. Naming the machine keeps it from build
# scripts, which could not be linked with it.
coverage=(level=4 inline-8bit-counters pc-table trace-compares)
RUSTFLAGS="--cfg fuzzing -Cpasses=sancov-module ${coverage[*]/#/-Cllvm-args=-sanitizer-coverage-}"
export RUSTFLAGS
host=$(rustc -vV | sed -n 's/^host: //p')
cargo build --release --quiet --locked --target "$host" --target-dir ../target/fuzz "${targets[@]/#/--bin=}"

TMPDIR=$(mktemp -d -p "$([ -d /dev/shm ] && echo /dev/shm || echo "${TMPDIR:-/tmp}")")
export TMPDIR
trap 'rm -rf "$TMPDIR"' EXIT

fuzz() {
    local target=$1 log="$TMPDIR/$1.log" limit=(-max_total_time="$seconds")
    mkdir -p "artifacts/$target" "$TMPDIR/found/$target"
    [ "$seconds" -gt 0 ] || limit=(-runs=0)
    # What is found on the way stays out of the corpus, which is ours.
    if "../target/fuzz/$host/release/$target" "$TMPDIR/found/$target" "corpus/$target" "${limit[@]}" \
        -artifact_prefix="artifacts/$target/" -timeout=10 -rss_limit_mb=4096 -max_len=4096 >"$log" 2>&1; then
        echo "$target: $(sed -n 's/^Done //p' "$log")"
    else
        echo "$target: failed"
        tail -n 40 "$log"
        return 1
    fi
}
export -f fuzz
export seconds host
printf '%s\n' "${targets[@]}" | xargs -P 2 -I {} bash -euo pipefail -c 'fuzz {}'
