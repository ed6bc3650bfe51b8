#!/usr/bin/env bash
# Begins a bake in jobs, or goes on with one: makes its folder with the names of the scene's lights.
#
#   begin_jobs.sh SCENE FOLDER [OPTIONS of relume bake]
#
# Prints how many lights there are. FOLDER/command keeps what was asked for, so that files of another bake are not taken for
# those of this one. RELUME names the program, where it is not in the PATH.
set -euo pipefail
scene=$1 folder=$2
shift 2
mkdir -p "$folder"
"${RELUME:-relume}" info "$scene" --light-names >"$folder/lights.new"
mv "$folder/lights.new" "$folder/lights"
if [ ! -s "$folder/lights" ]; then
    echo "error: $scene: nothing shines in it, so that there are no layers to bake: add a light" >&2
    exit 1
fi
command="$(cksum <"$scene") $(printf '%q ' "$@")"
if [ -e "$folder/command" ] && [ "$(cat "$folder/command")" != "$command" ]; then
    echo "error: $folder: is of another bake, of another scene or with other options: remove it" >&2
    exit 1
fi
printf '%s\n' "$command" >"$folder/command"
wc -l <"$folder/lights"
