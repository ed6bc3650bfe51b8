#!/usr/bin/env bash
# One job: bakes lights of a scene, each into a file of its own that has its layer.
#
#   bake_lights.sh FIRST STEP SCENE FOLDER [OPTIONS of relume bake]
#
# FOLDER/lights has the names, one per line, as begin_jobs.sh has made it. Of these lines it takes number FIRST and every
# STEP-th one after it, with a STEP of 0 that one alone. The light of line 7 goes to FOLDER/7.exr. A file that is there is
# not baked again, as it is whole: so a job that failed can simply be started again. RELUME names the program, where it is
# not in the PATH.
set -euo pipefail
if [ $# -lt 4 ]; then
    echo "usage: bake_lights.sh FIRST STEP SCENE FOLDER [OPTIONS of relume bake]" >&2
    exit 2
fi
first=$1 step=$2 scene=$3 folder=$4
shift 4
mapfile -t lights <"$folder/lights"
for ((number = first; number <= ${#lights[@]}; number += step)); do
    file=$folder/$number.exr
    [ -e "$file" ] || "${RELUME:-relume}" bake "$scene" --layers --lights "${lights[number - 1]}" -o "$file" "$@"
    [ "$step" -gt 0 ] || break
done
