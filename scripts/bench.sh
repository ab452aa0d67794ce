#!/usr/bin/env bash
# Builds the benchmarks, runs them, and prints which figures differ by more than noise from the committed ones of the
# same machine, and which figures of the README lie outside their stated intervals. tests/bench/README.md explains them.
#   scripts/bench.sh                   the parts that the README's figures come from, in the short form: under ten
#                                      minutes, without building; results in build/bench/short
#   scripts/bench.sh PART... | all     these, or all
#   scripts/bench.sh --long [PART...]  the long form, of all parts unless named: hours; results in build/bench/long, and
#                                      from there in tests/bench/results/<machine>
#   scripts/bench.sh --out FOLDER ...  results in FOLDER alone
# Parts: bake shell query wrench stability assembly clearance gaps puzzles, and by name only: loop (the long form takes
# half an hour), cores (speed by number of threads, on a machine with many) and disassembly (the long form takes hours).
source "$(dirname "$0")/common.sh"

all_parts=(bake shell query wrench stability assembly clearance gaps puzzles)
readme_parts=(bake query wrench stability gaps)  # what the figures of the README and of docs/limits.md come from
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
      [[ " ${all_parts[*]} loop cores disassembly " == *" $1 "* ]] || { usage >&2; exit 2; }
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
  [bake]="bake_bench voxelize" [shell]="shell_bench pointshell" [query]=query_bench [wrench]=wrench_bench
  [stability]=stability_bench [assembly]=assembly_bench [gaps]=stress_tests
  [clearance]="clearance_bench voxelize pointshell voxrun voxcheck" [puzzles]="puzzle_bench voxelize pointshell"
  [loop]="voxelize pointshell voxrun" [cores]="voxelize pointshell voxcheck voxrun query_bench"
  [disassembly]="forcelayer forcelayer-disassemble")

part_bake() {
  # shellcheck disable=SC2046
  "$bin/bake_bench" $(either "--repeat 3 --voxels 512" "--repeat 9 --voxels 128 512 1024") --json "$out/bake_kinds.json"
  [ $long = yes ] || "$bin/bake_bench" --case engine --repeat 1 --voxels 1024 --json "$out/bake_kinds_engine.json"
  "$bench/bake_full.py" $(either "--short --repeat 1" "") --json "$out/bake_full.json"
}
part_shell() {
  "$bin/shell_bench" $(either "--voxels 128" "--voxels 128 256") --json "$out/shell.json"
  [ $long = no ] || "$bin/shell_bench" --mesh dragon --voxels 985 --json "$out/shell_dragon_985.json"
}
part_query() {
  "$bin/query_bench" $(either "--largest 100000 --seconds 0.05 --our-seconds 0.3" "--largest 1000000 --seconds 2 --our-seconds 10") --json "$out/query.json"
  [ $long = yes ] ||  # the two that the README shows
    "$bin/query_bench" --motion wall --motion everything --from 1000000 --seconds 0.05 --our-seconds 1 --json "$out/query_million.json"
}
part_wrench() {
  # The short form's contacts are the first of the long form's.
  "$bin/wrench_bench" --s 0.5 --pair-cases $(either 2 100) --json "$out/wrench_s0.5.json"
  [ $long = no ] || "$bin/wrench_bench" --s 1 --s 0.25 --pair-cases 10 --json "$out/wrench_sizes.json"
}
part_stability() {
  local table
  for table in $(either "cases:1 rest:150 table2:300000 seats:21 step:20000 drift:1000000" "cases rest table2 field seats grips step drift"); do
    "$bin/stability_bench" ${table//:/ } --json "$out/stability_${table%%:*}.json"
  done
}
part_clearance() {
  "$bin/clearance_bench" frames $(either "--count 5000" "") --json "$out/clearance.json"
  "$bin/clearance_bench" paths $(either "--count 3000" "") --json "$out/path.json"
  "$bench/path_time.py" $(either --short "") --json "$out/path_time.json"
}
part_cores() { "$bench/cores.py" $(either "--short --repeat 1" "") --json "$out/cores.json"; }
part_disassembly() { "$bench/disassembly.py" $(either --short "") --json "$out/disassembly.json"; }
# By half a voxel of room in the short form, by a tenth in the long one.
part_gaps() {
  env FORCELAYER_NARROW_GAPS="$out/narrow_gaps.csv" $(either "" FORCELAYER_LONG_TESTS=1) \
    "$bin/stress_tests" --gtest_filter='NarrowGaps.Are*' >"$out/narrow_gaps.log" || { cat "$out/narrow_gaps.log"; return 1; }
}
part_assembly() {
  local task
  for task in peg nut; do
    "$bin/assembly_bench" $task $(either --short "") --json "$out/assembly_$task.json"
  done
}
part_puzzles() { "$bin/puzzle_bench" $(either "--seeds 1 --time 2" "--seeds 10 --time 10") --poses 20000 --json "$out/puzzles.json"; }
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
