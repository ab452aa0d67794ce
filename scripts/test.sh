#!/usr/bin/env bash
# Builds and runs the tests. On a bare Debian 12 it first installs what is missing.
#   scripts/test.sh            layout of the sources, a release build and its tests, and under address and
#                              undefined-behavior sanitizers what reads baked files
#   CI=true scripts/test.sh    the same, the stress tests, faults planted into the guard, the benchmarks compiled, the
#                              runtime alone, and by clang under those sanitizers the unit tests of what reads files of
#                              others or holds a motor; fails where a package is missing
#   scripts/test.sh --full     the same, all commands and tests under those sanitizers, the thread sanitizer, the
#                              virtual machine and the long runs
source "$(dirname "$0")/common.sh"

more=no full=no
[ "${CI:-}" != true ] || more=yes
case "${1:-}" in
  '') ;;
  --full) more=yes full=yes ;;
  *) echo "usage: scripts/test.sh [--full]" >&2; exit 2 ;;
esac
reports=()

check_layout() {
  say "checking the layout of the sources"
  (cd "$root" && git ls-files -z '*.h' '*.cpp' '*.c' | xargs -0 clang-format --dry-run -Werror)
}

run_tests() {  # PRESET [ctest arguments ...]
  local preset=$1 report=$root/build/$1/tests_${#reports[@]}.xml
  shift
  say "testing $preset"
  reports+=("$report")
  # A test waits half of its time: for a clock, a signal, a process.
  ctest --test-dir "$root/build/$preset" --output-on-failure -j $(($(nproc) + 1)) --output-junit "$report" \
    --test-output-size-passed 65536 --test-output-size-failed 1048576 "$@"
}

# The tests that are run under sanitizers first: PRESET.
test_safety() {
  build "$1" safety_tests
  run_tests "$1" -L safety
}

# The release build and the runtime alone compile the same sources the same way: what the first one compiled is kept in
# the build folder for the second one.
export CCACHE_DIR=$root/build/ccache CCACHE_BASEDIR=$root CCACHE_NOHASHDIR=true CCACHE_DEPEND=true CCACHE_MAXSIZE=2G
export CCACHE_SLOPPINESS=pch_defines,time_macros
export CCACHE_INODECACHE=true  # a precompiled header is hashed once, not for each source
kept=(-DCMAKE_C_COMPILER_LAUNCHER=ccache -DCMAKE_CXX_COMPILER_LAUNCHER=ccache)

# Builds as on a workstation without the offline libraries, and shows that no source saw one. The code is the same as in
# the release build, whose tests of it have run: here those commands are tested that miss the tools, or are installed.
check_runtime_only() {
  local without=("${kept[@]}") package
  for package in OpenVDB OpenMesh draco TBB VTK OpenCASCADE; do
    without+=("-DCMAKE_DISABLE_FIND_PACKAGE_$package=ON")
  done
  configure runtime-only "${without[@]}" -DFORCELAYER_TESTS=OFF
  build runtime-only
  if ninja -C "$root/build/runtime-only" -t deps | grep -E '/(openvdb|OpenMesh|draco|tbb|oneapi|opencascade)/'; then
    echo "the runtime-only build read headers of the offline tools" >&2
    return 1
  fi
  configure runtime-only "${without[@]}" -DFORCELAYER_TESTS=ON
  build runtime-only make_runtime_files baked_verdicts fault_plugin fault_shim
  local same='pages|bench_tables|dependency_rule|fault_table|sample_data|voxrun_plugin|voxrun_faults|terminal|valgrind_step'
  run_tests runtime-only -R '^cli[.]' -E "^cli[.]($same)$"
}

# Plants faults into the guard, each for itself: the tests of the release build must notice it.
plant_faults() {
  say "planting faults into the guard"
  "$root/tests/fuzz/plant_faults.py" --only guard
}

# Says what was not built or tested, and fails in CI where the scripts could have installed what was missing.
list_skipped() {
  local strict=()
  [ "${CI:-}" != true ] || strict=(--strict)
  say "skipped tests"
  grep -hs 'left out' "$root"/build/{release,asan,asan-clang}.configure.log && [ "${CI:-}" = true ] && return 1
  python3 "$root/tests/support/list_skipped.py" "${strict[@]}" "${reports[@]}"
}

if [ "$full" = yes ]; then
  echo "This takes days: the long runs simulate 24 hours. FORCELAYER_LONG_HOURS=1 makes them one."
elif [ "$more" = yes ]; then
  echo "This should take about 70 minutes on two cores where nothing is compiled yet (estimated from processor time)."
else
  echo "This takes about 15 minutes on two cores where nothing is compiled yet."
fi

install_packages commands tests
[ "$more" = no ] || install_packages ci
check_layout
if [ "$more" = no ]; then
  configure release -DFORCELAYER_BENCHMARKS=OFF -DFORCELAYER_SLOW_TESTS=OFF
  build release
  run_tests release
  configure asan -DFORCELAYER_STEP=OFF  # none of these tests reads STEP
  test_safety asan
else
  configure release "${kept[@]}" -DFORCELAYER_BENCHMARKS=ON -DFORCELAYER_BENCHMARK_FLAGS=-O0 -DFORCELAYER_SLOW_TESTS=ON
  build release
  run_tests release -LE vm
  plant_faults
  if [ "$full" = no ]; then
    configure asan-clang -DFORCELAYER_STEP=ON -DFORCELAYER_SLOW_TESTS=OFF
    test_safety asan-clang
  else
    configure asan-clang -DFORCELAYER_STEP=ON
    build asan-clang
    run_tests asan-clang -LE 'stress|vm'  # the stress tests judge motion
  fi
  check_runtime_only
fi

if [ "$full" = yes ]; then
  export FORCELAYER_LONG_TESTS=1
  run_tests release
  configure tsan
  build tsan
  run_tests tsan
  configure clang
  build clang
  run_tests clang
fi
list_skipped
say "all tests passed"
