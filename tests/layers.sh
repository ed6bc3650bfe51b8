#!/usr/bin/env bash
# Fails on an #include that goes against tests/rooms.txt: a room includes only rooms that its line names. Beside that
#
# - the table itself is right: every folder with sources is a room, a room sees only rooms above it, and none for nothing;
# - units (X.h with X.cpp) have no include circle but where the table grants one;
# - nothing includes tests, and inside the project an include is the full path.
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
        # The room of a path: ground, or its folder; "" for what is none of ours.
        function roomOf(path) {
            if (path ~ /^shaders\/(shared[a-z_]*\.h$|lib\/)/) return "ground"
            if (path !~ /^(app|renderer|bake|assets|shaders|tests)\//) return ""
            if (path ~ /^shaders\//) return "shaders"
            sub(/\/[^\/]*$/, "", path)
            return path
        }
        function unitOf(path) {
            sub(/\.(h|cpp)$/, "", path)
            return path
        }
        function exists(path,   line, status) {
            status = (getline line < path)
            close(path)
            return status >= 0
        }
        function complain(text) {
            print text
            count++
        }
        function violation(reason) {
            complain(FILENAME ":" FNR ": includes \"" target "\": " reason)
        }
        function readTable(   line, room, seen, names, i, n) {
            while ((getline line < "tests/rooms.txt") > 0) {
                if (line ~ /^circle /) {
                    split(line, names, /[ :]+/)
                    granted[names[2]] = 1
                }
                if (line !~ /^[a-z\/]+:/) continue
                room = line
                sub(/:.*/, "", room)
                seen = line
                sub(/^[^:]*:/, "", seen)
                n = split(seen, names)
                may[room] = " ground " room " "
                for (i = 1; i <= n; i++) {
                    if (!(names[i] in may)) complain("tests/rooms.txt: " room " sees " names[i] ", which is no room above it")
                    sees[room, names[i]] = 1
                    may[room] = may[room] names[i] " "
                }
            }
            close("tests/rooms.txt")
            may["ground"] = " ground "
        }
        # Takes away units that include none of the others, or that none includes, until all that are left lie on circles
        # or between two.
        function reportCircles(   unit, edge, ends, changed, from, to) {
            for (edge in edges) {
                split(edge, ends, SUBSEP)
                left[ends[1]] = left[ends[2]] = 1
            }
            do {
                changed = 0
                split("", from)
                split("", to)
                for (edge in edges) {
                    split(edge, ends, SUBSEP)
                    if (!(ends[1] in left) || !(ends[2] in left)) continue
                    from[ends[1]] = to[ends[2]] = 1
                }
                for (unit in left)
                    if (!(unit in from) || !(unit in to)) {
                        delete left[unit]
                        changed = 1
                    }
            } while (changed)
            for (unit in left)
                if (!(roomOf(unit ".h") in granted)) complain(unit ": lies on an include circle")
        }
        BEGIN { readTable() }
        FNR == 1 {
            files++
            from = roomOf(FILENAME)
            if (!(from in may) && !(from in homeless)) {
                homeless[from] = 1
                complain(from ": is no room of tests/rooms.txt")
            }
        }
        match($0, /^[ \t]*#[ \t]*include[ \t]*["<][^">]*[">]/) {
            target = substr($0, RSTART, RLENGTH)
            sub(/^[^"<]*["<]/, "", target)
            sub(/[">]$/, "", target)
            here = FILENAME
            sub(/[^\/]*$/, "", here)
            to = roomOf(target)
            used[from, to] = 1
            if (target ~ /\.h$/ && FILENAME ~ /\.(h|cpp)$/ && unitOf(target) != unitOf(FILENAME))
                edges[unitOf(FILENAME), unitOf(target)] = 1
            # A path with ".." hides where it goes; GLSL includes are relative to shaders/ or to the file.
            if (target ~ /(^|\/)\.\.(\/|$)/) violation("write the full path from the root")
            else if (to != "" && (from in may) && index(may[from], " " to " ") == 0) violation(from " may include" may[from] "only")
            else if (to == "" && exists(here target) && FILENAME !~ /^shaders\//) violation("write the full path from the root")
        }
        END {
            if (files == 0) complain("no source file found")
            for (pair in sees)
                if (!(pair in used)) {
                    split(pair, ends, SUBSEP)
                    complain("tests/rooms.txt: " ends[1] " sees " ends[2] " for nothing")
                }
            reportCircles()
            exit count > 0
        }'
    )
}

# The house of the planted violations: rooms on two levels, and what each includes rightfully.
table="
assets/base:
shaders:      assets/base
bake/vk:      assets/base shaders
bake/trace:   bake/vk
renderer:     assets/base
app/panels:   bake/trace renderer
circle bake/vk: planted
"
tree="
assets/base/log.h|stb_image_write.h
shaders/shader_library.cpp|assets/base/log.h
shaders/gather.comp|lib/pairs.glsl
shaders/lib/pairs.glsl|hit.glsl
shaders/lib/hit.glsl|
shaders/shared.h|
bake/vk/device.h|assets/base/log.h
bake/vk/device.cpp|bake/vk/buffer.h
bake/vk/buffer.h|bake/vk/device.h
bake/vk/program.h|shaders/shader_library.h
bake/trace/tracer.h|bake/vk/device.h
bake/trace/ray.h|shaders/lib/pairs.glsl
renderer/camera.h|assets/base/log.h
renderer/box.h|shaders/shared.h
app/panels/panel.h|bake/trace/tracer.h
app/panels/panel.cpp|renderer/camera.h
app/panels/options.h|CLI/CLI.hpp
"

# What is planted: file|included path|what is said of it. One kind a line.
planted="
assets/base/more.h|bake/trace/tracer.h|assets/base/more.h:1: includes
assets/base/more.h|renderer/camera.h|assets/base/more.h:1: includes
assets/base/more.h|app/panels/panel.h|assets/base/more.h:1: includes
assets/base/more.h|shaders/shader_library.h|assets/base/more.h:1: includes
assets/base/more.h|log.h|write the full path
bake/vk/more.h|bake/trace/tracer.h|bake/vk may include
bake/vk/more.h|renderer/camera.h|bake/vk may include
bake/vk/more.h|tests/unit/probe.h|bake/vk may include
bake/vk/more.h|../trace/tracer.h|write the full path
bake/trace/more.cpp|shaders/shader_library.h|bake/trace may include
renderer/more.h|bake/trace/tracer.h|renderer may include
renderer/more.h|app/panels/panel.h|renderer may include
shaders/more.h|bake/trace/tracer.h|shaders may include
shaders/lib/more.glsl|assets/base/log.h|ground may include
shaders/more.comp|bake/trace/tracer.h|shaders may include
shaders/shared.h|shaders/shader_library.h|ground may include
app/panels/more.h|tests/unit/probe.h|app/panels may include
app/panels/more.h|bake/vk/device.h|app/panels may include
app/more.cpp|app/panels/panel.h|app: is no room
bake/trace/deep/more.h|vector|bake/trace/deep: is no room
bake/trace/ray.h|bake/trace/tracer.h bake/trace/tracer.h>bake/trace/ray.h|bake/trace/ray: lies on an include circle
app/panels/panel.cpp|app/panels/options.h app/panels/options.h>app/panels/panel.h|app/panels/options: lies on an include circle
tests/rooms.txt|bake/vk: bake/trace|bake/vk sees bake/trace, which is no room above it
tests/rooms.txt|renderer: shaders|renderer sees shaders for nothing
"

addInclude() { # file $1 includes $2
    mkdir -p "$(dirname "$1")"
    [ -z "$2" ] || printf '#include "%s"\n' "$2" >>"$1"
    touch "$1"
}

plantTree() { # the rightful tree, at $1
    local file target
    rm -rf "$1"
    mkdir -p "$1/tests"
    printf '%s' "$table" >"$1/tests/rooms.txt"
    while IFS='|' read -r file target; do
        [ -z "$file" ] || addInclude "$1/$file" "$target"
    done <<<"$tree"
}

plant() { # in the tree at $1, into file $2, what $3 says: includes, separated by spaces; "FILE>PATH" goes into FILE
    local what
    if [ "$2" = tests/rooms.txt ]; then
        # One more room that is seen, in the line of its room.
        sed -i "s,^\(${3%%:*}:.*\)\$,\1 ${3#*: }," "$1/$2"
        return
    fi
    for what in $3; do
        case "$what" in
            *">"*) addInclude "$1/${what%%>*}" "${what#*>}" ;;
            *) addInclude "$1/$2" "$what" ;;
        esac
    done
}

checkPlanted() {
    local errors=0 kinds=0 file what said
    folder=$(mktemp -d) # not local: the trap outlives this function
    trap 'rm -rf "$folder"' EXIT
    plantTree "$folder/planted"
    if ! check "$folder/planted"; then
        echo "wrongly reported: the above"
        errors=$((errors + 1))
    fi
    while IFS='|' read -r file what said; do
        [ -n "$file" ] || continue
        kinds=$((kinds + 1))
        plantTree "$folder/planted"
        plant "$folder/planted" "$file" "$what"
        if check "$folder/planted" >"$folder/found"; then
            echo "not found: $file: $what"
            errors=$((errors + 1))
        elif ! grep -qF "$said" "$folder/found"; then
            echo "not named: $file: $what: $(cat "$folder/found")"
            errors=$((errors + 1))
        fi
    done <<<"$planted"
    echo "layers: $kinds planted violations, $errors judged wrongly"
    [ $errors -eq 0 ]
}

case "${1:-}" in
    --planted) checkPlanted ;;
    *)
        root=${1:-$(dirname "$0")/..}
        if check "$root"; then
            echo "layers: all includes go by tests/rooms.txt"
        else
            echo "layers: the above goes against tests/rooms.txt (see the top of $0)"
            exit 1
        fi
        ;;
esac
