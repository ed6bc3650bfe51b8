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
unset DISPLAY WAYLAND_DISPLAY # no window is to be opened
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

verbs=(bake shot timelapse edit info unwrap import scene devices mix compare bench samples)

expectHelp
cp "$work/out" "$work/help"
for verb in "${verbs[@]}"; do
    grep -Eq "^ +$verb( |\$)" "$work/help" || fail "relume --help does not list $verb"
    expectHelp "$verb"
done

expectStatus 0 --version
grep -Eq '^relume [0-9]+\.[0-9]+\.[0-9]+$' "$work/out" || fail "relume --version: not 'relume X.Y.Z'"

# Alone it shows the help, as there is no display for the viewer: none is named, or none can be reached.
for display in "" ":nosuchdisplay"; do
    DISPLAY=$display expectStatus 2
    grep -q '^Usage: ' "$work/out" || fail "relume without a display: no help on stdout"
    grep -q 'A subcommand is required' "$work/err" || fail "relume without a display: stderr does not say what is missing"
done
expectUsageError nosuchverb
expectUsageError --nosuchoption
for verb in bake shot timelapse edit info unwrap import mix compare; do
    expectUsageError "$verb" # the scene or the files are missing
    expectUsageError "$verb" --nosuchoption
done
expectUsageError bake room.glb # no -o
expectUsageError bake room.glb -o room.exr --size many
expectUsageError bake room.glb -o room.exr --half=nan
expectRefusal "error: --compression: 'dwaa' is not allowed: choose none, rle, zips, zip or piz" \
    bake room.glb -o room.exr --compression dwaa
expectRefusal "error: --compression zip: is of OpenEXR only: leave it out, or give the lightmap a name that ends in .exr" \
    bake room.glb -o room.png --compression zip
expectRefusal "error: --density: '-1' is not allowed: give a number above 0, at most 1000000" \
    bake room.glb -o room.exr --density -1
expectRefusal "error: --window: '-1' is not allowed: choose 1, 2, 4, 8, 16 or 32" bake room.glb -o room.exr --window -1
expectRefusal "error: --indirect-scale: 'abc' is not allowed: choose 1, 2 or 4" \
    bake room.glb -o room.exr --indirect-scale abc
expectRefusal "error: --size: '' is not allowed: give a whole number from 8 to 8192" \
    bake room.glb -o room.exr --size= --error 0.1
expectRefusal "error: --pages: '65' is not allowed: give a whole number from 1 to 64, or auto" bake room.glb -o room.exr --pages 65
expectRefusal "error: --pages auto: needs a --density to choose the number by" bake room.glb -o room.exr --pages auto
expectRefusal "error: --pages: pages consist of tiles of 8 x 8 texels, so that their --size is a multiple of 8, not 100: give 104" \
    bake room.glb -o room.exr --pages 4 --size 100
expectUsageError unwrap room.glb -o out.glb --pages 0
expectUsageError unwrap room.glb -o out.glb --pages auto --density 4 # no --size
expectUsageError shot room.glb -o shot.png --lightmap room.exr --pages 2
expectRefusal "error: --ppd: 'nan' is not allowed: give a number from 1 to 1000" compare a.exr b.exr --ppd nan
expectRefusal "error: --error: 'nan' is not allowed: give a number from 0.0001 to 1" bench edits room.glb --error nan
expectRefusal "error: --msaa: 'abc' is not allowed: choose 0, 2, 4 or 8" bench frames room.glb --msaa abc
expectRefusal "error: --display: 'x' is not allowed: choose auto, shared or copied" bench frames room.glb --display x
expectUsageError view room.glb --device 0 --bake-device second # one device bakes
expectRefusal "error: 'bakee' is no verb and no scene (.glb, .gltf, .obj, .fbx, ...): did you mean 'bake'?" bakee room.glb
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
expectUsageError bench quality room.glb --modes nosuchmode
expectUsageError bench quality room.glb --reference reference.png
expectUsageError bench quality room.glb --no-pictures --pictures folder
expectUsageError bench quality room.glb --seconds 0
expectUsageError bench edits room.glb --lights 0
expectUsageError bench edits room.glb --error 0
expectUsageError bench edits room.glb --tracer nosuchtracer
expectUsageError bench reload room.glb --lights 0
expectUsageError bench reload room.glb --samples 64 --error 0.01
expectUsageError compare a.exr b.exr --metric nosuchmetric
expectUsageError compare a.exr b.exr --diff diff.exr
expectUsageError compare a.exr b.exr --metric local --diff diff.exr

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
expectUsageError bake room.glb -o room.exr --method pure --points texel
expectUsageError bake room.glb -o room.exr --points everywhere
expectUsageError bake room.glb -o room.exr --rotate sometimes
expectUsageError samples
expectUsageError samples 0
expectUsageError samples 16 --set nosuchset
expectUsageError samples 16 -o directions.txt
expectWorldError nosuchfolder samples 16 -o nosuchfolder/directions.csv

expectStatus 0 samples 16
[ "$(wc -l <"$work/out")" -eq 17 ] || fail "relume samples 16: not a head line and 16 directions"

expectUsageError bake room.glb -o room.exr --scene-out scene.gltf # written as binary glTF
expectUsageError scene cornell_small -o scene.gltf
expectUsageError scene cornell_small -o scene.glb --split 0
expectUsageError unwrap room.glb -o scene.gltf
expectUsageError import room.obj -o scene.gltf
expectRefusal "error: --up: 'w' is not allowed: choose x, y or z" import room.obj -o out.glb --up w
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
expectUsageError mix layers.exr --probes-out out.json # no probes to weigh
expectUsageError mix layers.exr -o out.exr --probes-in probes.json # they go nowhere
expectUsageError mix layers.exr --probes-in probes.json --probes-out out.txt
expectUsageError bake room.glb -o room.exr --probe-at 1,2,3 --probes-out probes.ktx2 # no grid
expectUsageError export layers.exr --web page --probes probes.json # a page has none
expectUsageError mix layers.exr -o out.png --compression none
expectUsageError mix layers.exr -o out.png --join
expectRefusal "error: mix: 2 files: name one, or add --join to put their layers into one" mix a.exr b.exr -o out.exr
expectUsageError bake room.glb -o room.exr --lights Lamp # no --layers
expectUsageError info room.glb --json --light-names
expectWorldError missing.exr mix missing.exr -o out.exr
expectWorldError nosuchfolder mix missing.exr -o nosuchfolder/out.exr
expectWorldError missing.glb edit missing.glb -o out.glb --delete Lamp
expectWorldError nosuchfolder edit missing.glb -o nosuchfolder/out.glb --delete Lamp
expectWorldError missing.glb bake missing.glb -o room.exr
expectWorldError missing.exr shot missing.glb -o shot.png --lightmap missing.exr
expectWorldError nosuchfolder shot missing.glb -o nosuchfolder/shot.png
expectWorldError nosuchfolder timelapse missing.glb -o nosuchfolder/frames
expectWorldError missing.glb info missing.glb
expectWorldError missing.glb info missing.glb --light-names
expectWorldError missing.exr mix --join missing.exr other.exr -o out.exr
expectWorldError missing.glb unwrap missing.glb -o out.glb
expectWorldError missing.obj import missing.obj -o out.glb
expectWorldError missing.obj info missing.obj
expectWorldError missing.glb bench trace missing.glb
expectWorldError missing.glb bench trace missing.glb --whole
expectUsageError bench trace missing.glb --samples 16 # of --whole
expectUsageError bench trace missing.glb --whole --error 2
expectWorldError missing.glb bench methods missing.glb --html report.html
expectWorldError missing.glb bench edits missing.glb
expectWorldError missing.glb bench quality missing.glb
expectWorldError missing.glb bench reload missing.glb
expectWorldError missing.exr compare missing.exr other.exr
expectWorldError missing.exr compare missing.exr other.exr --metric local

printf 'not a scene' >broken.glb
expectWorldError broken.glb info broken.glb
expectWorldError broken.glb bake broken.glb -o room.exr
expectWorldError nosuchfolder bake broken.glb -o nosuchfolder/room.exr
expectWorldError nosuchfolder bench methods broken.glb --html nosuchfolder/report.html
expectWorldError nosuchfolder bench edits broken.glb --plot nosuchfolder/edits.svg
expectWorldError nosuchfolder compare a.exr b.exr --diff nosuchfolder/diff.png
expectWorldError nosuchfolder bake broken.glb -o room.exr --picture nosuchfolder/room.png

# Outputs that cannot be written are found before anything is read.
long=$(printf 'b%.0s' {1..252})
expectWorldError 'its name is too long' bake broken.glb -o "$long.exr"
expectWorldError 'its name is too long' bake broken.glb -o room.exr --json "$long.json"
expectWorldError 'its name is too long' shot broken.glb -o "$long.png"
expectWorldError 'its name is too long' timelapse broken.glb -o "$long$long"
expectWorldError 'its name is too long' edit broken.glb -o "$long.glb" --delete Lamp
expectWorldError 'its name is too long' unwrap broken.glb -o "$long.glb"
expectWorldError 'its name is too long' mix broken.exr -o "$long.exr"
expectWorldError 'its name is too long' compare a.exr b.exr --diff "$long.png"
expectWorldError 'its name is too long' samples 16 -o "$long.csv"

# A run that fails leaves nothing behind.
left=$(ls | grep -vx broken.glb)
[ -z "$left" ] || fail "failed runs left behind: $left"

# $1: an option, $2: another; the rest: a command line in which both name one file. Nothing is changed.
expectOneFile() {
    local first=$1 second=$2 before
    shift 2
    before=$(cat -- * 2>/dev/null | cksum)
    expectUsageError "$@"
    [ "$(wc -l <"$work/err")" -eq 1 ] || fail "$command: stderr is not one line"
    grep -qF -e "$first" "$work/err" || fail "$command: stderr does not name $first"
    grep -qF -e "$second" "$work/err" || fail "$command: stderr does not name $second"
    [ "$(cat -- * 2>/dev/null | cksum)" = "$before" ] || fail "$command: a file has changed"
}

mkdir "$work/files"
cd "$work/files"
expectStatus 0 scene lamps -o s.glb
ln -s s.glb soft.exr
ln -s s.glb soft.png
ln s.glb hard.exr
ln -s o.exr dangling
expectOneFile --json SCENE bake s.glb -o o.exr --json s.glb
expectOneFile --json SCENE bake s.glb -o o.exr --json ./s.glb
expectOneFile --output SCENE bake s.glb -o hard.exr
expectOneFile --output SCENE bake s.glb -o soft.exr
expectOneFile --checkpoint SCENE bake s.glb -o o.exr --checkpoint s.glb
expectOneFile --scene-out SCENE bake s.glb -o o.exr --scene-out s.glb
expectOneFile --output --json bake s.glb -o o.exr --json o.exr
expectOneFile --output --error-map bake s.glb -o o.exr --error-map "$PWD/o.exr"
expectOneFile --output --checkpoint bake s.glb -o o.exr --checkpoint dangling
expectOneFile --picture --error-map bake s.glb -o o.exr --picture p.png --error-map ./p.png
expectOneFile --checkpoint --json bake s.glb -o o.exr --checkpoint c --json c --resume c
expectOneFile --output SCENE shot s.glb -o soft.png
expectOneFile --output --lightmap shot s.glb --lightmap a.png -o a.png
expectOneFile --output SCENE unwrap s.glb -o s.glb
expectOneFile --bake SCENE edit s.glb --delete Bulb --bake hard.exr
expectOneFile --output --bake edit s.glb --delete Bulb -o o.exr --bake o.exr
expectOneFile --output LAYERS mix a.exr -o a.exr
expectOneFile --probes-out --probes-in mix a.exr --probes-in p.json --probes-out p.json
expectOneFile --output LAYERS mix --join b.exr a.exr -o a.exr
: >paged.0.exr # of several pages
expectOneFile --output LAYERS mix paged.exr -o paged.exr
expectOneFile --output LAYERS mix paged.exr -o paged.0.exr
expectOneFile --output --error-map bake s.glb -o o.exr --pages 2 --error-map o.1.exr
expectOneFile --diff A compare a.png b.exr --diff a.png
expectOneFile --diff B compare a.exr b.png --diff b.png
expectOneFile --diff --mask compare a.exr b.exr --mask m.png --diff ./m.png
expectOneFile --json SCENE bench trace s.glb --json s.glb
expectOneFile --json SCENE bench frames s.glb --json s.glb
expectOneFile --json SCENE bench edits s.glb --json s.glb
expectOneFile --json --plot bench edits s.glb --json j --plot j
expectOneFile --json SCENE bench reload s.glb --json s.glb
expectOneFile --plot --plot-rays bench quality s.glb --plot j --plot-rays j
expectOneFile --html SCENE bench methods s.glb --html s.glb
expectOneFile --html --json bench methods s.glb --html j --json j

# A scene's own files count, too.
printf '{"asset":{"version":"2.0"},"images":[{"uri":"wall.png"}],"scenes":[{"extras":{"relume":{"sky":
{"file":"sky.exr"}}}}]}' >own.gltf
: >wall.png
expectOneFile --picture SCENE bake own.gltf -o o.exr --picture wall.png
expectOneFile --output SCENE bake own.gltf -o sky.exr
printf 'mtllib own.mtl\nv 0 0 0\n' >own.obj
printf 'newmtl Wall\nmap_Kd wall.png\n' >own.mtl
expectOneFile --picture SCENE bake own.obj -o o.exr --picture wall.png
expectOneFile --json SCENE bench trace own.obj --json own.mtl
mkdir frames
printf '{"asset":{"version":"2.0"},"images":[{"uri":"frames/frame_0002.png"}]}' >framed.gltf
: >frames/frame_0002.png
expectOneFile --output SCENE timelapse framed.gltf -o frames --overwrite

# A scene may be edited in place, and keeps its rights; devices, FIFOs and links stay what they are.
chmod 600 s.glb
expectStatus 0 edit s.glb --add point,name=P,position=0,1,0 -o s.glb

# A scene that is no glTF file is opened as it is, by a child process, and saved as .glb.
printf 'v 0 0 0\nv 2 0 0\nv 2 0 3\nv 0 0 3\nf 4 3 2 1\n' >floor.obj
expectStatus 0 import floor.obj -o floor.glb --scale 0.5
grep -qx 'floor.glb: 1 meshes in 1 instances, 0 lights, 0 cameras' "$work/out" || fail "$command: wrong counts"
expectStatus 0 info floor.glb
grep -q '^area  *1.5 m^2$' "$work/out" || fail "$command: the area is not a quarter of 6 m^2"
expectStatus 0 info floor.obj
grep -q '^area  *6 m^2$' "$work/out" || fail "$command: the area is not 6 m^2"
expectStatus 0 unwrap floor.obj -o floor_uv.glb
expectStatus 0 edit floor.obj --add point,name=P,position=0,1,0 -o lit.glb
expectStatus 0 info lit.glb
grep -q "^point .*'P'" "$work/out" || fail "$command: the light is missing"
expectWorldError "relume import floor.obj -o OUT.glb" edit floor.obj --add point,name=P,position=0,1,0 -o floor.obj
expectRefusal "error: floor.obj: is no glTF file, so edits are saved into a new one: give -o OUT.glb, or make it with 'relume import floor.obj -o OUT.glb' first" edit floor.obj --add point,name=P,position=0,1,0
expectOneFile --output IN import floor.obj -o floor.obj
printf 'no scene' >odd.fbx
expectWorldError odd.fbx import odd.fbx -o odd.glb
[ ! -e odd.glb ] || fail "$command: something was written"
[ "$(stat -c %a s.glb)" = 600 ] || fail "$command: rights are $(stat -c %a s.glb), not 600"
[ s.glb -ef hard.exr ] || fail "$command: a hard link was cut"
[ -L soft.exr ] || fail "$command: a link is gone"
expectStatus 0 info hard.exr
mkfifo fifo.csv
cat fifo.csv >got &
expectStatus 0 samples 16 -o fifo.csv
wait $!
[ -p fifo.csv ] || fail "$command: the FIFO is none any more"
[ "$(wc -l <got)" -eq 17 ] || fail "$command: $(wc -l <got) lines came out of the FIFO"
ln -s /dev/null null.csv
expectStatus 0 samples 16 -o null.csv
[ -c /dev/null ] && [ -L null.csv ] || fail "$command: a device or a link to it is none any more"
rm -rf -- *

# Names of files need not be UTF-8.
name=$(printf 'caf\351')
mkdir "$name"
expectStatus 0 scene cornell_small -o "$name/$name.glb"
expectStatus 0 info "$name/$name.glb"
expectStatus 0 info --json "$name/$name.glb"
expectStatus 0 edit "$name/$name.glb" --add point,name=P,position=0,1,0 -o "$name.glb"
expectStatus 0 unwrap "$name/$name.glb" -o "$name.glb" --all
expectStatus 0 samples 4 -o "$name.json"
cd "$work/here"

# What is printed and does not arrive is an error; a reader that has enough is none.
expectLostOutput() {
    command="relume $*"
    "$relume" "$@" >/dev/full 2>"$work/err" </dev/null
    status=$?
    [ $status -eq 1 ] || fail "$command >/dev/full: status $status, not 1"
    [ "$(wc -l <"$work/err")" -eq 1 ] || fail "$command >/dev/full: stderr is not one line"
    grep -q 'the standard output cannot be written' "$work/err" || fail "$command >/dev/full: not told"
}
if [ -c /dev/full ]; then
    "$relume" -q scene cornell_small -o s.glb
    expectLostOutput --help
    expectLostOutput --version
    expectLostOutput bake --help
    expectLostOutput scene --list
    expectLostOutput samples 16
    expectLostOutput samples 60000
    expectLostOutput info s.glb
    expectLostOutput info --json s.glb
    expectLostOutput -q edit s.glb --add point,name=P,position=0,1,0 -o edited.glb
fi
"$relume" samples 16 >&- 2>"$work/err"
[ $? -eq 1 ] || fail "relume samples 16 >&-: a closed standard output is no error"
"$relume" samples 16 -o closed.csv >&- 2>"$work/err"
[ $? -eq 0 ] && [ "$(wc -l <closed.csv)" -eq 17 ] || fail "relume samples 16 -o closed.csv >&-: the file is not whole"
ignored=$(sed -n 's/^SigIgn:[[:space:]]*//p' /proc/self/status)
if ((16#${ignored:-0} >> 12 & 1)); then
    echo "command line: who runs this ignores SIGPIPE: not tested"
else
    "$relume" samples 60000 2>"$work/err" | sed -n 1q # is to end first
    [ "${PIPESTATUS[0]}" -eq 141 ] && [ ! -s "$work/err" ] || fail "a reader that has enough: $(cat "$work/err")"
fi

[ $errors -eq 0 ] && echo "command line: all as expected" || echo "command line: $errors failures"
[ $errors -eq 0 ]
