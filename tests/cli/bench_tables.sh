#!/usr/bin/env bash
# The tables of the benchmarks' pages are those of the committed results; a figure that differs is found.
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
