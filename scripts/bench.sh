#!/usr/bin/env bash
# Builds the benchmarks, runs them, and says which figures differ by more than noise from the committed ones of the
# same machine, and which figures of the README lie outside their stated intervals. The pages in tests/bench say what each
# measures.
#   scripts/bench.sh                   the parts that the README's figures come from, in the short form: under ten
#                                      minutes, without building; results in build/bench/short
#   scripts/bench.sh PART... | all     these, or all
#   scripts/bench.sh --long [PART...]  the long form, of all parts unless named: hours; results in build/bench/long, and
#                                      from there in tests/bench/results/<machine> and in the pages
#   scripts/bench.sh --out FOLDER ...  results in FOLDER alone
# Parts: bake error growth plan tree shell cover query force wrench clearance motion trajectory stability skip path
# verdicts python progress paper gaps assembly puzzles, and by name only: loop (the long form takes half an hour), streams (bakes up
# to 100 million triangles), cores (how speed grows with threads, on a machine that has them), and targets (what the speed of bake and query must be, beside what it is).
source "$(dirname "$0")/common.sh"

all_parts=(bake error growth plan tree shell cover query force wrench clearance motion trajectory stability skip path verdicts python progress paper gaps assembly puzzles)
readme_parts=(bake query wrench stability gaps)  # what the figures of the README and of runtime/limits.md come from
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
    all) parts+=("${all_parts[@]}") ;;
    *)
      [[ " ${all_parts[*]} loop streams cores targets " == *" $1 "* ]] || { usage >&2; exit 2; }
      parts+=("$1")
      ;;
  esac
  shift
done
# either SHORT LONG: the words for this form.
either() { if [ $long = yes ]; then echo "$2"; else echo "$1"; fi; }
# shellcheck disable=SC2207  # parts are words
[ ${#parts[@]} -gt 0 ] || parts=($(either "${readme_parts[*]}" "${all_parts[*]}"))

# Names the targets that a part builds.
declare -A targets=(
  [bake]="bake_bench voxelize" [error]=geometry_bench [growth]=voxelize [streams]=voxelize [plan]=voxelize [tree]="voxelize voxinfo"
  [shell]="shell_bench pointshell" [cover]=cover_bench [query]=query_bench [force]=force_bench [wrench]=wrench_bench [clearance]=clearance_bench
  [motion]=motion_bench [trajectory]=trajectory_bench [stability]=stability_bench
  [skip]="skip_bench voxelize pointshell" [path]="path_bench voxelize pointshell voxrun voxcheck" [verdicts]="verdict_bench voxelize pointshell voxrun voxcheck voxcheck-exact forcelayer" [python]="python_bench forcelayer_python voxelize pointshell voxrun" [progress]="voxelize pointshell" [paper]="voxelize pointshell voxrun" [loop]="voxelize pointshell voxrun" [gaps]=stress_tests [assembly]=assembly_bench [puzzles]="puzzle_bench voxelize pointshell"
  [cores]="voxelize pointshell voxcheck voxrun query_bench" [targets]="bake_bench voxelize query_bench")

# The long form also measures what a processor without AVX-512 would run.
held_to_avx2() {
  [ $long = yes ] && grep -qw avx512f /proc/cpuinfo
}

part_bake() {
  local model
  for model in bunny dragon counter engine; do
    # shellcheck disable=SC2046
    "$bin/bake_bench" --case $model $(either "--voxels 512 --repeat 1" "--repeat 3 --voxels 512 1024") \
      $([ $long$model != yescounter ] || echo 2048) --json "$out/bake_$model.json"
  done
  "$bin/bake_bench" --wide --repeat $(either 3 9) $(either "--voxels 512" "") --json "$out/bake_wide.json"
  [ $long = yes ] || "$bin/bake_bench" --wide --case engine --repeat 1 --voxels 1024 --json "$out/bake_wide_engine.json"
  "$bench/bake_full.py" $(either "--short --repeat 1" "") --json "$out/bake_full.json"
  [ $long = no ] || "$bin/bake_bench" --wide --repeat 15 --voxels 128 --json "$out/bake_wide_coarse.json"
  if held_to_avx2; then
    "$bin/bake_bench" --wide --repeat 9 --vectors AVX2 --json "$out/bake_wide_avx2.json"
    "$bin/bake_bench" --wide --repeat 15 --voxels 128 --vectors AVX2 --json "$out/bake_wide_coarse_avx2.json"
  fi
}
part_error() { "$bench/bake_error.py" $(either --short "") --json "$out/bake_error.json"; }
part_growth() { "$bench/bake_growth.py" $(either --short "") --json "$out/bake_growth.json"; }
part_plan() { "$bench/plan_bench.py" --repeat "$(either 1 3)" --json "$out/bake_plan.json"; }
part_streams() { "$bench/bake_streams.py" $(either --short "") --json "$out/bake_streams.json"; }
part_cores() { "$bench/cores.py" $(either "--short --repeat 1" "") --json "$out/cores.json"; }
part_tree() { "$bench/tree_memory.py" --json "$out/tree_memory.json"; }
part_shell() {
  "$bin/shell_bench" $(either "--voxels 128" "--voxels 128 256") --json "$out/shell.json"
  [ $long = no ] || "$bin/shell_bench" --mesh dragon --voxels 985 --json "$out/shell_dragon_985.json"
}
part_cover() { "$bin/cover_bench" $(either "--orientations 1 --radius 0.866" "") --json "$out/cover.json"; }
part_query() {
  "$bin/query_bench" $(either "--largest 100000 --seconds 0.05 --our-seconds 0.3" "--largest 1000000 --seconds 2 --our-seconds 10") --json "$out/query.json"
  [ $long = yes ] ||  # the two that the README shows
    "$bin/query_bench" --motion wall --motion everything --from 1000000 --seconds 0.05 --our-seconds 1 --json "$out/query_million.json"
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
  # The short form's contacts are the first of the long form's.
  "$bin/wrench_bench" --s 0.5 --pair-cases $(either 2 100) --json "$out/wrench_s0.5.json"
  [ $long = no ] || "$bin/wrench_bench" --s 1 --s 0.25 --pair-cases 10 --json "$out/wrench_sizes.json"
}
part_clearance() { "$bin/clearance_bench" $(either "--poses 5000" "") --json "$out/clearance.json"; }
part_motion() { "$bin/motion_bench" --json "$out/motion.json"; }
part_trajectory() { "$bin/trajectory_bench" $(either "--seeds 1 --nominal" "") --json "$out/trajectory.json"; }
part_stability() {
  local table
  for table in $(either "cases:1 rest:150 table2:300000 device map loops:above:1 seats:21 step:20000" "cases rest table2 hands field device map grips loops seats step"); do
    "$bin/stability_bench" ${table//:/ } --json "$out/stability_${table%%:*}.json"
  done
}
part_skip() { "$bench/skipped.py" $(either --short "") --json "$out/skipped.json"; }
part_path() {
  "$bin/path_bench" $(either "--moments 3000" "") --json "$out/path.json"
  "$bench/path_time.py" $(either --short "") --json "$out/path_time.json"
}
part_verdicts() { "$bench/verdicts.py" $(either --short "") --json "$out/verdicts.json"; }
part_python() { "$bench/python_bench.py" $(either --short "") --json "$out/python_bench.json"; }
part_progress() { "$bench/progress.py" $(either --short "") --json "$out/progress.json"; }
part_paper() { "$bench/paper_table.py" $(either --short "") --json "$out/paper_table.json"; }
# By half a voxel of room in the short form, by a tenth in the long one.
part_gaps() {
  env FORCELAYER_NARROW_GAPS="$out/narrow_gaps.csv" $(either "" FORCELAYER_LONG_TESTS=1) \
    "$bin/stress_tests" --gtest_filter='NarrowGaps.Are*' >"$out/narrow_gaps.log" || { cat "$out/narrow_gaps.log"; return 1; }
}
part_assembly() {
  local task
  for task in peg nut scans; do
    "$bin/assembly_bench" $task $(either --short "") --json "$out/assembly_$task.json"
  done
}
part_puzzles() { "$bin/puzzle_bench" $(either "--seeds 1 --time 2" "--seeds 10 --time 10") --poses 20000 --json "$out/puzzles.json"; }
part_targets() { "$bench/speed_targets.py" $(either --short ""); }  # prints all that it has to say
part_loop() {
  "$bench/bench_loop.py" --minutes "$(either 1 30)" --out "$root/build/loop_bench" --json "$out/loop.json"
}

install_packages commands tests benchmarks
configure release -DFORCELAYER_BENCHMARKS=ON -DFORCELAYER_BENCHMARK_FLAGS=
# shellcheck disable=SC2046
build release $(for part in "${parts[@]}"; do echo ${targets[$part]}; done | tr ' ' '\n' | sort -u)
committed=$("$bench/bench_csv.py" folder)
commit=$([ $long = no ] || [ -n "$out" ] || echo yes)
out=${out:-$root/build/bench/$(either short long)}
mkdir -p "$out"
rm -f "$out"/*.json "$out"/*.csv "$out"/*.svg
SECONDS=0
for part in "${parts[@]}"; do
  say "$part"
  begin=$SECONDS
  "part_$part"
  echo "$part: $((SECONDS - begin)) s"
done
compgen -G "$out/*.json" >/dev/null || exit 0  # targets alone
"$bench/bench_csv.py" write "$out" "$out"
"$bench/plots.py" "$out"
say "measured in $((SECONDS / 60)) min $((SECONDS % 60)) s; results and plots stand in $out"
"$bench/bench_csv.py" compare "$committed" "$out"
say "the README's figures"
"$bench/readme_figures.py" "$out"
if [ "$commit" ]; then
  mkdir -p "$committed"
  find "$out" \( -name '*.csv' -o -name '*.svg' \) -exec cp -t "$committed" {} +
  "$bench/tables.py"
fi
