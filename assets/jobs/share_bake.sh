#!/usr/bin/env bash
#SBATCH --job-name=relume
#SBATCH --ntasks=4
# Bakes one lightmap by several processes that share its patches by MPI, one for each GPU, or each with its share of the
# cores. The bytes are those of one process. All machines must see the same folders.
#
#   [PROCESSES=N] share_bake.sh SCENE OUT.exr [further OPTIONS of relume bake]     by mpirun, on this machine
#   sbatch [--ntasks=N --gpus-per-task=1 ...] share_bake.sh SCENE OUT.exr [...]    by srun, in an allocation of Slurm
#
# RELUME names the program, where it is not in the PATH. Without PROCESSES there are two.
set -euo pipefail
if [ $# -lt 2 ]; then
    echo "usage: share_bake.sh SCENE OUT.exr [further OPTIONS of relume bake]" >&2
    exit 2
fi
relume=${RELUME:-relume} scene=$1 output=$2
shift 2
if [ -n "${SLURM_JOB_ID:-}" ]; then
    exec srun --mpi=pmix "$relume" bake "$scene" -o "$output" "$@"
fi
# Cores are not bound: relume divides them, and mpirun would give each process a single one.
exec mpirun --bind-to none -np "${PROCESSES:-2}" "$relume" bake "$scene" -o "$output" "$@"
