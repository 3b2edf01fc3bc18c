#!/usr/bin/env bash
# Runs a study as a Slurm job array: as many tasks as asked for, no more than the study has runs, and
# a job that joins the parts once all tasks have ended well.
#
#   assets/studies/array.sh STUDY.toml DIR [TASKS] [further options of sbatch]
#
# DIR must lie where all nodes see it. A task that was killed is put right by the same command: runs
# that are there are not done again. SLUMP names the program; it must be there on all nodes.
set -euo pipefail
study=$(realpath "$1")
mkdir -p "$2"
out=$(realpath "$2")
slump=${SLUMP:-slump}
runs=$("$slump" sweep count "$study")
tasks=${3:-16}
tasks=$((tasks < runs ? tasks : runs))
shift $(($# < 3 ? $# : 3))

array=$(sbatch --parsable --array="1-$tasks" --job-name=slump --output="$out/task-%a.log" "$@" <<JOB
#!/bin/sh
export RAYON_NUM_THREADS=\${SLURM_CPUS_PER_TASK:-1}
exec "$slump" sweep "$study" --out "$out" --shard "\$SLURM_ARRAY_TASK_ID/$tasks"
JOB
)
merge=$(sbatch --parsable --dependency="afterok:$array" --kill-on-invalid-dep=yes \
    --job-name=slump-merge --output="$out/merge.log" "$@" <<JOB
#!/bin/sh
exec "$slump" sweep merge "$study" "$out"
JOB
)
echo "$array $merge"
