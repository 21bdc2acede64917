# Two hosts, h1 and h2, that ssh reaches on this machine, with keys of their own, all in $ssh, which is also the home of who
# works there: no startup file of a user's is read. To be sourced.

ssh_start() {
    mkdir -p "$ssh" /run/sshd
    ssh-keygen -q -t ed25519 -N '' -f "$ssh/user"
    cp "$ssh/user.pub" "$ssh/authorized"
    for host in h1 h2; do
        ssh-keygen -q -t ed25519 -N '' -f "$ssh/$host"
        cat >"$ssh/$host.conf" <<END
ListenAddress 10.99.0.1:220${host#h}
HostKey $ssh/$host
AuthorizedKeysFile $ssh/authorized
PidFile $ssh/$host.pid
StrictModes no
UsePAM no
MaxStartups 100
SetEnv HOME=$ssh
END
        cat >>"$ssh/config" <<END
Host $host
    HostName 10.99.0.1
    Port 220${host#h}
END
        host_start "$host"
    done
    cat >>"$ssh/config" <<END
Host *
    IdentityFile $ssh/user
    BatchMode yes
    UserKnownHostsFile $ssh/known
    StrictHostKeyChecking accept-new
    LogLevel ERROR
END
    export PARALLEL_SSH="ssh -F $ssh/config"
    for host in h1 h2; do
        $PARALLEL_SSH "$host" true
    done
}

# Processes of the host see none of the others, and end with it.
host_start() {
    setsid unshare --pid --fork --kill-child --mount-proc \
        sh -c "/usr/sbin/sshd -D -f '$ssh/$1.conf' -E '$ssh/$1.log'; exit" &
    echo $! >"$ssh/$1.unshare"
    disown
    until (: >"/dev/tcp/10.99.0.1/220${1#h}") 2>/dev/null; do sleep 0.1; done
}

# The host is lost: no process of it goes on.
host_kill() {
    kill -KILL "$(cat "$ssh/$1.unshare")"
}
