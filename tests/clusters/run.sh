#!/usr/bin/env bash
# Sweeps and images on clusters, for real: Slurm with two nodes and GNU parallel with two hosts, all on this machine and in a
# network of their own. `run.sh PCS-SIM`; it takes two minutes, most of which are Slurm's.
#
# Where root cannot install the packages, it fails; who is not root, or has no apt-get, is told that the tests are skipped,
# and so is who may not make networks, unless this is CI.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
PCS_SIM=$(realpath "${1:?the program that is to be tested}")
export PCS_SIM

cannot() {
    if [ -n "${CI:-}${2:-}" ]; then
        echo "the tests of clusters cannot run: $1" >&2
        exit 1
    fi
    echo "the tests of clusters are skipped: $1" >&2
    exit 0
}

must=
[ "$(id -u)" != 0 ] || ! command -v apt-get >/dev/null || must=yes
said=$("$here/packages.sh" 2>&1) ||
    cannot "Slurm, munge, GNU parallel and ssh cannot be installed (${said##*$'\n'})" "$must"
apart=(unshare --net --pid --fork --kill-child --mount-proc)
"${apart[@]}" true 2>/dev/null || cannot "no networks and processes apart from others can be made"
# Everything that is started ends with the shell in here.
exec "${apart[@]}" "$here/test.sh"
