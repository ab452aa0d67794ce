#!/usr/bin/env bash
# try_packages.sh FOLDER: installs the .deb packages of FOLDER in bare Debian 12 trees made for it and uses
# them there: the runtime package alone, then the others. Needs mmdebstrap; MMDEBSTRAP_OPTIONS are passed to it.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
packages=$(cd "${1:?usage: try_packages.sh FOLDER}" && pwd)
golden=$root/tests/golden
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# in_tree NAME PACKAGES -- COMMANDS: a tree with these packages and what they depend on; commands run in it.
in_tree() {
  local name=$1 list=() script
  shift
  while [ "$1" != -- ]; do list+=(--include="$(echo "$packages"/$1_*.deb)"); shift; done
  script=$2
  printf '\n== %s: %s\n' "$name" "${list[*]##*/}"
  # shellcheck disable=SC2086  # options are words
  mmdebstrap --quiet --variant=minbase --skip=check/empty ${MMDEBSTRAP_OPTIONS:-} \
    "${list[@]}" --hook-dir=/usr/share/mmdebstrap/hooks/file-mirror-automount \
    --customize-hook="copy-in $golden /tmp" \
    --customize-hook="chroot \"\$1\" sh -euc '$script'" \
    bookworm /dev/null
}

in_tree workstation forcelayer-runtime -- '
  voxrun --version
  voxcheck --version
  voxrun /tmp/golden/v2.vox /tmp/golden/v2.pshell --duration 0.05s --as-fast-as-possible --without-guarantee
  if dpkg -l | grep -E "openvdb|openmesh|draco|libtbb|vtk|boost"; then
    echo "FAILED: the runtime package brought an offline library" >&2
    exit 1
  fi'
in_tree everything forcelayer-runtime forcelayer-tools forcelayer-viewer libforcelayer-dev -- '
  printf "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n" >/tmp/corner.obj
  voxelize /tmp/corner.obj --units m --voxel-size 20mm -o /tmp/corner.vox
  pointshell /tmp/corner.obj --units m --voxel-size 20mm -o /tmp/corner.pshell
  voxinfo verify /tmp/corner.vox
  voxrun /tmp/corner.vox /tmp/corner.pshell --start 3m,0,0 --duration 0.1s --save-path /tmp/path.csv
  voxcheck /tmp/corner.vox /tmp/corner.pshell /tmp/path.csv
  voxview --version
  test -e /usr/include/forcelayer/run.h'
printf '\n== the packages install and run\n'
