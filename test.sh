#!/usr/bin/env bash
# Sets up, builds and tests Relume; ends with ctest's summary and its status.
#
#   ./test.sh                          everything, release build
#   ./test.sh PRESET                   of CMakePresets.json: release, debug, asan, tsan, fuzz (libFuzzer, needs clang)
#   ./test.sh PRESET LABEL             only one label: unit (no Vulkan), core (of these, without the program), gpu,
#                                      live (any Vulkan device), ui (Xvfb), bench; with preset tsan: thread;
#                                      with asan or fuzz: fuzz
#   ./test.sh PRESET LABEL CTEST-ARGS  LABEL may be 'all': e.g. ./test.sh release all -R Furnace
#   ./test.sh web                      what browsers make of exported levels: sets up Chromium, Node.js and npm packages,
#                                      without which the tests of label web are skipped
#
# RELUME_WERROR=ON makes warnings errors.
set -euo pipefail
cd "$(dirname "$0")"

if [ "${1:-}" = web ]; then
    set -- release "$@"
fi
preset=${1:-release}
label=${2:-all}
shift $(($# < 2 ? $# : 2))
case "$preset $label" in
    -* | *" -"*)
        sed -n '2,13s/^# \{0,1\}//p' "$0"
        exit 2
        ;;
esac
target=(all)
only=()
if [ "$label" != all ]; then
    target=(relume_${label}_tests)
    only=(-L "^$label\$")
    if [ "$label" = unit ]; then
        target+=(relume_core_tests)
        only=(-L '^(unit|core)$')
    fi
fi

if [ "$label" = web ]; then
    ./setup.sh --web
else
    ./setup.sh
fi
cmake --preset "$preset" -DRELUME_TESTS=ON -DRELUME_WERROR="${RELUME_WERROR:-OFF}" >/dev/null
cmake --build --preset "$preset" --target "${target[@]}"
ctest --preset "$preset" -j "$(nproc)" "${only[@]}" "$@"
