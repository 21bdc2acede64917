#!/usr/bin/env bash
# Installs what the tests of clusters want, from Debian: Slurm, munge, GNU parallel, ssh. Nothing, if it is there.
set -euo pipefail
packages=(iproute2 munge openssh-client openssh-server parallel slurm-wlm)
if dpkg --status "${packages[@]}" >/dev/null 2>&1; then
    exit
fi
if [ "$(id -u)" != 0 ] || ! command -v apt-get >/dev/null; then
    echo "it takes root, and apt-get" >&2
    exit 1
fi
# Nothing that is installed starts to serve: the tests start what they need, and end it.
policy=/usr/sbin/policy-rc.d
if [ ! -e "$policy" ]; then
    printf '#!/bin/sh\nexit 101\n' >"$policy"
    chmod +x "$policy"
    trap 'rm "$policy"' EXIT
fi
export DEBIAN_FRONTEND=noninteractive
apt-get update --quiet=2
apt-get install --quiet=2 --yes --no-install-recommends "${packages[@]}" >/dev/null
