#!/usr/bin/env bash
# Tests a study on a real Slurm: one node, Debian's packages (apt install slurm-wlm munge), as root. Computes sixty runs
# in six tasks, kills one task in the middle, and submits the study again. The merged table must be bitwise equal to the
# table of one machine. Then computes an error budget in three tasks.
#
#   cargo build --release && tests/slurm/try.sh
#
# Starts its own munged, slurmctld and slurmd with files in a temporary folder, and ends them.
set -euo pipefail
cd "$(dirname "$0")/../.."
export SLUMP=$PWD/target/release/slump
study=$PWD/tests/slurm/study.toml
work=$(mktemp -d)
pids=()
finish() {
    ((${#pids[@]})) && kill "${pids[@]}" 2>/dev/null || true
    wait
    rm -rf "$work"
}
trap finish EXIT

mkdir -p "$work/munge" "$work/spool" "$work/state"
chmod 755 "$work"
dd if=/dev/urandom of="$work/munge/key" bs=1024 count=1 status=none
chmod 700 "$work/munge" && chmod 600 "$work/munge/key"
socket=$work/munge.socket
# The folder of keys is private, but all processes must be able to reach the socket.
munged --foreground --force --key-file="$work/munge/key" --socket="$socket" \
    --pid-file="$work/munge/pid" --log-file="$work/munge/log" --seed-file="$work/munge/seed" 2> "$work/munged.log" &
pids+=($!)

host=$(hostname -s)
cpus=$(nproc)
cat > "$work/slurm.conf" <<CONF
ClusterName=try
SlurmctldHost=$host(127.0.0.1)
AuthType=auth/munge
AuthInfo=socket=$socket
CredType=cred/munge
SlurmUser=root
SlurmctldPort=16817
SlurmdPort=16818
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.pid
SlurmctldLogFile=$work/slurmctld.log
SlurmdLogFile=$work/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
MpiDefault=none
ReturnToService=2
SchedulerParameters=sched_interval=1
NodeName=$host NodeAddr=127.0.0.1 CPUs=$cpus State=UNKNOWN
PartitionName=all Nodes=$host Default=YES MaxTime=INFINITE State=UP
CONF
export SLURM_CONF=$work/slurm.conf
slurmctld -D -f "$SLURM_CONF" 2> /dev/null & pids+=($!)
sleep 2
slurmd -D -f "$SLURM_CONF" 2> /dev/null & pids+=($!)
for _ in $(seq 30); do
    sinfo --noheader --format=%T 2>/dev/null | grep -q idle && break
    sleep 1
done
sinfo

# Waits until a job and all its tasks have left the queue.
ended() {
    while [ -n "$(squeue --noheader --jobs="$1" 2>/dev/null)" ]; do sleep 0.2; done
}

out=$work/array
read -r array merge < <(assets/studies/array.sh "$study" "$out" 6)
echo "array $array, merge $merge"
journal=$out/runs-1-of-6.jsonl
until [ -s "$journal" ]; do sleep 0.02; done
scancel --signal=KILL "${array}_1"
before=$(wc -l < "$journal")
ended "$array"
ended "$merge"
echo "task 1 was killed after $before of 10 runs"
((before < 10)) || { echo "task 1 had ended before it was killed" >&2; exit 1; }
[ ! -e "$out/runs.csv" ] || { echo "a table of a half study" >&2; exit 1; }

read -r array merge < <(assets/studies/array.sh "$study" "$out" 6)
ended "$array"
ended "$merge"
cat "$out/task-1.log"

"$SLUMP" sweep "$study" --out "$work/one" 2>/dev/null
cmp "$out/runs.csv" "$work/one/runs.csv"
echo "$(($(wc -l < "$out/runs.csv") - 1)) runs, bit for bit those of one machine"

# An error budget in three tasks: after joining, it equals the error budget of one machine, except for the measured
# times.
ask=(budget --scene cradle --duration 1 --quantity 'max(max_overlap)' --within 1e-4)
parts=$(sbatch --parsable --array=1-3 --output="$work/part-%a.log" <<JOB
#!/bin/sh
exec "$SLUMP" ${ask[@]@Q} --out "$work/parts" --shard "\$SLURM_ARRAY_TASK_ID/3"
JOB
)
ended "$parts"
"$SLUMP" "${ask[@]}" --out "$work/parts" > /dev/null 2>&1
"$SLUMP" "${ask[@]}" --out "$work/alone" > /dev/null 2>&1
cmp <(cut -d, -f1-9 "$work/parts/budget.csv") <(cut -d, -f1-9 "$work/alone/budget.csv")
[ ! -s "$work/parts/budget.jsonl" ] || { echo "parts were run again" >&2; exit 1; }
echo "a budget in three parts, that of one machine"
