#!/usr/bin/env bash
# A level against Blender's Cycles, both on the CPU: how far a default bake's dark places are from a path tracer's, and
# the CPU seconds to a local error of 5 %. Prints a table.
#
#   tests/bench/cycles_level.sh RELUME SCENE OUT
#
# Needs Blender 3.4 or later on the PATH (apt-get install blender); some 5 minutes on two cores. What OUT holds already is
# not baked again. Environment: SIZE (256), CYCLES_SAMPLES (64,512).
#
# Cycles bakes twice, with two seeds. What one of them calls dark is compared in the other, whose noise has selected
# nothing there. Its local error is that of one seed against the other, divided by the root of two, which holds noise
# alone: no other program's idea of the light.
set -euo pipefail
if [ $# -ne 3 ]; then
    echo "usage: $0 RELUME SCENE OUT" >&2
    exit 2
fi
relume=$(realpath "$1")
level=$(realpath "$2")
mkdir -p "$3"
out=$(realpath "$3")
here=$(realpath "$(dirname "$0")")
size=${SIZE:-256}
samples=${CYCLES_SAMPLES:-64,512}
most=${samples##*,}
if ! command -v blender >/dev/null; then
    echo "$0: there is no blender: apt-get install blender" >&2
    exit 1
fi

scene=$out/level-$size.glb
[ -s "$scene" ] || "$relume" -q unwrap "$level" --size "$size" -o "$scene"
for seed in 1 2; do
    log=$out/cycles-$size-$seed.log
    [ -s "$log" ] && grep -q '^Blender quit' "$log" && continue
    blender -b --factory-startup -t "$(nproc)" -P "$here/cycles_bake.py" -- \
        "$scene" "$size" 24 "$samples" $seed "$out/cycles-$size-$seed" >"$log" 2>&1
done
bake=$out/relume-$size
[ -s "$bake.json" ] || "$relume" -q bake "$scene" --size "$size" -o "$bake.exr" --json "$bake.json"
long=$out/long-$size
[ -s "$long.json" ] ||
    "$relume" -q bake "$scene" --size "$size" --samples 2048 --no-smooth -o "$long.exr" --json "$long.json"

one=$out/cycles-$size-1
two=$out/cycles-$size-2
mask=$two-mask.exr
value() { # of $1, against $2; the rest: options
    "$relume" -q compare "$1" "$2" --mask "$mask" "${@:3}" 2>/dev/null
}
cpu() { # of a bake of ours: all of the process but reading and writing
    sed -n '/"cpuSeconds"/,/}/p' "$1" |
        awk -F'[:,]' '/"(start|load|write|other|total)"/ { next } $2 + 0 > 0 { s += $2 } END { printf "%.1f", s }'
}
echo "$size x $size: local error (p95), CPU seconds of the bake, and those that 5 % would take (error falls with the root of samples)"
grep '^cycles [0-9]' "$one.log" | while read -r _ n seconds _; do
    value "$one-$n.exr" "$two-$n.exr" --metric local |
        awk -v n="$n" -v s="$seconds" '{ e = $1 / sqrt(2); printf "Cycles %5d samples  %6.2f %%  %8.1f s  to 5 %%: %10.1f s\n", n, 100 * e, s, s * (e / 0.05) ^ 2 }'
done
value "$bake.exr" "$long.exr" --metric local |
    awk -v s="$(cpu "$bake.json")" '{ printf "relume, default        %6.2f %%  %8.1f s\n", 100 * $1, s }'
echo "darkest quarter against Cycles at $most samples (mean of A / mean of B - 1), and all texels"
for map in "$bake" "$long"; do
    dark=$(value "$map.exr" "$one-$most.exr" --metric dark --dark-by "$two-$most.exr")
    all=$("$relume" -q compare "$map.exr" "$one-$most.exr" --mask "$mask" --json 2>/dev/null |
        awk -F'[:,]' '/"meanA"/ { a = $2 } /"meanB"/ { b = $2 } END { print a / b - 1 }')
    awk -v m="$(basename "$map")" -v d="$dark" -v a="$all" 'BEGIN { printf "%-14s %+.1f %%  all %+.1f %%\n", m, 100 * d, 100 * a }'
done
