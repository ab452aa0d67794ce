#!/usr/bin/env bash
# The tables of the benchmarks' pages are those of the committed results; a figure that differs is found, and so is one of the
# README without a stated interval.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
fail() { echo "FAILED: $*" >&2; exit 1; }

"$FORCELAYER_SOURCE_DIR/tests/bench/tables.py" --check || fail "run tests/bench/tables.py and look at what it changes"

mkdir "$folder/tests"
cp -r "$FORCELAYER_SOURCE_DIR/tests/bench" "$folder/tests"
cp "$FORCELAYER_SOURCE_DIR/README.md" "$folder"
page=$folder/tests/bench/stability.md
sed -i 's/^| default | \([0-9]\)/| default | 9\1/' "$page"
! cmp -s "$page" "$FORCELAYER_SOURCE_DIR/tests/bench/stability.md" || fail "the copy was not changed"
! "$folder/tests/bench/tables.py" --check 2>"$folder/said" || fail "a changed figure was not seen"
grep -q "stability.md" "$folder/said" || fail "it does not say where: $(cat "$folder/said")"
"$folder/tests/bench/tables.py" >"$folder/said"
cmp "$page" "$FORCELAYER_SOURCE_DIR/tests/bench/stability.md" || fail "the table was not written again"

# Every figure of the README's summary and of the texts has an entry with its interval, and a run outside of one is told.
figures=$folder/tests/bench/readme_figures.py
mkdir -p "$folder/runtime"
cp "$FORCELAYER_SOURCE_DIR/runtime/limits.md" "$folder/runtime"
"$figures" --check || fail "a figure of the README has no entry"
mkdir "$folder/run"
cp "$folder/tests/bench/results/amd-epyc"/*.csv "$folder/run"
"$figures" "$folder/run" >"$folder/said"
grep -q "^0 of [0-9]* figures outside" "$folder/said" || fail "the committed figures are not inside: $(cat "$folder/said")"
awk -F, -v OFS=, 'NR > 3 && $2 == "aircraft" && $6 == "full" { $NF = $NF + 100000 } { print }' \
  "$folder/tests/bench/results/amd-epyc/bake_full.csv" >"$folder/run/bake_full.csv"
! cmp -s "$folder/run/bake_full.csv" "$folder/tests/bench/results/amd-epyc/bake_full.csv" || fail "the run was not changed"
"$figures" "$folder/run" >"$folder/said"
grep -q "bytes: OUTSIDE" "$folder/said" || fail "a file that grew was not told: $(cat "$folder/said")"
sed -i 's/^| presses that come to rest/| strikes that come to rest/' "$folder/README.md"
! "$figures" --check 2>"$folder/said" || fail "a row without an entry was not seen"
grep -q "no entry for the summary's row 'strikes that come to rest'" "$folder/said" || fail "it does not say which: $(cat "$folder/said")"
sed -i 's/^| strikes that come to rest/| presses that come to rest/; s/^## Results/It takes 31 us.\n\n## Results/' "$folder/README.md"
! "$figures" --check 2>"$folder/said" || fail "a figure in the text without an entry was not seen"
grep -q "It takes 31 us" "$folder/said" || fail "it does not say which: $(cat "$folder/said")"
