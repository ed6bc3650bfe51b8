#!/usr/bin/env bash
# Installs by apt what Relume needs to be built, run and tested. Changes nothing where everything is there already.
#
#   ./setup.sh        what a build and the tests need
#   ./setup.sh --ci   the format checker, git, which lists what it checks, and clang, which builds sanitized tests sooner
#   ./setup.sh --web  Chromium, Node.js and the npm packages of tests/web too, which open exported levels
#
# Debian 12: Mesa comes from bookworm-backports (the stock Mesa 22.3 has no ray tracing); the suite is added to apt's
# sources where it is missing. RELUME_KEEP_MESA=1 leaves an installed older Mesa alone. Debian 13, Ubuntu 24.04 and 26.04: the
# stock packages. Anything else: prints what is needed and stops with status 1.
# Nothing is ever removed, and a vendor's own driver stays: Mesa's software Vulkan device is installed beside it.
set -euo pipefail

packages=(
    cmake ninja-build ccache g++ pkgconf      # the build
    libvulkan-dev libvulkan-volk-dev          # Vulkan headers, loader, volk
    glslang-dev glslang-tools                 # GLSL to SPIR-V, at build time and at run time
    libembree-dev libtbb-dev                  # CPU ray tracing; its CMake files name TBB
    libassimp-dev                             # scenes that are no glTF files: .obj, .fbx, .dae, ...
    libglm-dev libtinygltf-dev libopenexr-dev libstb-dev zlib1g-dev libzstd-dev
    libdraco-dev libmeshoptimizer-dev         # compressed meshes of glTF files
    libwebp-dev                               # WebP pictures of glTF files
    libeigen3-dev                             # sparse equations, by which lightmap charts are flattened
    libepoxy-dev libegl-dev libgl-dev         # OpenGL: the pictures; EGL makes them without a display
    libglfw3-dev libimgui-dev                 # the viewer's window and panels
    fonts-dejavu-core                         # their letters: without it they are ImGui's bitmap of 13 pixels
    libcli11-dev libspdlog-dev nlohmann-json3-dev
    libopenmpi-dev openmpi-bin                # mpirun: several GPUs or machines share a bake
    libgtest-dev libbenchmark-dev vulkan-validationlayers
    xvfb xdotool libx11-dev                   # the tests of the window, on a machine without a display
)
# The software devices of Vulkan and OpenGL, and what a window needs of Mesa (GLX). All of one version: the viewer shares
# images between the devices, and an older GLX finds no picture format of a newer device.
mesa=(mesa-vulkan-drivers libgl1-mesa-dri libegl-mesa0 libglx-mesa0)
testedMesa=25 # on Debian 12 an older one is brought up to date; elsewhere the stock one is taken
backports=/etc/apt/sources.list.d/relume-backports.sources

usage() { sed -n '2,6s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; }

# "debian 12": what this machine runs.
systemName() {
    if [ -r /etc/os-release ]; then
        (. /etc/os-release && echo "${ID:-unknown} ${VERSION_ID:-}")
    else
        echo unknown
    fi
}

requireKnownSystem() {
    case "$system" in
        "debian 12" | "debian 13" | "ubuntu 24.04" | "ubuntu 26.04") return ;;
    esac
    {
        echo "setup: this is '$system'; only Debian 12 and 13, Ubuntu 24.04 and 26.04 are set up by this script."
        echo "Install these (Debian's names) by hand, then build as the README says:"
        echo "  ${packages[*]} and drivers of Vulkan 1.2 and OpenGL 4.5 (tested: Mesa $testedMesa)"
    } >&2
    exit 1
}

installedVersion() { # of one package, empty where it is not installed
    { dpkg-query -W -f='${db:Status-Status} ${Version}\n' "$1" 2>/dev/null || true; } | sed -n 's/^installed //p'
}

isInstalled() { [ -n "$(installedVersion "$1")" ]; }

lookForPackages() { # sets missing and needsMesa
    local package mesaVersion
    for package in "${packages[@]}"; do
        isInstalled "$package" || missing+=("$package")
    done
    for package in "${mesa[@]}"; do
        mesaVersion=$(installedVersion "$package")
        if [ -z "$mesaVersion" ]; then
            needsMesa=true
        elif [ "$system" = "debian 12" ] && [ -z "${RELUME_KEEP_MESA:-}" ] &&
            dpkg --compare-versions "$mesaVersion" lt "$testedMesa"; then
            needsMesa=true
        fi
    done
}

becomeRoot() {
    if [ "$(id -u)" -eq 0 ]; then
        return
    fi
    if ! command -v sudo >/dev/null; then
        echo "setup: installing packages needs root: run $0 as root or install sudo" >&2
        exit 1
    fi
    root=(sudo)
}

aptGet() {
    "${root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -o DPkg::Lock::Timeout=300 "$@"
}

install() {
    aptGet install -q -y --no-install-recommends --no-remove "$@"
}

# A pipe into a reader that ends before its input does, as `grep -q` and `head` do, ends the writer by SIGPIPE, which
# pipefail makes the status of all: what apt prints is read to its end before anything is looked for in it.

# Lines "suite component uri" of every package source that apt is configured with, in either file format.
sources() {
    apt-get indextargets --format '$(CREATED_BY) $(RELEASE) $(COMPONENT) $(REPO_URI)' | sed -n 's/^Packages //p'
}

addBackports() {
    local all mirrors mirror
    all=$(sources)
    if grep -Eq '^(bookworm|stable|oldstable)-backports main ' <<<"$all"; then
        return
    fi
    # The machine's own mirror, so that proxies and local mirrors go on working.
    mirrors=$(sed -En 's,^(bookworm|stable|oldstable) main (https?://),\2,p' <<<"$all")
    mirror=${mirrors%%$'\n'*}
    mirror=${mirror:-http://deb.debian.org/debian}
    echo "setup: adding bookworm-backports from $mirror in $backports"
    {
        printf 'Types: deb\nURIs: %s\nSuites: bookworm-backports\nComponents: main\n' "${mirror%/}"
        local keyring=/usr/share/keyrings/debian-archive-keyring.gpg
        if [ -r $keyring ]; then
            printf 'Signed-By: %s\n' $keyring
        fi
    } | "${root[@]}" tee "$backports" >/dev/null
}

requireBackports() {
    local versions
    versions=$(apt-cache madison "${mesa[0]}")
    if ! grep -q bpo12 <<<"$versions"; then
        echo "setup: the mirror has no bookworm-backports: put one that has it into $backports" >&2
        exit 1
    fi
}

installAll() {
    local wanted=("${missing[@]}")
    if [ $needsMesa = true ]; then
        wanted+=("${mesa[@]}")
    fi
    echo "setup: installing ${wanted[*]}"
    if [ $needsMesa = true ] && [ "$system" = "debian 12" ]; then
        addBackports
    fi
    aptGet update -q
    if [ $needsMesa = true ] && [ "$system" = "debian 12" ]; then
        requireBackports
        install -t bookworm-backports "${mesa[@]}"
    elif [ $needsMesa = true ]; then
        install "${mesa[@]}"
    fi
    if [ ${#missing[@]} -gt 0 ]; then
        install "${missing[@]}"
    fi
}

# Node.js is often there from elsewhere than Debian: its programs are looked for, not its packages.
addWebPackages() {
    packages+=(ca-certificates)
    command -v chromium >/dev/null || packages+=(chromium)
    command -v node >/dev/null || packages+=(nodejs)
    command -v npm >/dev/null || packages+=(npm)
}

installNpmPackages() {
    if [ "${1:-}" = --web ]; then
        # Two of the packages name other versions of a third one, which work as well.
        (cd "$(dirname "${BASH_SOURCE[0]}")/tests/web" &&
            npm install --no-audit --no-fund --no-package-lock --legacy-peer-deps)
    fi
}

setUp() {
    case "${1:-}" in
        "") ;;
        --ci) packages+=(clang-format git clang libclang-rt-dev) ;;
        --web) addWebPackages ;;
        *) usage; exit 2 ;;
    esac
    system=$(systemName)
    requireKnownSystem
    missing=()
    needsMesa=false
    lookForPackages
    if [ ${#missing[@]} -gt 0 ] || [ $needsMesa = true ]; then
        root=()
        becomeRoot
        installAll
    fi
    installNpmPackages "$@"
    if [ ${#missing[@]} -gt 0 ] || [ $needsMesa = true ]; then
        echo "setup: done"
    else
        echo "setup: everything is installed"
    fi
}

# tests/scripts.sh takes the functions alone.
if [ "${BASH_SOURCE[0]}" = "$0" ]; then
    setUp "$@"
fi
