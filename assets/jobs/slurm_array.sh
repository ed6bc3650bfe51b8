#!/usr/bin/env bash
# Bakes the lights of a scene as an array job of Slurm, one task per light, and joins them in a job that waits for all.
# It is run where sbatch is; all nodes must see the same folders.
#
#   slurm_array.sh SCENE OUT.exr --samples N [further OPTIONS of relume bake]
#
# What the tasks need is told to sbatch by its own variables, as SBATCH_PARTITION, or by options in SBATCH_OPTIONS, for
# instance "--gpus-per-task=1 --mem=16G". RELUME names the program, where it is not in the PATH. OUT.exr.jobs keeps the
# tasks' files until OUT.exr is there: where a task fails, the same command goes on with those that are missing.
set -euo pipefail
if [ $# -lt 2 ]; then
    echo "usage: slurm_array.sh SCENE OUT.exr --samples N [further OPTIONS of relume bake]" >&2
    exit 2
fi
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
export RELUME=${RELUME:-relume}
scene=$1 output=$2 folder=$2.jobs
shift 2
read -ra options <<<"${SBATCH_OPTIONS:-}"
count=$("$here/begin_jobs.sh" "$scene" "$folder" "$@")
quoted() { printf '%q ' "$@"; }
bake=$(
    sbatch --parsable --job-name=relume-lights --array="1-$count" --output="$folder/%a.log" "${options[@]}" <<END
#!/usr/bin/env bash
exec $(quoted "$here/bake_lights.sh") "\$SLURM_ARRAY_TASK_ID" 0 $(quoted "$scene" "$folder" "$@")
END
)
# 'JOB;CLUSTER' where there are several clusters.
sbatch --job-name=relume-join --dependency="afterok:${bake%%;*}" --output="$folder/join.log" "${options[@]}" <<END
#!/usr/bin/env bash
set -e
$(quoted "$RELUME" mix --join) $(printf '%q' "$folder")/*.exr -o $(quoted "$output")
$(quoted rm -r "$folder")
END
