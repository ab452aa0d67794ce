#!/usr/bin/env bash
# Builds the Debian packages into build/package/packages, with man pages, and has lintian look at them.
#   scripts/package.sh          builds and checks
#   scripts/package.sh --twice  and builds again from a copy elsewhere: the bytes must be the same
#   scripts/package.sh --install  and installs them in bare Debian 12 trees, where commands and examples run
#                               (scripts/try_packages.sh; needs mmdebstrap)
source "$(dirname "$0")/common.sh"

twice=no install=no
for argument in "$@"; do
  case $argument in
    --twice) twice=yes ;;
    --install) install=yes ;;
    *) echo "usage: scripts/package.sh [--twice] [--install]" >&2; exit 2 ;;
  esac
done
for tool in help2man lintian; do
  command -v $tool >/dev/null || { echo "needs $tool: apt-get install help2man lintian" >&2; exit 2; }
done
SOURCE_DATE_EPOCH=$(git -C "$root" log -1 --format=%ct)
export SOURCE_DATE_EPOCH
commit=$(git -C "$root" rev-parse --short=12 HEAD)

make_packages() {  # SOURCE BUILD
  say "building packages of $1"
  cmake -S "$1" -B "$2" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX=/usr \
    -DFORCELAYER_MAN_PAGES=ON \
    -DFORCELAYER_TESTS=OFF -DFORCELAYER_BENCHMARKS=OFF -DFORCELAYER_PRECOMPILED_HEADERS=OFF \
    -DFORCELAYER_WARNINGS_AS_ERRORS=ON -DFORCELAYER_COMMIT="$commit" >"$2.configure.log"
  cmake --build "$2"
  rm -rf "$2/packages"
  (cd "$2" && umask 022 && cpack -G DEB -B "$2/packages" >"$2.cpack.log")
  rm -rf "$2/packages/_CPack_Packages"
}

built=$root/build/package
make_packages "$root" "$built"
say "lintian"
# No upstream bug tracker to close an ITP bug in.
lintian --fail-on error --suppress-tags initial-upload-closes-no-bugs "$built"/packages/*.deb

if [ "$twice" = yes ]; then
  copy=$(mktemp -d)
  trap 'rm -rf "$copy"' EXIT
  mkdir "$copy/a longer path"
  git -C "$root" archive HEAD | tar -x -C "$copy/a longer path"
  make_packages "$copy/a longer path" "$copy/build"
  for package in "$built"/packages/*.deb; do
    cmp "$package" "$copy/build/packages/$(basename "$package")"
  done
  say "the same bytes from both builds"
fi

if [ "$install" = yes ]; then
  command -v mmdebstrap >/dev/null || { echo "needs mmdebstrap: apt-get install mmdebstrap" >&2; exit 2; }
  "$root/scripts/try_packages.sh" "$built/packages"
fi
