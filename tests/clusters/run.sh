#!/usr/bin/env bash
# Sweeps and images on clusters, for real: Slurm with two nodes and GNU parallel with two hosts, all on this machine and in a
# network of their own. `run.sh PCS-SIM`; it takes two minutes, most of which are Slurm's.
#
# Where the packages cannot be had, or where this user may not make networks, it says so: it fails in CI, and is skipped
# elsewhere.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
export PCS_SIM=${1:?the program that is to be tested}

cannot() {
    if [ -n "${CI:-}" ]; then
        echo "the tests of clusters cannot run: $1" >&2
        exit 1
    fi
    echo "the tests of clusters are skipped: $1" >&2
    exit 0
}

said=$("$here/packages.sh" 2>&1) || cannot "Slurm, munge, GNU parallel and ssh cannot be installed (${said##*$'\n'})"
apart=(unshare --net --pid --fork --kill-child --mount-proc)
"${apart[@]}" true 2>/dev/null || cannot "no networks and processes apart from others can be made"
# Everything that is started ends with the shell in here.
exec "${apart[@]}" "$here/test.sh"
