#!/usr/bin/env bash
# The manners of the command line: help everywhere, exit status 0, 1 (the world) or 2 (wrong usage), results on stdout,
# and one line on stderr that names the file.
#
#   tests/cli.sh RELUME
set -uo pipefail
relume=$(realpath "$1")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/here"
cd "$work/here" # it must run from any folder
errors=0

fail() {
    echo "FAILED: $1"
    head -n 5 "$work/out" | sed 's/^/  stdout: /'
    head -n 5 "$work/err" | sed 's/^/  stderr: /'
    errors=$((errors + 1))
}

runRelume() { # status in $status, outputs in files out and err
    command="relume $*"
    "$relume" "$@" >"$work/out" 2>"$work/err" </dev/null
    status=$?
}

expectStatus() { # $1: status, the rest: the command line
    local expected=$1
    shift
    runRelume "$@"
    [ $status -eq "$expected" ] || fail "$command: status $status, not $expected"
}

expectHelp() {
    expectStatus 0 "$@" --help
    grep -q '^Usage: ' "$work/out" || fail "$command: no usage on stdout"
    [ ! -s "$work/err" ] || fail "$command: something on stderr"
}

# Wrong usage: status 2, nothing on stdout, one line on stderr.
expectUsageError() {
    expectStatus 2 "$@"
    [ ! -s "$work/out" ] || fail "$command: something on stdout"
    [ "$(wc -l <"$work/err")" -eq 1 ] || fail "$command: stderr is not one line"
}

# $1: all that stderr says; the rest: the command line.
expectRefusal() {
    local text=$1
    shift
    expectUsageError "$@"
    [ "$(cat "$work/err")" = "$text" ] || fail "$command: stderr is not '$text'"
}

# $1: what the only line on stderr must name; the rest: the command line.
expectWorldError() {
    local name=$1
    shift
    expectStatus 1 "$@"
    [ ! -s "$work/out" ] || fail "$command: something on stdout"
    [ "$(wc -l <"$work/err")" -eq 1 ] || fail "$command: stderr is not one line"
    grep -qF "$name" "$work/err" || fail "$command: stderr does not name $name"
}

verbs=(bake shot timelapse edit info unwrap scene devices mix compare bench samples)

expectHelp
cp "$work/out" "$work/help"
for verb in "${verbs[@]}"; do
    grep -Eq "^ +$verb( |\$)" "$work/help" || fail "relume --help does not list $verb"
    expectHelp "$verb"
done

expectStatus 0 --version
grep -Eq '^relume [0-9]+\.[0-9]+\.[0-9]+$' "$work/out" || fail "relume --version: not 'relume X.Y.Z'"

expectUsageError
expectUsageError nosuchverb
expectUsageError --nosuchoption
for verb in bake shot timelapse edit info unwrap mix compare; do
    expectUsageError "$verb" # the scene or the files are missing
    expectUsageError "$verb" --nosuchoption
done
expectUsageError bake room.glb # no -o
expectUsageError bake room.glb -o room.exr --size many
expectUsageError bake room.glb -o room.exr --half=nan
expectRefusal "error: --density: '-1' is not allowed: give a number above 0, at most 1000000" \
    bake room.glb -o room.exr --density -1
expectRefusal "error: --window: '-1' is not allowed: choose 1, 2, 4, 8, 16 or 32" bake room.glb -o room.exr --window -1
expectRefusal "error: --indirect-scale: 'abc' is not allowed: choose 1, 2 or 4" \
    bake room.glb -o room.exr --indirect-scale abc
expectRefusal "error: --size: '' is not allowed: give a whole number from 8 to 4096" \
    bake room.glb -o room.exr --size= --error 0.1
expectRefusal "error: --ppd: 'nan' is not allowed: give a number from 1 to 1000" compare a.exr b.exr --ppd nan
expectRefusal "error: --error: 'nan' is not allowed: give a number from 0.0001 to 1" bench edits room.glb --error nan
expectRefusal "error: --msaa: 'abc' is not allowed: choose 0, 2, 4 or 8" bench frames room.glb --msaa abc
expectRefusal "error: --display: 'x' is not allowed: choose auto, shared or copied" bench frames room.glb --display x
expectRefusal "error: 'bakee' is no verb and no scene (.glb or .gltf): did you mean 'bake'?" bakee room.glb
expectUsageError bake room.glb -o room.exr --picture room.jpg
expectUsageError bake room.glb -o room.exr --tracer nosuchtracer
expectUsageError bake room.glb -o room.exr --tracer voxel --voxels 31
expectUsageError bake room.glb -o room.exr --tracer voxel --voxel-ratio 2
expectUsageError bake room.glb -o room.exr --voxels 64
expectUsageError bake room.glb -o room.exr --voxel-ratio 257
expectUsageError bake room.glb -o room.exr --method nosuchmethod
expectUsageError bake room.glb -o room.exr --indirect-scale 3
expectUsageError bake room.glb -o room.exr --preset nosuchpreset
expectUsageError bake room.glb -o room.exr --quantity nosuchquantity
expectUsageError bench methods room.glb # no --html
expectUsageError bench methods room.glb --html r.html --windows 3
expectUsageError bench methods room.glb --html r.html --samples 0
expectUsageError bench methods room.glb --html r.html --methods nosuchmethod
expectUsageError bench methods room.glb --html r.html --sizes 64 --picture-size 128
expectUsageError bench edits room.glb --lights 0
expectUsageError bench edits room.glb --error 0
expectUsageError bench edits room.glb --tracer nosuchtracer
expectUsageError compare a.exr b.exr --metric nosuchmetric
expectUsageError compare a.exr b.exr --diff diff.exr

expectUsageError bake room.glb -o room.exr --method pure --directions lec
expectUsageError bake room.glb -o room.exr --method pure --rotate tile
expectUsageError bake room.glb -o room.exr --method mipmapped --footprint
expectUsageError bake room.glb -o room.exr --rotate sometimes
expectUsageError samples
expectUsageError samples 0
expectUsageError samples 16 --set nosuchset
expectUsageError samples 16 -o directions.txt
expectWorldError nosuchfolder samples 16 -o nosuchfolder/directions.csv

expectStatus 0 samples 16
[ "$(wc -l <"$work/out")" -eq 17 ] || fail "relume samples 16: not a head line and 16 directions"

expectUsageError bake room.glb -o room.exr --method pure --directions lec
expectUsageError bake room.glb -o room.exr --method pure --rotate tile
expectUsageError bake room.glb -o room.exr --rotate sometimes
expectUsageError samples
expectUsageError samples 0
expectUsageError samples 16 --set nosuchset
expectUsageError samples 16 -o directions.txt
expectWorldError nosuchfolder samples 16 -o nosuchfolder/directions.csv

expectStatus 0 samples 16
[ "$(wc -l <"$work/out")" -eq 17 ] || fail "relume samples 16: not a head line and 16 directions"

expectUsageError shot room.glb # no -o
expectUsageError shot room.glb -o shot.jpg
expectUsageError shot room.glb -o shot.png --size 640
expectUsageError shot room.glb -o shot.png --eye 1,2,3
expectUsageError shot room.glb -o shot.png --eye 1e30,0,0 --target 0,0,0
expectUsageError shot room.glb -o shot.png --view nosuchview
expectUsageError shot room.glb -o shot.png --lightmap room.exr --method pure
expectUsageError timelapse room.glb # no -o
expectUsageError timelapse room.glb -o frames --at 2,1
expectUsageError timelapse room.glb -o frames --at 1,2 --fps 5
expectUsageError timelapse room.glb -o frames --view albedo
expectUsageError timelapse room.glb -o frames.avi

expectUsageError edit room.glb -o out.glb # no edit
expectUsageError edit room.glb --set Lamp.intensity=1 # no -o
expectUsageError edit room.glb -o out.glb --set Lamp.intensity=nan
expectUsageError edit room.glb -o out.glb --set Lamp.brightness=1
expectUsageError edit room.glb -o out.glb --move Lamp=1,2
expectUsageError edit room.glb -o out.glb --add lantern
expectUsageError edit room.glb -o out.glb --delete Lamp --error 0.1 # of --bake alone
expectUsageError edit room.glb --delete Lamp --bake out.png --layer-memory 1G # no layers
expectUsageError edit room.glb --delete Lamp --bake out.exr --layer-memory lots

expectUsageError mix layers.exr # neither -o nor --list
expectUsageError mix layers.exr -o out.exr --set Lamp=nan
expectUsageError mix layers.exr -o out.exr --set Lamp
expectUsageError mix layers.exr -o out.png --layers-out
expectWorldError missing.exr mix missing.exr -o out.exr
expectWorldError nosuchfolder mix missing.exr -o nosuchfolder/out.exr
expectWorldError missing.glb edit missing.glb -o out.glb --delete Lamp
expectWorldError nosuchfolder edit missing.glb -o nosuchfolder/out.glb --delete Lamp
expectWorldError missing.glb bake missing.glb -o room.exr
expectWorldError missing.exr shot missing.glb -o shot.png --lightmap missing.exr
expectWorldError nosuchfolder shot missing.glb -o nosuchfolder/shot.png
expectWorldError nosuchfolder timelapse missing.glb -o nosuchfolder/frames
expectWorldError missing.glb info missing.glb
expectWorldError missing.glb unwrap missing.glb -o out.glb
expectWorldError missing.glb bench trace missing.glb
expectWorldError missing.glb bench methods missing.glb --html report.html
expectWorldError missing.glb bench edits missing.glb
expectWorldError missing.exr compare missing.exr other.exr

printf 'not a scene' >broken.glb
expectWorldError broken.glb info broken.glb
expectWorldError broken.glb bake broken.glb -o room.exr
expectWorldError nosuchfolder bake broken.glb -o nosuchfolder/room.exr
expectWorldError nosuchfolder bench methods broken.glb --html nosuchfolder/report.html
expectWorldError nosuchfolder bench edits broken.glb --plot nosuchfolder/edits.svg
expectWorldError nosuchfolder compare a.exr b.exr --diff nosuchfolder/diff.png
expectWorldError nosuchfolder bake broken.glb -o room.exr --picture nosuchfolder/room.png

# A run that fails leaves nothing behind.
left=$(ls | grep -vx broken.glb)
[ -z "$left" ] || fail "failed runs left behind: $left"

[ $errors -eq 0 ] && echo "command line: all as expected" || echo "command line: $errors failures"
[ $errors -eq 0 ]
