#!/usr/bin/env bash
# The Debian packages in a Debian that has nothing else: clean_root.sh BUILD [FOLDER]
#
# Packs the build, makes a minimal system in FOLDER with debootstrap, installs the packages there with
# what they ask for, fits a body with the program and compiles README's program against the library.
# Needs root, debootstrap and a Debian archive; some minutes. Not part of `make test`.
set -euo pipefail
build=$(cd "$1" && pwd)
here=$(cd "$(dirname "$0")" && pwd)
root=${2:-$(mktemp -d)}
command -v debootstrap > /dev/null || { echo "clean_root: needs debootstrap" >&2; exit 77; }

packed=$(mktemp -d)
(cd "$build" && cpack -B "$packed" > "$packed/log") || { cat "$packed/log" >&2; exit 1; }
ls "$packed"/*.deb

mirror=$({ grep -rhoE '^(deb |URIs: ).*' /etc/apt/sources.list /etc/apt/sources.list.d 2> /dev/null || true; } |
  grep -oE '[a-z]+://[^ ]+/debian/?$' | head -1)
[ -d "$root/etc" ] || debootstrap --variant=minbase bookworm "$root" "$mirror" > /dev/null
mkdir -p "$root/packed" "$root/packages" "$root/user"
cp "$packed"/*.deb "$root/packed/"
cp "${ECORCHE_PACKAGES:-$build/packages}"/*.whl "$root/packages/"
cp /etc/apt/sources.list "$root/etc/apt/" 2> /dev/null || true
cp -r /etc/apt/sources.list.d /etc/apt/apt.conf.d "$root/etc/apt/" 2> /dev/null || true
mount --bind /proc "$root/proc"
trap 'umount "$root/proc"' EXIT

inside() { chroot "$root" env -i PATH=/usr/bin:/bin:/usr/sbin:/sbin HOME=/root \
  ECORCHE_PACKAGES=/packages DEBIAN_FRONTEND=noninteractive bash -euc "$1"; }
inside 'apt-get update -qq && apt-get install -y -qq --no-install-recommends /packed/*.deb > /dev/null'
inside 'ecorche --version && ecorche list | head -3'
inside 'cd /user && ecorche body new --sex female --height 1.68 -q -o body.glb && ecorche fit body.glb -q -o fit.glb && ls -l *.glb'
sed -n '/^```cpp$/,/^```$/{/^```/d;p}' "$here/../../README.md" > "$root/user/user.cpp"
cp "$here/../../data/motions/walk.bvh" "$root/user/"
cat > "$root/user/CMakeLists.txt" << 'CMAKE'
cmake_minimum_required(VERSION 3.25)
project(user LANGUAGES CXX)
find_package(ecorche 0.2 REQUIRED)
add_executable(user user.cpp)
target_link_libraries(user PRIVATE ecorche::ecorche)
CMAKE
inside 'apt-get install -y -qq --no-install-recommends g++ make cmake > /dev/null'
inside 'cd /user && cmake -S . -B build > /dev/null && cmake --build build && build/user && ls -l anna.*'
echo "clean_root: all is well"
