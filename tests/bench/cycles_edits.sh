#!/usr/bin/env bash
# A moved light against Blender's Cycles, which bakes anew: one of 16 lamps is moved in a scene that relume has baked, and the
# scene as it is then is baked by Cycles, both on the CPU. Prints a table.
#
#   tests/bench/cycles_edits.sh RELUME SCENE OUT
#
# Needs Blender 3.4 or later on the PATH (apt-get install blender). What OUT holds already is not baked again. Environment:
# SIZE (256), LIGHTS (16), CYCLES_SAMPLES (64,512: two counts), REFERENCE (directions per patch of relume's references, 1024).
#
# Cycles bakes each count twice, with two seeds: their difference over the square root of two is its error, free of what the
# two programs see differently. How long it takes to 2 % follows from both counts: time grows by the sample, the error falls
# with their root, which the two counts let check.
set -euo pipefail
if [ $# -ne 3 ]; then
    echo "usage: $0 RELUME SCENE OUT" >&2
    exit 2
fi
relume=$(realpath "$1")
scene=$(realpath "$2")
mkdir -p "$3"
out=$(realpath "$3")
here=$(realpath "$(dirname "$0")")
size=${SIZE:-256}
bounces=24
counts=${CYCLES_SAMPLES:-64,512}
few=${counts%%,*}
many=${counts##*,}
if ! command -v blender >/dev/null; then
    echo "$0: there is no blender: apt-get install blender" >&2
    exit 1
fi

moved=$out/moved.${scene##*.}
[ -s "$out/relume.json" ] || "$relume" -q bench edits "$scene" --size "$size" --lights "${LIGHTS:-16}" \
    --reference-samples "${REFERENCE:-1024}" --write-scene "$moved" --json "$out/relume.json" | tee "$out/relume.txt"
for seed in 1 2; do
    log=$out/cycles$seed.log
    [ -s "$log" ] && grep -q '^Blender quit' "$log" && continue
    blender -b --factory-startup -t "$(nproc)" -P "$here/cycles_bake.py" -- \
        "$moved" "$size" $bounces "$counts" "$seed" "$out/cycles$seed" >"$log" 2>&1
done

apart() { # $1: samples
    "$relume" -q compare "$out/cycles1-$1.exr" "$out/cycles2-$1.exr" --mask "$out/cycles1-mask.exr" --metric relrmse
}
wall() { # $1: samples
    awk -v n="$1" '$1 == "cycles" && $2 == n { sum += $4; count++ } END { print sum / count }' "$out"/cycles[12].log
}
python3 - "$out/relume.json" "$few" "$(wall "$few")" "$(apart "$few")" "$many" "$(wall "$many")" "$(apart "$many")" <<'END'
import json
import sys

report = json.load(open(sys.argv[1]))
few, few_wall, few_apart, many, many_wall, many_apart = map(float, sys.argv[2:])
aim = 0.02
few_error, many_error = few_apart / 2**0.5, many_apart / 2**0.5
needed = many * (many_error / aim) ** 2
seconds = many_wall + (needed - many) * (many_wall - few_wall) / (many - few)
move = report["counts"][-1]["move"]
print("| %s at %d x %d, %d lamps | |" % (report["scene"], report["size"], report["size"], report["counts"][-1]["lamps"]))
print("|---|---|")
print("| Cycles, %d samples: error, seconds | %.3g %%, %.3g |" % (few, 100 * few_error, few_wall))
print("| Cycles, %d samples: error, seconds | %.3g %%, %.3g |" % (many, 100 * many_error, many_wall))
print("| error times root of samples, both | %.3g, %.3g |" % (few_error * few**0.5, many_error * many**0.5))
print("| Cycles to 2 %% by these: samples, seconds | %.0f, %.3g |" % (needed, seconds))
for name, key in (("the moved lamp's first picture", "firstSeconds"), ("its layer within 2 %", "secondsTo2Percent"),
                  ("its layer at 2 % as told", "seconds")):
    if move[key]:
        print("| %s: seconds | %.3g (%.0f times faster) |" % (name, move[key], seconds / move[key]))
END
