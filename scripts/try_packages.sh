#!/usr/bin/env bash
# try_packages.sh FOLDER [TREE...]: installs the .deb packages of FOLDER in bare Debian 12 trees made for it and uses
# them there. Needs mmdebstrap; MMDEBSTRAP_OPTIONS are passed to it. The trees, all unless named:
#   workstation   the runtime package alone: it brings no offline library, and runs
#   image         what scripts/pipelines/Containerfile makes, step by step; the commands of the README run in it
#   development   what a program of one's own needs: examples in C, C++ and Python are built and run
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
packages=$(cd "${1:?usage: try_packages.sh FOLDER [TREE...]}" && pwd)
shift
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
mkdir "$scratch/project"
cp -r "$root"/{README.md,sample_data,runtime/examples,tests/golden,tests/models} "$scratch/project"

# in_tree NAME OPTIONS... <SCRIPT: a bare tree, changed as mmdebstrap's options say; then the script runs in it, in a
# folder with the sample data, the examples, and baked files.
in_tree() {
  local name=$1
  shift
  printf '\n== %s\n' "$name"
  { echo 'cd /tmp/project'; cat; } >"$scratch/$name.sh"
  # shellcheck disable=SC2086  # options are words
  mmdebstrap --quiet --variant=minbase --skip=check/empty ${MMDEBSTRAP_OPTIONS:-} "$@" \
    --customize-hook="copy-in $scratch/project $scratch/$name.sh /tmp" \
    --customize-hook="chroot \"\$1\" sh -eu /tmp/$name.sh" \
    bookworm /dev/null
}

# options_for PACKAGES...: what installs them in a tree, into the array `options`: ours from their files.
options_for() {
  options=(--hook-dir=/usr/share/mmdebstrap/hooks/file-mirror-automount)
  local package file
  for package in "$@"; do
    file=$(compgen -G "$packages/${package}_*.deb") || file=$package
    options+=(--include="$file")
  done
}

try_workstation() {
  options_for forcelayer-runtime
  in_tree workstation "${options[@]}" <<'SCRIPT'
voxrun --version
voxcheck --version
voxrun golden/v2.vox golden/v2.pshell --duration 0.05s --as-fast-as-possible --without-guarantee
if dpkg -l | grep -E "openvdb|openmesh|draco|libtbb|vtk|boost"; then
  echo "FAILED: the runtime package brought an offline library" >&2
  exit 1
fi
SCRIPT
}

# A container without a container program: FROM debian:12-slim is the bare tree, COPY and RUN are as they stand.
try_image() {
  local word rest copied='' hooks=()
  while read -r word rest; do
    case $word in
      FROM) [ "$rest" = docker.io/library/debian:12-slim ] || { echo "FAILED: no tree for '$rest'" >&2; return 1; } ;;
      COPY)
        for file in "$packages"/${rest% *}; do copied+=" '$file'"; done
        hooks+=(--customize-hook="mkdir -p \"\$1${rest##* }\" && cp$copied \"\$1${rest##* }\"")
        ;;
      RUN)
        printf '%s\n' "$rest" >"$scratch/run.${#hooks[@]}.sh"
        hooks+=(--customize-hook="copy-in $scratch/run.${#hooks[@]}.sh /tmp"
          --customize-hook="chroot \"\$1\" sh -euc 'DEBIAN_FRONTEND=noninteractive sh -eu /tmp/run.${#hooks[@]}.sh'")
        ;;
      '' | '#'*) ;;
      *) echo "FAILED: no step '$word' is known" >&2; return 1 ;;
    esac
  done < <(sed -e ':a' -e '/\\$/N; s/ *\\\n */ /; ta' "$root/scripts/pipelines/Containerfile")
  in_tree image "${hooks[@]}" <<'SCRIPT'
if command -v c++ >/dev/null; then echo "FAILED: the image holds a compiler" >&2; exit 1; fi
for command in voxelize pointshell voxinfo voxrun voxcheck voxplan voxview forcelayer; do
  $command --version
  test -e /usr/share/bash-completion/completions/$command
done
voxelize --version | grep -q "reads STEP and IGES"
voxelize models/featuretype.step --voxel-size 1mm -o step.vox
voxinfo verify step.vox
# The README's first commands, as they stand; a window becomes a picture.
sed -n '/^## Your own assembly/,/^## What the answer/s/^    //p' README.md | sed 's/ *# .*//' |
  awk '/^voxview/ { $0 = $0 " --screenshot " ++n ".png" } { print }' >commands.sh
test "$(grep -c "^vox\|^pointshell" commands.sh)" -ge 11
cat commands.sh
sh -eux commands.sh
head -c 4 1.png | grep -q PNG && head -c 4 2.png | grep -q PNG
pointshell verify part.pshell sample_data/part.obj --units mm
voxrun doctor --clock 0.1
SCRIPT
}

try_development() {
  options_for libforcelayer0 libforcelayer-dev python3-forcelayer forcelayer-runtime forcelayer-tools \
    g++ cmake ninja-build pkg-config python3-matplotlib
  in_tree development "${options[@]}" <<'SCRIPT'
# A floor, and a part of 20 mm above it.
cat >floor.obj <<'OBJ'
v 0 0 -10
v 240 0 -10
v 240 200 -10
v 0 200 -10
v 0 0 0
v 240 0 0
v 240 200 0
v 0 200 0
f 1 4 3 2
f 5 6 7 8
f 1 2 6 5
f 2 3 7 6
f 3 4 8 7
f 4 1 5 8
OBJ
cat >part.obj <<'OBJ'
v 20 0 0
v -20 0 0
v 0 20 0
v 0 -20 0
v 0 0 20
v 0 0 -20
f 1 3 5
f 3 2 5
f 2 4 5
f 4 1 5
f 3 1 6
f 2 3 6
f 4 2 6
f 1 4 6
OBJ
voxelize floor.obj --units mm --voxel-size 5mm -o floor.vox
pointshell part.obj --units mm --voxel-size 5mm -o part.pshell

# C by pkg-config, and the device plugin, by the commands of their page.
cd examples
sed -n 's/^    cc/cc/p; s/^A plugin links nothing: `\(.*\)`\.$/\1/p' README.md >commands.sh
test "$(grep -c ^cc commands.sh)" = 2
sh -eux commands.sh
./embed ../floor.vox ../part.pshell ../part.pshell
voxrun ../floor.vox ../part.pshell --device plugin --plugin ./spring_plugin.so --plugin-args depth=0.01 \
  --world-from-device 0.1m,0.1m,0.1m --duration 200ms --stale-limit 50ms

# C++ by CMake.
cat >CMakeLists.txt <<'CMAKE'
cmake_minimum_required(VERSION 3.25)
project(mine CXX)
find_package(forcelayer REQUIRED)
foreach(mine embed pose_receiver)
  add_executable(${mine}_cpp ${mine}.cpp)
  target_link_libraries(${mine}_cpp PRIVATE forcelayer::runtime)
endforeach()
CMAKE
cmake -S . -B build -G Ninja
cmake --build build
build/embed_cpp ../floor.vox ../part.pshell
build/pose_receiver_cpp 47333 1
cd ..

# Python: what the package brings as its example.
voxelize sample_data/bay.json --voxel-size 5mm -o bay.vox
pointshell sample_data/part.obj --units mm --voxel-size 5mm -o part.pshell
voxrun bay.vox part.pshell --motion sample_data/press.csv --as-fast-as-possible --record run.flr
MPLBACKEND=Agg python3 /usr/share/doc/python3-forcelayer/examples/clearance_study.py
python3 -c 'import forcelayer; help(forcelayer.Scene)' | head -n 5
SCRIPT
}

[ $# -gt 0 ] || set -- workstation image development
for tree in "$@"; do "try_$tree"; done
printf '\n== the packages install and run\n'
