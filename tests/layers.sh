#!/usr/bin/env bash
# Fails on an #include that goes against the order of the folders:
#
#   app -> renderer, bake -> assets;  shaders/shared.h and shaders/lib are the ground: anyone may include them
#
# renderer and bake do not see each other, nothing includes tests, and inside the project an include is the full path.
#
#   tests/layers.sh [ROOT]     checks the tree at ROOT (default: this one)
#   tests/layers.sh --planted  plants one violation of each kind in a copy and fails unless every one is found
set -euo pipefail

check() { # of the tree at $1; prints each violation, status 1 if there is one
    (
        cd "$1"
        find app renderer bake assets shaders -type f \
            \( -name '*.h' -o -name '*.cpp' -o -name '*.glsl' -o -name '*.vert' -o -name '*.frag' -o -name '*.comp' \
            -o -name '*.r????' -o -name '*.r???' \) | sort | tr '\n' '\0' |
            xargs -0 awk '
        # The layer of a path: ground, shaders (the library that compiles them), or the name of its folder.
        function layer(path) {
            if (path ~ /^shaders\/(shared[a-z_]*\.h$|lib\/)/) return "ground"
            return path ~ /^(app|renderer|bake|assets|shaders|tests)\// ? substr(path, 1, index(path, "/") - 1) : ""
        }
        function exists(path,   line, status) {
            status = (getline line < path)
            close(path)
            return status >= 0
        }
        function violation(reason) {
            printf "%s:%d: includes \"%s\": %s\n", FILENAME, FNR, target, reason
            count++
        }
        BEGIN {
            may["ground"] = " ground "
            may["assets"] = " ground assets "
            may["shaders"] = " ground assets shaders "
            may["bake"] = " ground assets shaders bake "
            may["renderer"] = " ground assets shaders renderer "
            may["app"] = " ground assets shaders bake renderer app "
        }
        match($0, /^[ \t]*#[ \t]*include[ \t]*["<][^">]*[">]/) {
            target = substr($0, RSTART, RLENGTH)
            sub(/^[^"<]*["<]/, "", target)
            sub(/[">]$/, "", target)
            from = layer(FILENAME)
            here = FILENAME
            sub(/[^\/]*$/, "", here)
            to = layer(target)
            # A path with ".." hides where it goes; GLSL includes are relative to shaders/ or to the file.
            if (target ~ /(^|\/)\.\.(\/|$)/) violation("write the full path from the root")
            else if (to != "" && index(may[from], " " to " ") == 0) violation(from " may include" may[from] "only")
            else if (to == "" && exists(here target) && FILENAME !~ /^shaders\//) violation("write the full path from the root")
        }
        FNR == 1 { files++ }
        END {
            if (files == 0) print "no source file found"
            exit count > 0 || files == 0
        }'
    )
}

# The tree of the planted violations: file|included path, one kind a line.
planted="
assets/scene.h|bake/trace/tracer.h
assets/scene.h|renderer/camera.h
assets/log.cpp|app/command.h
assets/log.cpp|shaders/shader_library.h
assets/log.cpp|log.h
bake/deep/solver.cpp|app/command.h
bake/solver.h|renderer/camera.h
bake/solver.h|tests/unit/probe.h
bake/solver.h|../app/command.h
renderer/camera.h|bake/solver.h
renderer/camera.h|app/command.h
shaders/shader_library.h|bake/solver.h
shaders/lib/pairs.glsl|assets/scene.h
shaders/gather.comp|bake/solver.h
shaders/shared.h|shaders/shader_library.h
app/command.h|tests/unit/probe.h
"

# Includes that are right; none may be reported.
rightful="
app/command.h|bake/solver.h
app/command.h|renderer/camera.h
app/command.h|CLI/CLI.hpp
bake/solver.h|assets/scene.h
bake/solver.h|shaders/shader_library.h
bake/solver.h|shaders/lib/pairs.glsl
renderer/camera.h|shaders/shared.h
assets/scene.h|shaders/shared.h
assets/scene.h|stb_image_write.h
shaders/gather.comp|lib/pairs.glsl
shaders/lib/pairs.glsl|hit.glsl
shaders/shader_library.cpp|assets/error.h
"

plant() { # a tree at $1 in which file $2 includes $3
    rm -rf "$1"
    mkdir -p "$1"/{app,renderer,bake/deep,bake/trace,assets,shaders/lib,tests/unit}
    touch "$1"/assets/log.h "$1"/shaders/lib/{hit,pairs}.glsl
    printf '#pragma once\n#include <vector>\n#include "%s"\n' "$3" >"$1/$2"
}

checkPlanted() {
    local errors=0 kinds=0 file target
    tree=$(mktemp -d) # not local: the trap outlives this function
    trap 'rm -rf "$tree"' EXIT
    while IFS='|' read -r file target; do
        [ -n "$file" ] || continue
        kinds=$((kinds + 1))
        plant "$tree/planted" "$file" "$target"
        if check "$tree/planted" >"$tree/found"; then
            echo "not found: $file includes $target"
            errors=$((errors + 1))
        elif ! grep -q "^$file:3: includes \"$target\"" "$tree/found"; then
            echo "not named: $file includes $target: $(cat "$tree/found")"
            errors=$((errors + 1))
        fi
    done <<<"$planted"
    while IFS='|' read -r file target; do
        [ -n "$file" ] || continue
        kinds=$((kinds + 1))
        plant "$tree/planted" "$file" "$target"
        if ! check "$tree/planted"; then
            echo "wrongly reported: $file includes $target"
            errors=$((errors + 1))
        fi
    done <<<"$rightful"
    echo "layers: $kinds planted includes, $errors judged wrongly"
    [ $errors -eq 0 ]
}

case "${1:-}" in
    --planted) checkPlanted ;;
    *)
        root=${1:-$(dirname "$0")/..}
        if check "$root"; then
            echo "layers: no upward include"
        else
            echo "layers: the includes above go against the order of the folders (see the top of $0)"
            exit 1
        fi
        ;;
esac
