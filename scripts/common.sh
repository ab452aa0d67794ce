# Shared by demo.sh and test.sh: sourced, not run. Needs bash.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

# A step that begins, with the minutes and seconds since the script began.
say() { printf '\n== %d:%02d %s\n' $((SECONDS / 60)) $((SECONDS % 60)) "$*"; }

# install_packages GROUP ...: installs those packages of these groups of packages.txt that are missing, with sudo where we
# are not root.
install_packages() {
  local group wanted=() listed missing=() package sudo=()
  for group in "$@"; do
    mapfile -t listed < <(sed -n "/^\[$group\]$/,/^\[/{/^[a-z]/p}" "$root/scripts/packages.txt")
    [ ${#listed[@]} -gt 0 ] || { echo "packages.txt has no group $group" >&2; return 1; }
    wanted+=("${listed[@]}")
  done
  for package in "${wanted[@]}"; do
    [ "$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null)" = installed ] ||
      missing+=("$package")
  done
  [ ${#missing[@]} -gt 0 ] || return 0
  say "installing: ${missing[*]}"
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || {
      echo "missing packages and no sudo; as root: apt-get install ${missing[*]}" >&2
      return 1
    }
    sudo=(sudo)
  fi
  "${sudo[@]}" apt-get update -q
  "${sudo[@]}" env DEBIAN_FRONTEND=noninteractive \
    apt-get install -qy --no-install-recommends "${missing[@]}"
}

# configure PRESET [cmake arguments ...]: sets up build/PRESET.
configure() {
  local preset=$1
  shift
  say "configuring $preset"
  (cd "$root" && cmake --preset "$preset" "$@" >"$root/build/$preset.configure.log" 2>&1) || {
    cat "$root/build/$preset.configure.log" >&2
    return 1
  }
}

# build PRESET [targets ...]: builds everything, or only these, in build/PRESET.
build() {
  local preset=$1
  shift
  say "building $preset"
  cmake --build "$root/build/$preset" ${1:+--target "$@"}
}

mkdir -p "$root/build"
