#!/usr/bin/env bash
# try_packages.sh FOLDER [TREE...]: installs the .deb packages of FOLDER in bare Debian 12 trees made for it and uses
# them there. Needs mmdebstrap; MMDEBSTRAP_OPTIONS are passed to it. The trees, all unless named:
#   workstation   the runtime package alone: it brings no offline library, and runs
#   image         what scripts/pipelines/Containerfile makes, step by step; the commands of the tutorial run in it
#   development   what a program of one's own needs: examples in C, C++ and Python are built and run
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
packages=$(cd "${1:?usage: try_packages.sh FOLDER [TREE...]}" && pwd)
shift
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
mkdir -p "$scratch"/project/{baked,pictures}
cp -r "$root"/{docs/tutorial.md,sample_data,runtime/examples,tests/models,tests/support/help_examples.sh} "$scratch/project"
cp "$root/docs/voxview.md" "$scratch/project/viewer.md"
cp "$root/docs/python.md" "$scratch/project/python.md"

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
    --customize-hook="chroot \"\$1\" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin sh -eu /tmp/$name.sh" \
    --customize-hook="copy-out /tmp/project/baked /tmp/project/pictures $scratch/project" \
    bookworm /dev/null
  [ -z "${PICTURES:-}" ] || { mkdir -p "$PICTURES/$name" && cp -r "$scratch/project/pictures/." "$PICTURES/$name"; }
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
  test -e /usr/share/man/man1/$command.1.gz
done
voxelize --version | grep -q "reads STEP and IGES"
voxelize models/featuretype.step --voxel-size 1mm -o step.vox
voxinfo verify step.vox
# The tutorial's steps, as they stand; a window becomes a picture.
sed -n '/^## 5[.]/,/^## 7[.]/s/^    //p' tutorial.md | sed 's/ *# .*//' |
  awk '/^voxview/ { $0 = $0 " --screenshot " ++n ".png" } { print }' >commands.sh
test "$(grep -c "^vox\|^pointshell" commands.sh)" -ge 11
cat commands.sh
sh -eux commands.sh
head -c 4 1.png | grep -q PNG && head -c 4 2.png | grep -q PNG
cp 1.png 2.png pictures
mkdir /tmp/examples && cd /tmp/examples
bash /tmp/project/help_examples.sh /tmp/project/sample_data
cp pin/worst.png pin/installed.png pin/report.html /tmp/project/pictures
# A live run, in a picture.
voxrun bay.vox part.pshell --motion press.csv --udp 7000 --quiet &
voxview bay.json bay.vox part.pshell --listen 7000 --screenshot /tmp/project/pictures/live.png
wait
# Only these files.
voxrun bay.vox part.pshell --duration 0.1s --quiet --expect "$(sha256sum bay.vox | cut -c 1-64)" \
  --expect "$(sha256sum part.pshell | cut -c 1-64)"
voxrun bay.vox part.pshell --duration 0.1s --quiet --expect "$(sha256sum bay.json | cut -c 1-64)" 2>said.txt && exit 1
cat said.txt
voxelize bay.json --voxel-size 5mm --kind lean -o lean.vox --quiet
cp bay.vox lean.vox part.pshell rest.vox pin.pshell opened.vox cover.pshell run.csv run.flr path.csv /tmp/project/baked
SCRIPT
}

# The files that the image has baked.
need_baked() { [ -e "$scratch/project/baked/bay.vox" ] || try_image; }

try_workstation() {
  need_baked
  options_for forcelayer-runtime
  in_tree workstation "${options[@]}" <<'SCRIPT'
if dpkg-query --show --showformat '${Package}\n' | grep -E "openvdb|openmesh|draco|libtbb|vtk|boost|ompl"; then
  echo "FAILED: the runtime package brought an offline library" >&2
  exit 1
fi
mkdir /tmp/work && cd /tmp/work && cp /tmp/project/baked/* .
for command in voxrun voxcheck forcelayer; do $command --version; done
bash /tmp/project/help_examples.sh /tmp/project/sample_data voxrun
voxcheck bay.vox part.pshell run.csv --clearance 10mm
# The package that is missing is named.
cp -r /tmp/project/sample_data .
voxcheck bay.vox part.pshell run.csv --exact bay.json --part part.obj --units mm 2>said.txt && exit 1
grep forcelayer-tools said.txt
forcelayer study "sample_data/gearbox.glb#Pin" --voxel-size 1mm --pull 0,0,60mm -o pin 2>said.txt && exit 1
grep forcelayer-tools said.txt
# Removed, it leaves nothing.
dpkg --remove forcelayer-runtime
if find /usr /etc -name '*forcelayer*' -o -name 'voxrun*' -o -name 'voxcheck*' | grep .; then exit 1; fi
SCRIPT
}

try_viewer() {
  need_baked
  options_for forcelayer-viewer xvfb xauth
  in_tree viewer "${options[@]}" <<'SCRIPT'
voxview --version
mkdir /tmp/work && cd /tmp/work && cp -r /tmp/project/baked/* /tmp/project/sample_data/* .
cp run.csv trace.csv && cp lean.vox before.vox && cp bay.vox after.vox && cp rest.vox gearbox.vox
# The commands of the page, but the one that follows a run; a window becomes a picture.
sed -n '/^    voxview/{ s/ *#.*//; p }' /tmp/project/viewer.md | grep -v -e --listen |
  awk '!/--screenshot|--turntable/ { $0 = $0 " --screenshot page_" ++n ".png" } { print $0 " --size 480x300" }' >commands.sh
test "$(grep -c '^ *voxview' commands.sh)" = 6
sh -eux commands.sh
bash /tmp/project/help_examples.sh /tmp/project/sample_data voxview
cp *.png /tmp/project/pictures
# The package that is missing is named.
voxview /tmp/project/models/featuretype.step --screenshot step.png 2>said.txt && exit 1
grep forcelayer-tools said.txt
SCRIPT
}

try_python() {
  need_baked
  options_for python3-forcelayer python3-matplotlib
  in_tree python "${options[@]}" <<'SCRIPT'
mkdir /tmp/work && cd /tmp/work && cp /tmp/project/baked/* .
export MPLBACKEND=Agg
sed -n 's/^    //p' /tmp/project/python.md | python3
grep -q 'proven clearance' clearance.svg
python3 /usr/share/doc/python3-forcelayer/examples/clearance_study.py
cp clearance.svg clearance.png plane.png /tmp/project/pictures
# The doctest of every docstring that has no file beside these.
python3 -c 'import doctest, forcelayer, inspect
for name in forcelayer.__all__:
    thing = getattr(forcelayer, name)
    for text in [thing, *(m for n, m in vars(thing).items() if n[0] != "_")] if isinstance(thing, type) else [thing]:
        doctest.run_docstring_examples(inspect.getdoc(text) or "", {"forcelayer": forcelayer}, name=name)' >doctests.txt
test ! -s doctests.txt || { cat doctests.txt >&2; exit 1; }
python3 -c 'import forcelayer; help(forcelayer.Scene)' | sed -n 1,5p
SCRIPT
}

try_development() {
  options_for libforcelayer0 libforcelayer-dev forcelayer-runtime forcelayer-tools g++ cmake ninja-build pkg-config
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

# C by pkg-config, and the device plugin, by the command of its page.
cd examples
echo 'cc embed.c $(pkg-config --cflags --libs forcelayer) -o embed' >commands.sh
sed -n 's/.*`\(cc -shared .*\)`\.$/\1/p' README.md >>commands.sh
test "$(grep -c ^cc commands.sh)" = 2
sh -eux commands.sh
./embed ../floor.vox ../part.pshell ../part.pshell
voxrun ../floor.vox ../part.pshell --device plugin:library=./spring_plugin.so,args=depth=0.01 \
  --world-from-device 0.1m,0.1m,0.1m --duration 200ms --set stale_s=0.05

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
SCRIPT
}

[ $# -gt 0 ] || set -- image workstation viewer python development
for tree in "$@"; do "try_$tree"; done
printf '\n== the packages install and run\n'
