#!/usr/bin/env bash
# The table of the figures is that of the committed results; a figure that differs is found, in the README and on the page of
# benchmarks too, and so is one without a stated interval.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
fail() { echo "FAILED: $*" >&2; exit 1; }

"$FORCELAYER_SOURCE_DIR/tests/bench/tables.py" --check || fail "run tests/bench/tables.py and look at what it changes"

mkdir "$folder/tests" "$folder/docs"
cp -r "$FORCELAYER_SOURCE_DIR/tests/bench" "$folder/tests"
cp "$FORCELAYER_SOURCE_DIR/README.md" "$folder"
cp "$FORCELAYER_SOURCE_DIR"/docs/{limits,benchmarks}.md "$folder/docs"
tables=$folder/tests/bench/tables.py
page=tests/bench/results/summary.md
sed -i 's/^| contact query, 10^6 points against a wall | /&9/' "$folder/$page"
! cmp -s "$folder/$page" "$FORCELAYER_SOURCE_DIR/$page" || fail "the copy of $page was not changed"
! "$tables" --check 2>"$folder/said" || fail "a changed figure was not seen"
grep -q "$page" "$folder/said" || fail "it does not say where: $(cat "$folder/said")"
"$tables" >"$folder/said"
cmp "$folder/$page" "$FORCELAYER_SOURCE_DIR/$page" || fail "the table was not written again"

# Reports become one file for each name, with a run's number in every row; a figure that moved is named.
mkdir "$folder/reports" "$folder/csv"
report() {  # report FILE BENCHMARK COMMAND RESULTS
  echo "{\"benchmark\": \"$2\", \"command\": \"$3\", \"machine\": {\"cpu\": \"Test (R)\", \"cores\": 2, \"memory_gib\": 4,
    \"system\": \"Linux x86_64\", \"date\": \"2026-01-02T03:04:05Z\"}, \"results\": $4}" >"$folder/reports/$1.json"
}
report a stability "bench cases" '[{"campaign": "cases", "case": "c", "model": "default", "penetration_ratio": 0.5}]'
report b stability "bench rest" '[{"campaign": "rest", "case": "r", "model": "default", "quiet_fraction": 1.0}]'
report c path "bench paths" '{"path_poses": [{"scenes": "all", "moments": 10}], "path": []}'
"$folder/tests/bench/bench_csv.py" write "$folder/reports" "$folder/csv" >/dev/null
cat >"$folder/wanted" <<'WANTED'
# run 1: bench cases; 2026-01-02
# run 2: bench rest; 2026-01-02
run,campaign,case,model,penetration_ratio,quiet_fraction
1,cases,c,default,0.5,
2,rest,r,default,,1
WANTED
grep -v '^# machine\|^# commit' "$folder/csv/stability.csv" | cmp "$folder/wanted" || fail "the rows are $(cat "$folder/csv/stability.csv")"
cp -r "$folder/csv" "$folder/moved"
sed -i 's/,0.5,$/,0.9,/' "$folder/moved/stability.csv"
"$folder/tests/bench/bench_csv.py" compare "$folder/csv" "$folder/moved" >"$folder/said"
grep -q "cases, c, default: penetration_ratio 0.5, now 0.9" "$folder/said" || fail "a figure that moved was not named: $(cat "$folder/said")"
grep -q "^1 of " "$folder/said" || fail "not one figure moved: $(cat "$folder/said")"

# Every figure of the README's summary and of the texts has an entry with its interval, and a run outside of one is named.
figures=$folder/tests/bench/readme_figures.py
"$figures" --check || fail "a figure of the README has no entry"
mkdir "$folder/run"
cp "$folder/tests/bench/results/amd-epyc"/*.csv "$folder/run"
"$figures" "$folder/run" >"$folder/said"
grep -q "^0 of [0-9]* figures outside" "$folder/said" || fail "the committed figures are not inside: $(cat "$folder/said")"
awk -F, -v OFS=, 'NR > 3 && $2 == "aircraft" && $6 == "full" { $NF = $NF + 100000 } { print }' \
  "$folder/tests/bench/results/amd-epyc/bake_full.csv" >"$folder/run/bake_full.csv"
! cmp -s "$folder/run/bake_full.csv" "$folder/tests/bench/results/amd-epyc/bake_full.csv" || fail "the run was not changed"
"$figures" "$folder/run" >"$folder/said"
grep -q "bytes: OUTSIDE" "$folder/said" || fail "a file that grew was not named: $(cat "$folder/said")"
sed -i 's/^| presses that come to rest/| strikes that come to rest/' "$folder/tests/bench/results/summary.md"
! "$figures" --check 2>"$folder/said" || fail "a row without an entry was not seen"
grep -q "no entry for the summary's row 'strikes that come to rest'" "$folder/said" || fail "it does not say which: $(cat "$folder/said")"
sed -i 's/^| strikes that come to rest/| presses that come to rest/' "$folder/tests/bench/results/summary.md"
sed -i 's/^\(| contact query, 10^6 points against a wall | \)9.2 us/\19.1 us/; s/^## Results/It takes 31 us.\n\n## Results/' "$folder/README.md"
! "$figures" --check 2>"$folder/said" || fail "a figure in the text without an entry was not seen"
grep -q "the summary does not say '9.1 us'" "$folder/said" || fail "a figure of the README that differs was not seen: $(cat "$folder/said")"
grep -q "It takes 31 us" "$folder/said" || fail "it does not say which: $(cat "$folder/said")"
cp "$FORCELAYER_SOURCE_DIR/README.md" "$folder"
"$figures" --check || fail "the README as it is was refused"
sed -i 's/^\(| presses that come to rest | \)500 of 500/\1499 of 500/' "$folder/docs/benchmarks.md"
! "$figures" --check 2>"$folder/said" || fail "a figure on the page of benchmarks that differs was not seen"
grep -q "the summary does not say '499 of 500'" "$folder/said" || fail "it does not say which: $(cat "$folder/said")"
