# What the experiments' run.sh share; each begins with: . ../sweeps.sh
set -eu
pcs_sim=${1:-pcs-sim}

# sweep NAME: runs NAME.ron and leaves its table, NAME.csv.
sweep() {
    sweep_with "$1" ""
}

# sweep_where_some_fail NAME: the same of one some of whose points are known to fail.
sweep_where_some_fail() {
    sweep_with "$1" --accept-failures
}

sweep_with() {
    rm -f "$1.csv" "$1.parquet" "$1.sweep.ron" "$1.journal"
    $pcs_sim sweep "$1.ron" -o "$1.csv" $2 > /dev/null
    rm "$1.parquet" "$1.sweep.ron" "$1.journal"
}

# table NAME RULES TABLES...: makes NAME.csv of other tables by awk's rules, which print its heading in BEGIN.
table() {
    name=$1; rules=$2; shift 2
    awk -f ../columns.awk -f "$rules" "$@" > "$name.csv"
}

# plot TABLE NAME TITLE COLUMNS...: draws columns of TABLE.csv as NAME.svg and NAME.png.
plot() {
    from=$1; name=$2; title=$3; shift 3
    $pcs_sim plot "$from.csv" "$@" -o "$name" --title "$title" --force > /dev/null
}
