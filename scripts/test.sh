#!/usr/bin/env bash
# Builds and runs the tests. On a bare Debian 12 it first installs what is missing.
#   scripts/test.sh          format check, release and asan with gcc, the runtime-only build
#   scripts/test.sh --full   the same, and clang, the thread sanitizer and the long runs
source "$(dirname "$0")/common.sh"

full=no
case "${1:-}" in
  '') ;;
  --full) full=yes ;;
  *) echo "usage: scripts/test.sh [--full]" >&2; exit 2 ;;
esac

check_format() {
  say "checking the layout of the sources"
  (cd "$root" && git ls-files -z '*.h' '*.cpp' '*.c' | xargs -0 clang-format --dry-run -Werror)
}

run_tests() {  # PRESET [ctest arguments ...]
  local preset=$1
  shift
  say "testing $preset"
  ctest --test-dir "$root/build/$preset" --output-on-failure -j "$(nproc)" "$@"
}

# Builds as on a workstation without the offline libraries, and shows that no source saw one.
check_runtime_only() {
  local without=() package
  for package in OpenVDB OpenMesh draco TBB VTK; do
    without+=("-DCMAKE_DISABLE_FIND_PACKAGE_$package=ON")
  done
  configure runtime-only "${without[@]}"
  build runtime-only
  if ninja -C "$root/build/runtime-only" -t deps | grep -E '/(openvdb|OpenMesh|draco|tbb|oneapi)/'; then
    echo "the runtime-only build read headers of the offline tools" >&2
    return 1
  fi
  run_tests runtime-only
}

install_packages
check_format
configure release
build release
run_tests release
configure asan
build asan
run_tests asan -LE stress  # the stress tests judge motion, and are slow under sanitizers
check_runtime_only

if [ "$full" = yes ]; then
  export FORCELAYER_LONG_TESTS=1
  run_tests release
  configure tsan
  build tsan
  run_tests tsan
  configure debug -DCMAKE_CXX_COMPILER=clang++ -DCMAKE_C_COMPILER=clang
  build debug
  run_tests debug
fi
say "all tests passed"
