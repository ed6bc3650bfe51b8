#!/usr/bin/env bash
#SBATCH --job-name=relume
#SBATCH --ntasks=4
# Bakes the lights of a scene within one allocation of Slurm, as many at a time as it has tasks, and joins them; all nodes
# must see the same folders.
#
#   sbatch [--ntasks=N --gpus-per-task=1 ...] slurm_srun.sh SCENE OUT.exr --samples N [further OPTIONS of relume bake]
#
# JOBS_FOLDER names the folder that bake_lights.sh is in, where sbatch is called from elsewhere (Slurm runs a copy of this
# script). RELUME names the program, where it is not in the PATH. OUT.exr.jobs keeps the tasks' files until OUT.exr is
# there: where a task fails, the same command goes on with those that are missing.
set -euo pipefail
if [ $# -lt 2 ]; then
    echo "usage: sbatch slurm_srun.sh SCENE OUT.exr --samples N [further OPTIONS of relume bake]" >&2
    exit 2
fi
export RELUME=${RELUME:-relume} JOBS_FOLDER=${JOBS_FOLDER:-${SLURM_SUBMIT_DIR:-$(dirname "${BASH_SOURCE[0]}")}}
scene=$1 output=$2 folder=$2.jobs
shift 2
"$JOBS_FOLDER/begin_jobs.sh" "$scene" "$folder" "$@" >/dev/null
# Tasks are jobs of their own: --mpi=none keeps them from being taken for processes that share one bake.
srun --mpi=none --kill-on-bad-exit=0 bash -c \
    'exec "$JOBS_FOLDER/bake_lights.sh" $((SLURM_PROCID + 1)) "$SLURM_NTASKS" "$@"' task "$scene" "$folder" "$@"
"$RELUME" mix --join "$folder"/*.exr -o "$output"
rm -r "$folder"
