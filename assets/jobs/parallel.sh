#!/usr/bin/env bash
# Bakes the lights of a scene as jobs by GNU parallel, where that is missing by xargs, and joins them.
#
#   parallel.sh SCENE OUT.exr --samples N [further OPTIONS of relume bake]
#
# JOBS is how many run at a time (2). OUT.exr.jobs keeps the jobs' files until OUT.exr is there: where a job fails, the same
# command goes on with those that are missing. RELUME names the program, where it is not in the PATH. Options of GNU
# parallel can be given in PARALLEL, as --sshlogin for other machines that see the same folders.
set -euo pipefail
if [ $# -lt 2 ]; then
    echo "usage: parallel.sh SCENE OUT.exr --samples N [further OPTIONS of relume bake]" >&2
    exit 2
fi
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
export RELUME=${RELUME:-relume}
scene=$1 output=$2 folder=$2.jobs
shift 2
count=$("$here/begin_jobs.sh" "$scene" "$folder" "$@")
if command -v parallel >/dev/null; then
    seq "$count" | parallel --quote --env RELUME --jobs "${JOBS:-2}" --halt soon,fail=1 \
        "$here/bake_lights.sh" {} 0 "$scene" "$folder" "$@"
else
    seq "$count" | xargs -P "${JOBS:-2}" -I '{}' "$here/bake_lights.sh" '{}' 0 "$scene" "$folder" "$@"
fi
"$RELUME" mix --join "$folder"/*.exr -o "$output"
rm -r "$folder"
