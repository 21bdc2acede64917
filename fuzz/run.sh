#!/usr/bin/env bash
# Fuzzes every target for so many seconds each (20 unless said): `fuzz/run.sh SECONDS [TARGET...]`. It needs cargo-fuzz.
# Inputs that are found lie in fuzz/artifacts; the exit status is 1 if there are any.
set -euo pipefail
cd "$(dirname "$0")"
seconds=${1:-20}
targets=("${@:2}")
[ ${#targets[@]} -gt 0 ] || mapfile -t targets < <(basename -s .rs fuzz_targets/*.rs)
# The coverage that libFuzzer looks at is no stable part of the compiler.
export RUSTC_BOOTSTRAP=1
TMPDIR=$(mktemp -d -p "$([ -d /dev/shm ] && echo /dev/shm || echo "${TMPDIR:-/tmp}")")
export TMPDIR
trap 'rm -rf "$TMPDIR"' EXIT
failed=0
for target in "${targets[@]}"; do
    # What is found on the way stays out of the corpus, which is ours.
    found=$(mktemp -d)
    cargo fuzz run -s none --fuzz-dir . "$target" "$found" "corpus/$target" -- \
        -max_total_time="$seconds" -timeout=10 -rss_limit_mb=4096 -max_len=4096 -print_final_stats=1 || failed=1
done
exit $failed
