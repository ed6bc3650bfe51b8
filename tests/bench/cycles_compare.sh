#!/usr/bin/env bash
# Time to quality against Blender's Cycles: bakes the lightmap of cornell_small with both, on the CPU, and writes
# OUT/results.tsv, OUT/README.part.md (tables) and OUT/cycles.svg (error over CPU time).
#
#   tests/bench/cycles_compare.sh RELUME OUT
#
# Needs Blender 3.4 or later on the PATH (apt-get install blender) and, on two cores, about half an hour. What OUT holds
# already is not baked again. Environment: SIZE (256), CYCLES_SAMPLES, RELUME_SAMPLES, RELUME_REFERENCE (samples).
#
# Cycles bakes the last of its sample counts twice, with two seeds: their errors are independent. Against the truth that
# Cycles has in mind a map's squared error is then the mean product of its differences from both, which holds neither
# one's noise; no endless bake is needed to know whether the two programs agree.
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
cycles_samples=${CYCLES_SAMPLES:-16,64,256,655,1024}
relume_samples=${RELUME_SAMPLES:-16 32 64 128 256 512}
relume_reference=${RELUME_REFERENCE:-2048}
most=${cycles_samples##*,}
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
    { time "$relume" -q bake "$scene" --size "$size" --method hybrid "$@" -o "$prefix.exr" \
        --json "$prefix.json" 2>"$prefix.err" >/dev/null; } 2>"$prefix.cpu"
}

bakeByCycles "$out/cycles" "$cycles_samples" 1
bakeByCycles "$out/twin" "$most" 2
bakeByRelume "$out/reference" --samples "$relume_reference" --no-smooth
bakeByRelume "$out/warm" --samples 8 # compiles the shaders
for samples in $relume_samples; do
    bakeByRelume "$out/smooth-$samples" --samples "$samples"
    bakeByRelume "$out/plain-$samples" --samples "$samples" --no-smooth
done

mask=$out/twin-mask.exr
error() { # of $1 against $2
    "$relume" -q compare "$1" "$2" --mask "$mask" --metric relrmse
}
calculate() { # $1: an expression of awk's
    awk "BEGIN { v = $1; printf \"%.6g\\n\", (v > 0 ? sqrt(v) : 0) }"
}
reference=$out/reference.exr
one=$out/cycles-$most.exr
other=$out/twin-$most.exr
apart=$(error "$one" "$other")
againstCycles() { # the error of $1, a map that shares no noise with the two
    calculate "($(error "$1" "$one") ^ 2 + $(error "$1" "$other") ^ 2 - $apart ^ 2) / 2"
}
{
    printf 'kind\tsamples\tbake_cpu\tprocess_cpu\terror_relume\terror_cycles\n'
    printf 'agreement\t\t\t\t\t%s\n' "$(againstCycles "$reference")"
    grep '^cycles [0-9]' "$out/cycles.log" | while read -r _ samples cpu _; do
        map=$out/cycles-$samples.exr
        own=$(calculate "$(error "$map" "$other") ^ 2 - $apart ^ 2 / 2")
        printf 'cycles\t%s\t%s\t\t%s\t%s\n' "$samples" "$cpu" "$(error "$map" "$reference")" "$own"
    done
    for kind in smooth plain; do
        for samples in $relume_samples; do
            prefix=$out/$kind-$samples
            cpu=$(sed -n 's/^ *"bakeCpuSeconds": \([0-9.e+-]*\),*$/\1/p' "$prefix.json")
            process=$(awk '{print $1 + $2}' "$prefix.cpu")
            printf '%s\t%s\t%s\t%s\t%s\t%s\n' "$kind" "$samples" "$cpu" "$process" \
                "$(error "$prefix.exr" "$reference")" "$(againstCycles "$prefix.exr")"
        done
    done
} >"$out/results.tsv"
python3 "$here/cycles_report.py" "$out/results.tsv" "$out/cycles.svg" >"$out/README.part.md"
cat "$out/README.part.md"
