# Slurm on this machine alone: a controller and two nodes on loopback, with a key, sockets and folders of their own, all in
# $slurm. To be sourced. Each node has processes of its own, so that it can be lost with all that runs on it.

slurm_start() {
    local host
    host=$(hostname -s)
    mkdir -p "$slurm/munge" "$slurm/state" "$slurm/n1" "$slurm/n2"
    chmod 700 "$slurm/munge"
    (umask 077 && head -c 1024 /dev/urandom >"$slurm/munge/key")
    cat >"$slurm/slurm.conf" <<END
ClusterName=pcs
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=16817
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket=$slurm/munge/socket,cred_expire=5
StateSaveLocation=$slurm/state
SlurmdSpoolDir=$slurm/%n
SlurmctldPidFile=$slurm/slurmctld.pid
SlurmdPidFile=$slurm/%n.pid
SlurmctldLogFile=$slurm/slurmctld.log
SlurmdLogFile=$slurm/%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MpiDefault=none
ReturnToService=2
SlurmdTimeout=6
MessageTimeout=5
KillWait=2
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerType=sched/backfill
SchedulerParameters=batch_sched_delay=0,sched_interval=1,bf_interval=1,sched_min_interval=0
NodeName=n[1-2] NodeHostname=$host NodeAddr=127.0.0.1 Port=[17001-17002] CPUs=2 State=UNKNOWN
PartitionName=all Nodes=n[1-2] Default=YES MaxTime=INFINITE State=UP
END
    export SLURM_CONF=$slurm/slurm.conf
    munged --force --key-file="$slurm/munge/key" --socket="$slurm/munge/socket" --pid-file="$slurm/munge/pid" \
        --log-file="$slurm/munge/log" --seed-file="$slurm/munge/seed" --num-threads=2
    slurmctld -D >"$slurm/slurmctld.out" 2>&1 &
    disown
    node_start n1
    node_start n2
    slurm_wait 2
}

# Processes of the node see none of the others, and end with it.
node_start() {
    unshare --pid --fork --kill-child --mount-proc slurmd -D -N "$1" >"$slurm/$1.out" 2>&1 &
    echo $! >"$slurm/$1.unshare"
    disown
}

# The node is lost: no process of it goes on.
node_kill() {
    kill -KILL "$(cat "$slurm/$1.unshare")"
}

# Waits for so many nodes to be ready.
slurm_wait() {
    for _ in $(seq 100); do
        [ "$(sinfo --noheader --Node --states=idle,mixed,alloc 2>/dev/null | wc -l)" -ge "$1" ] && return
        sleep 0.2
    done
    echo "Slurm's nodes do not come up" >&2
    tail -n 20 "$slurm"/*.log "$slurm"/*.out >&2
    return 1
}
