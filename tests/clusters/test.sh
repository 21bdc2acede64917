#!/usr/bin/env bash
# Called by run.sh, in a network without anybody else.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
slurm=$work/slurm ssh=$work/ssh
mkdir "$slurm" "$ssh"
# GNU parallel keeps what it knows in the home of its user.
export HOME=$work
# shellcheck source=slurm.sh source=ssh.sh
. "$here/slurm.sh"
. "$here/ssh.sh"
trap 'status=$?; rm -rf "$work"; exit $status' EXIT

started=$SECONDS
step() {
    printf '%4d s  %s\n' $((SECONDS - started)) "$1"
}

fail() {
    echo "FAILED: $1" >&2
    tail -n 20 "$work"/*.out "$slurm"/*.log >&2 || true
    exit 1
}

# Waits until a command succeeds.
until_it() {
    for _ in $(seq 300); do
        if "$@"; then return; fi
        sleep 0.2
    done
    fail "it never came to: $*"
}

# The table NAME is that of the local engine, to the byte.
same() {
    for ending in csv parquet; do
        cmp "$work/local.$ending" "$work/$1.$ending" || fail "$1.$ending is not what one process makes"
    done
}

# NAME has so many shards done, at least.
has_done() {
    [ "$("$PCS_SIM" sweep status "$work/$1.shards" 2>/dev/null | sed -n 's/^\([0-9]*\) done.*/0\1/p')0" -ge "${2}0" ]
}

# NAME STATUS ARGUMENTS...: sweeps to the table NAME, and expects the exit status.
sweep() {
    local name=$1 expected=$2 status=0
    shift 2
    "$PCS_SIM" sweep points.ron -o "$name.csv" "$@" >"$name.out" 2>&1 || status=$?
    [ "$status" = "$expected" ] || fail "sweep to $name ended with status $status, not $expected: $(cat "$name.out")"
}

# Nothing of Slurm's waits or runs.
slurm_is_idle() {
    [ -z "$(squeue --noheader)" ]
}

cd "$work"
ip link set lo up
ip addr add 10.99.0.1/32 dev lo
cat >points.ron <<'END'
(scene: "teapot", size_factor: 2, size: 8, mode: ["pipeline", "broadcast"], grid_coefficient: [5, 10, 20, 50, 100],
    fifo_words: [16, 32, 64, 128, 256], link_mb_s: [80, 40, 20, 10])
END
step "a table of 200 points in one process"
sweep local 0
step "Slurm starts, and ssh"
slurm_start
ssh_start

step "Slurm: 200 points over two nodes"
sweep plain 0 --engine slurm --shards 20
same plain
nodes=$(squeue --noheader --array --states=all --format=%N | sort -u | grep -c '^n[12]$')
[ "$nodes" = 2 ] || fail "the shards ran on $nodes nodes"

step "Slurm: a node is killed and brought back, a shard takes too long"
# Shard 3 hangs once; a trace of it says on which node. Another hangs once on the other node, which is killed under it.
cat >trouble.lines <<END
#SBATCH --time=1
node=\$SLURMD_NODENAME
case \$SLURM_ARRAY_TASK_ID in
3) [ -e $work/hung ] || { echo "\$node" >$work/hung; exec sleep 600; } ;;
*) [ ! -s $work/hung ] || [ "\$node" = "\$(cat $work/hung)" ] || [ -e $work/doomed ] || { echo >$work/doomed; exec sleep 600; }
    sleep 1 ;;
esac
END
sweep trouble 1 --engine slurm --shards 20 --sbatch-file trouble.lines &
trouble=$!
until_it [ -s hung ]
until_it [ -s doomed ]
lost=$(sed 's/n1/N2/; s/n2/N1/; s/N/n/' hung)
until_it has_done trouble 4
node_kill "$lost"

step "GNU parallel: 200 points over two hosts, one of which is killed"
sweep hosts 0 --engine parallel --shards 20 --sshlogin 2/h1,2/h2 --at-once 2 &
hosts=$!
until_it has_done hosts 4
host_kill h1
wait "$hosts"
same hosts
for host in h1 h2; do
    grep -q "	$host	" hosts.shards/joblog || fail "nothing ran on $host"
done
host_start h1

step "GNU parallel: cancelled, and resumed"
sweep stopped 0 --engine parallel --shards 50 --sshlogin h1,h2 --at-once 1 --detach
until_it has_done stopped 2
"$PCS_SIM" sweep cancel stopped.shards
if has_done stopped 50; then fail "nothing was left to cancel"; fi
sleep 0.5
[ -z "$(pgrep -f "sweep shard $work/stopped.shards")" ] || fail "shards run on"
sweep stopped 0 --engine parallel --shards 20 --sshlogin h1,h2
same stopped

step "Slurm: the node is back"
node_start "$lost"
slurm_wait 2

step "Slurm: cancelled, and resumed"
printf 'sleep 1\n' >slow.lines
sweep cancelled 0 --engine slurm --shards 20 --sbatch-file slow.lines --at-once 2 --detach
until_it has_done cancelled 3
"$PCS_SIM" sweep cancel cancelled.shards
if has_done cancelled 20; then fail "nothing was left to cancel"; fi
status=0
"$PCS_SIM" sweep collect cancelled.shards >cancelled.out 2>&1 || status=$?
[ "$status" = 1 ] || fail "a table without all points was taken for whole"
grep -q "its shard was cancelled" cancelled.csv || fail "the table does not say why points are missing"
sweep cancelled 0 --engine slurm --shards 10
same cancelled

step "Slurm: nobody waits, a job joins the shards"
sweep alone 0 --engine slurm --shards 10 --detach
until_it [ -e alone.shards/joined ]
same alone

step "an image on both"
image=(image balls --size-factor 1 --size 40x30 --samples 2 --adaptive --timing off)
"$PCS_SIM" "${image[@]}" -o local.pfm >local.txt
"$PCS_SIM" "${image[@]}" -o slurm.pfm --engine slurm --shards 4 >slurm.txt
"$PCS_SIM" "${image[@]}" -o hosts.pfm --engine parallel --sshlogin h1,h2 --shards 7 >hosts.txt
for engine in slurm hosts; do
    cmp local.pfm "$engine.pfm" || fail "the image is another one"
    diff <(grep -v wrote local.txt) <(grep -v wrote "$engine.txt") || fail "another account of the image"
done

step "Slurm: what is missing is told, and run again"
wait "$trouble" || fail "see trouble.out"
[ "$(scontrol --oneliner show jobs | grep -c Restarts=1)" -ge 1 ] || fail "Slurm began nothing again"
late=$(grep -c "its shard took longer than the time that it had" trouble.csv)
[ "$late" = 10 ] || fail "$late points are told to be late, not 10: $(cat trouble.out)"
[ "$(grep -c ',$' trouble.csv)" = 190 ] || fail "other points are missing: $(cat trouble.out)"
sweep trouble 0 --engine slurm --shards 10
same trouble
until_it slurm_is_idle
step "all tables are the same to the byte"
