#!/usr/bin/env bash
# Run time against error, all of it: builds the benchmarks, runs them, writes JSON and CSV, draws the plots.
#   scripts/bench.sh [PART...]               the short form: under ten minutes, in results/<cpu>/short;
#                                            ends by saying which figures moved by more than noise
#   scripts/bench.sh --long [PART...]        the long form: over half an hour, in results/<cpu>, where the
#                                            README's figures come from (readme_figures.py --write)
#   scripts/bench.sh --long loop             half an hour of the loop on a busy machine; only by name
#   scripts/bench.sh [--long] --out FOLDER   elsewhere
# Parts: bake error growth plan tree shell cover query force wrench motion trajectory stability skip paper
# (all of them by default), loop, and cache. What each measures and by what it is judged:
# tests/bench/METHOD.md. Results stand in tests/bench/results/.
source "$(dirname "$0")/common.sh"

all_parts=(bake error growth plan tree shell cover query force wrench motion trajectory stability skip paper)
bin=$root/build/release/bin
bench=$root/tests/bench
long=no
out=
parts=()
usage() { sed -n '2,/^source/p' "$0" | sed '$d; s/^# \{0,1\}//'; }
while [ $# -gt 0 ]; do
  case $1 in
    --long) long=yes ;;
    --out) out=${2:?--out needs a folder}; shift ;;
    -h | --help) usage; exit 0 ;;
    loop | cache) parts+=("$1") ;;
    *)
      [[ " ${all_parts[*]} " == *" $1 "* ]] || { usage >&2; exit 2; }
      parts+=("$1")
      ;;
  esac
  shift
done
[ ${#parts[@]} -gt 0 ] || parts=("${all_parts[@]}")

# either SHORT LONG: the words for this form.
either() { if [ $long = yes ]; then echo "$2"; else echo "$1"; fi; }
# without TOOL WHAT PACKAGE: says what is left out; true where the tool is missing.
without() {
  [ ! -x "$1" ] && ! command -v "$1" >/dev/null || return 1
  echo "$2 left out: no $(basename "$1") ($3)"
}

# The long form also measures what a processor without AVX-512 would run.
held_to_avx2() {
  [ $long = yes ] && grep -qw avx512f /proc/cpuinfo
}

part_bake() {
  ! without vdb_tool "beside vdb_tool" "install libopenvdb-tools" || return 0
  local model
  for model in bunny dragon counter engine; do
    # shellcheck disable=SC2046
    "$bin/bake_bench" --case $model $(either "--voxels 512 --repeat 1" "--repeat 3 --voxels 512 1024") \
      $([ $long$model != yescounter ] || echo 2048) --json "$out/bake_$model.json"
  done
  python3 "$bench/bake_table.py" "$out"/bake_{bunny,dragon,counter,engine}.json
  "$bin/bake_bench" --wide --repeat $(either 3 9) $(either "--voxels 512" "") --json "$out/bake_wide.json"
  python3 "$bench/bake_table.py" "$out/bake_wide.json"
  [ $long = no ] || "$bin/bake_bench" --wide --repeat 15 --voxels 128 --json "$out/bake_wide_coarse.json"
  if held_to_avx2; then
    "$bin/bake_bench" --wide --repeat 9 --vectors AVX2 --json "$out/bake_wide_avx2.json"
    "$bin/bake_bench" --wide --repeat 15 --voxels 128 --vectors AVX2 --json "$out/bake_wide_coarse_avx2.json"
  fi
}
part_error() {
  ! without "$bin/geometry_bench" "geometry" "install libvtk9-dev" || return 0
  "$bench/bake_error.py" $(either --short "") --json "$out/bake_error.json" --plot "$out/bake_error.svg"
}
part_growth() {
  "$bench/bake_growth.py" $(either "--short" "") --json "$out/bake_growth.json" --plot "$out/bake_growth.svg"
}
part_plan() { "$bench/plan_bench.py" --repeat "$(either 1 3)" --json "$out/bake_plan.json"; }
part_tree() { "$bench/tree_memory.py" --json "$out/tree_memory.json" --plot "$out/tree_memory.svg"; }
part_shell() {
  "$bin/shell_bench" $(either "--voxels 128" "--voxels 128 256") --json "$out/shell.json"
  [ $long = no ] || "$bin/shell_bench" --mesh dragon --voxels 985 --json "$out/shell_dragon_985.json"
}
part_cover() {
  "$bin/cover_bench" $(either "--orientations 1 --radius 0.866" "") --json "$out/cover.json"
  "$bench/plot_cover.py" "$out/cover.json"
}
part_query() {
  "$bin/query_bench" $(either "--largest 100000 --seconds 0.05 --our-seconds 0.3" "--our-seconds 300") --json "$out/query.json"
  /usr/bin/python3 "$root/scripts/plot_query.py" "$out/query.json" "$out/query.svg"
  "$bench/frame_growth.py" "$out/query.json"
  [ $long = yes ] || return 0
  "$bin/query_bench" --motion wall --from 1000000 --largest 10000000 --our-seconds 60 --json "$out/query_large.json"
  "$bin/query_bench" --motion tumbling --from 10000 --no-peers --seconds 5 --json "$out/query_worst.json"
}
part_force() {
  if [ $long = no ]; then
    # Two of the contacts, drawn as in the long form.
    "$bin/force_bench" --s 0.5 --contact "cylinder side on sphere" --contact "cylinder in wedge 90" \
      --json "$out/force_s0.5.json"
  else
    local s
    for s in 1 0.5 0.25 0.125; do "$bin/force_bench" --s $s --json "$out/force_s$s.json"; done
    "$bin/force_bench" --s 0.5 --cover 0.43305 --json "$out/force_s0.5_dense.json"
  fi
  "$bin/force_bench" --cost --json "$out/force_cost.json"
  ! held_to_avx2 || "$bin/force_bench" --cost --vectors AVX2 --json "$out/force_cost_avx2.json"
}
part_wrench() {
  ! without "$bin/wrench_bench" "beside mesh colliders" "install libbullet-dev" || return 0
  "$bin/wrench_bench" --s $(either "" 1) 0.5 --orientations 1 --pair-cases 2 --json "$out/wrench.json"
  "$bench/plot_wrench.py" "$out/wrench.json"
}
part_motion() {
  "$bin/motion_bench" "$out/motion.json"
  "$root/scripts/plot_stability.py" "$out"
}
part_trajectory() {
  "$bin/trajectory_bench" $(either "--seeds 1 --nominal" "") --json "$out/trajectory.json"
  "$bench/plot_trajectory.py" "$out/trajectory.json"
}
part_stability() {
  local table
  for table in $(either "rest:150 table2:300000 device map step:20000" "cases rest table2 device map step"); do
    "$bin/stability_bench" ${table/:/ } --json "$out/stability_${table%:*}.json"
  done
  "$root/scripts/plot_stability.py" "$out"
}
part_skip() { "$bench/skipped.py" $(either --short "") --json "$out/skipped.json"; }
part_paper() {
  local collisions=$out/stability_table2.json
  [ -f "$collisions" ] || collisions=$committed/stability_table2.json
  "$bench/paper_table.py" $(either --short "") --collisions "$collisions" --json "$out/paper_table.json"
}
part_loop() {
  "$root/scripts/bench_loop.py" --minutes "$(either 1 30)" --bin "$bin" --out "$root/build/loop_bench"
  cp "$root/build/loop_bench/loop.json" "$out/loop.json"
}
part_cache() { "$root/scripts/bench_cache.py" "$bin"; }

install_packages
configure release
build release voxelize pointshell voxinfo voxrun benchmarks
committed=$("$bench/bench_figures.py" folder)
out=${out:-$(either "$committed/short" "$committed")}
mkdir -p "$out"
SECONDS=0
for part in "${parts[@]}"; do
  say "$part"
  begin=$SECONDS
  "part_$part"
  echo "$part: $((SECONDS - begin)) s"
done
"$bench/bench_figures.py" csv "$out"
say "measured in $((SECONDS / 60)) min $((SECONDS % 60)) s; results and plots stand in $out"
[ "$out" = "$committed" ] || "$bench/bench_figures.py" compare "$committed" "$out"
