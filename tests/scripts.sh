#!/usr/bin/env bash
# The shell scripts: setup.sh with an apt that writes more than a pipe holds, and no script with a pipe whose reader may
# end before its writer does, which pipefail makes a failure now and then.
#
#   tests/scripts.sh [ROOT]
set -uo pipefail
root=$(realpath "${1:-$(dirname "$0")/..}")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
errors=0

fail() {
    echo "FAILED: $1"
    errors=$((errors + 1))
}

# Pipes of a script into grep -q, grep -m, head, a sed that quits, an awk that exits or a single read. One that is meant
# says "# is to end first".
hastyPipes() {
    sed -e 's/^[ \t]*#.*//' -e '/# is to end first$/d' "$1" |
        sed -e ':join' -e '/[|\\]$/{N;s/\\*\n[ \t]*/ /;bjoin' -e '}' |
        grep -E '[^|][|] *(grep +(-[a-zA-Z]+ +)*(-[a-zA-Z]*[qlm]|--(quiet|silent|max-count))|head\b|sed +[^|]*[0-9/;]q\b|awk +[^|]*\bexit\b|read\b)'
}

checkPipes() {
    local script found planted=0 plant
    while IFS= read -r script; do
        [ "${script##*/}" = scripts.sh ] && continue # what is searched for is written here
        found=$(hastyPipes "$script") && fail "${script#"$root"/}: its reader may end first: $found"
    done < <(find "$root" -maxdepth 3 \( -name '*.sh' -o -path '*/.ci/run' \) -not -path '*/build/*' -not -path '*/out/*')
    # The check itself: each of these must be found.
    for plant in 'apt-cache madison x # grep -q bpo' 'sources # sed -n s/a/b/p # head -n 1' 'a # grep -m 1 b' \
        'a # sed 5q' "a # awk '{ print; exit }'" 'a # grep -E -q b' 'a # grep -Eq b'; do
        printf '%s\n' "${plant//#/|}" >"$work/planted"
        if hastyPipes "$work/planted" >/dev/null; then planted=$((planted + 1)); else fail "not found: $plant"; fi
    done
    printf 'a |\n    grep -q b\n' >"$work/planted"
    hastyPipes "$work/planted" >/dev/null || fail "not found: a pipe that goes on in the next line"
    printf 'a || head b\n# a | head\ngrep -q b <<<"$a"\na | sed -n s/a/b/p\na | tail -n 1\n' >"$work/planted"
    hastyPipes "$work/planted" >/dev/null && fail "wrongly found: $(hastyPipes "$work/planted")"
    [ $planted -eq 7 ]
}

# A program in front of the machine's own.
fake() {
    printf '#!/bin/sh\n%s\n' "$2" >"$work/bin/$1"
    chmod +x "$work/bin/$1"
}

# Ten times what a pipe holds: who stops reading before the end makes the writer fail, however fast either is.
flood='awk "BEGIN { for (i = 0; i < 20000; i++) print \"no line that anybody looks for\" }"'

# Runs setUp of setup.sh as root on a Debian 12 without Mesa; status in $status, what was printed in out.
runSetUp() {
    (
        PATH="$work/bin:$PATH"
        . "$root/setup.sh"
        systemName() { echo "debian 12"; }
        backports=$work/backports.sources
        setUp
    ) >"$work/out" 2>&1
    status=$?
}

checkSetUp() {
    mkdir -p "$work/bin"
    fake id 'echo 0'
    fake dpkg-query 'exit 1' # nothing is installed
    fake apt-get "echo \"\$*\" >>'$work/asked'
case \"\$*\" in indextargets*) cat '$work/sources'; $flood ;; esac"
    fake apt-cache "echo ' mesa-vulkan-drivers | 25.0.7-2~bpo12+1 | http://mirror bookworm-backports/main'
$flood"

    echo 'Packages bookworm main http://mirror.test/debian/' >"$work/sources"
    runSetUp
    [ $status -eq 0 ] || fail "setup.sh with a long-winded apt: status $status: $(tail -n 2 "$work/out")"
    grep -q 'URIs: http://mirror.test/debian$' "$work/backports.sources" 2>/dev/null ||
        fail "setup.sh: backports do not come from the machine's own mirror"
    grep -q 'install .*-t bookworm-backports mesa-vulkan-drivers' "$work/asked" || fail "setup.sh: Mesa is not installed"
    grep -q 'install .*cmake ninja-build' "$work/asked" || fail "setup.sh: packages are not installed"

    # Sources that have the suite already stay as they are.
    rm -f "$work/backports.sources"
    echo 'Packages bookworm-backports main http://mirror.test/debian/' >>"$work/sources"
    runSetUp
    [ $status -eq 0 ] || fail "setup.sh where backports are there: status $status: $(tail -n 2 "$work/out")"
    [ ! -e "$work/backports.sources" ] || fail "setup.sh adds backports that are there"

    # A mirror without backports is told.
    fake apt-cache "$flood"
    runSetUp
    [ $status -eq 1 ] || fail "setup.sh without backports: status $status, not 1"
    grep -q 'the mirror has no bookworm-backports' "$work/out" || fail "setup.sh does not tell that backports are missing"
}

checkPipes
checkSetUp
[ $errors -eq 0 ] && echo "scripts: all as expected" || echo "scripts: $errors failures"
[ $errors -eq 0 ]
