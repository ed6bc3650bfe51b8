#!/usr/bin/env bash
# Time to quality against Blender's Cycles: bakes the lightmap of cornell_small with both, on the CPU, and writes
# OUT/results.tsv, OUT/README.part.md (tables) and OUT/cycles.svg (error over CPU time).
#
#   tests/bench/cycles_compare.sh RELUME OUT
#
# Needs Blender 3.4 or later on the PATH (apt-get install blender) and, on two cores, about half an hour. What OUT holds
# already is not baked again. Environment: SIZE (256), CYCLES_SAMPLES, RELUME_SAMPLES, REFERENCE_CYCLES and
# REFERENCE_RELUME (samples).
set -euo pipefail
if [ $# -ne 2 ]; then
    echo "usage: $0 RELUME OUT" >&2
    exit 2
fi
relume=$(realpath "$1")
mkdir -p "$2"
out=$(realpath "$2")
here=$(realpath "$(dirname "$0")")
size=${SIZE:-256}
bounces=24
cycles_samples=${CYCLES_SAMPLES:-16,64,256,1024,2620}
relume_samples=${RELUME_SAMPLES:-8 16 32 64 128 256 512 1024}
reference_cycles=${REFERENCE_CYCLES:-4096}
reference_relume=${REFERENCE_RELUME:-8192}
if ! command -v blender >/dev/null; then
    echo "$0: there is no blender: apt-get install blender" >&2
    exit 1
fi

scene=$out/cornell_small.glb
"$relume" -q scene cornell_small -o "$scene" >/dev/null

bakeByCycles() { # $1: prefix, $2: samples, $3: seed
    [ -s "$1.log" ] && grep -q '^Blender quit' "$1.log" && return
    blender -b --factory-startup -t "$(nproc)" -P "$here/cycles_bake.py" -- \
        "$scene" "$size" $bounces "$2" "$3" "$1" >"$1.log" 2>&1
}

# Appends the user and system seconds of the whole process to $1.cpu.
bakeByRelume() { # $1: prefix, the rest: options
    local prefix=$1
    shift
    [ -s "$prefix.json" ] && return
    local TIMEFORMAT='%U %S'
    { time "$relume" -q bake "$scene" --size "$size" --method hybrid --passes $bounces "$@" -o "$prefix.exr" \
        --json "$prefix.json" 2>"$prefix.err" >/dev/null; } 2>"$prefix.cpu"
}

bakeByCycles "$out/cycles" "$cycles_samples" 1
bakeByCycles "$out/reference" "$reference_cycles" 2
bakeByRelume "$out/relume-reference" --samples "$reference_relume" --no-smooth
bakeByRelume "$out/warm" --samples 8 # compiles the shaders
for samples in $relume_samples; do
    bakeByRelume "$out/smooth-$samples" --samples "$samples"
    bakeByRelume "$out/plain-$samples" --samples "$samples" --no-smooth
done

mask=$out/reference-mask.exr
error() { # of $1 against $2
    "$relume" -q compare "$1" "$2" --mask "$mask" --metric relrmse
}
ours=$out/relume-reference.exr
theirs=$out/reference-$reference_cycles.exr
{
    printf 'kind\tsamples\tprocess_cpu\tsolver_wall\terror_relume\terror_cycles\n'
    printf 'agreement\t%s\t\t\t%s\t\n' "$reference_cycles" "$(error "$theirs" "$ours")"
    grep -h '^cycles [0-9]' "$out/cycles.log" "$out/reference.log" | while read -r _ samples cpu _; do
        map=$out/cycles-$samples.exr
        [ -e "$map" ] || map=$theirs
        printf 'cycles\t%s\t%s\t\t%s\t%s\n' "$samples" "$cpu" "$(error "$map" "$ours")" "$(error "$map" "$theirs")"
    done
    for kind in smooth plain; do
        for samples in $relume_samples; do
            prefix=$out/$kind-$samples
            cpu=$(awk '{print $1 + $2}' "$prefix.cpu")
            wall=$(sed -n 's/^ *"solve": \([0-9.e+-]*\),*$/\1/p' "$prefix.json")
            printf '%s\t%s\t%s\t%s\t%s\t%s\n' "$kind" "$samples" "$cpu" "$wall" "$(error "$prefix.exr" "$ours")" \
                "$(error "$prefix.exr" "$theirs")"
        done
    done
} >"$out/results.tsv"
python3 "$here/cycles_report.py" "$out/results.tsv" "$(nproc)" "$out/cycles.svg" >"$out/README.part.md"
cat "$out/README.part.md"
