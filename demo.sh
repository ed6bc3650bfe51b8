#!/usr/bin/env bash
# Shows what Relume does: sets up, builds, then opens the viewer on a scene that ships. Where there is no display: bakes
# the scene, and writes a picture lit by it and its convergence as pictures to out/.
#
#   ./demo.sh [SCENE.glb]
#
# RELUME_DEMO=files takes the second way in any case.
set -euo pipefail
cd "$(dirname "$0")"

scene=${1:-assets/scenes/cornell_geom.glb}
out=out
relume=build/release/app/relume

./setup.sh
cmake --preset release >/dev/null
cmake --build --preset release --target relume

if [ "${RELUME_DEMO:-}" != files ] && [ -n "${DISPLAY:-}${WAYLAND_DISPLAY:-}" ]; then
    echo "Opening $scene: F1 shows all keys, Ctrl+Q quits."
    if $relume view "$scene"; then
        exit 0
    fi
    echo "Without a window, then."
fi

mkdir -p $out
started=$(date +%s.%N)
$relume bake "$scene" -o $out/lightmap.exr --picture $out/lightmap.png --json $out/lightmap.json --size 256 --error 0.02
seconds=$(echo "$started $(date +%s.%N)" | awk '{ printf "%.1f", $2 - $1 }')

$relume shot "$scene" -o $out/shot.png --lightmap $out/lightmap.exr --filter bicubic
$relume timelapse "$scene" -o $out/convergence --overwrite --size 720x405 --lightmap-size 256 --error 0.005

echo
echo "Baked $scene in $seconds s:"
echo "  $PWD/$out/lightmap.exr   the lightmap, linear float32: what an engine multiplies with the albedo"
echo "  $PWD/$out/lightmap.png   the same as a picture"
echo "  $PWD/$out/shot.png       the scene lit by it"
echo "  $PWD/$out/convergence/   how its light converges, picture by picture"
echo "  $PWD/$out/lightmap.json  what was done and how fast"
