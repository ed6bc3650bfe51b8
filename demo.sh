#!/usr/bin/env bash
# Shows what Relume does: sets up, builds, bakes a scene that ships, writes its lightmap and a picture lit by it to out/.
#
#   ./demo.sh [SCENE.glb]
set -euo pipefail
cd "$(dirname "$0")"

scene=${1:-assets/scenes/cornell_geom.glb}
out=out
relume=build/release/app/relume

./setup.sh
cmake --preset release >/dev/null
cmake --build --preset release --target relume

mkdir -p $out
started=$(date +%s.%N)
$relume bake "$scene" -o $out/lightmap.exr --picture $out/lightmap.png --json $out/lightmap.json --size 256 --error 0.02
seconds=$(echo "$started $(date +%s.%N)" | awk '{ printf "%.1f", $2 - $1 }')

$relume shot "$scene" -o $out/shot.png --lightmap $out/lightmap.exr --filter bicubic

echo
echo "Baked $scene in $seconds s:"
echo "  $PWD/$out/lightmap.exr   the lightmap, linear float32: what an engine multiplies with the albedo"
echo "  $PWD/$out/lightmap.png   the same as a picture"
echo "  $PWD/$out/shot.png       the scene lit by it"
echo "  $PWD/$out/lightmap.json  what was done and how fast"
