#!/usr/bin/env bash
# The README's figures are those of the committed results; a result that changes, a sentence that
# changes and a number that no result backs are found, and --write brings the README up to date.
set -euo pipefail
check=$FORCELAYER_SOURCE_DIR/tests/bench/readme_figures.py
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

fail() { echo "FAILED: $*" >&2; exit 1; }

"$check" || fail "run tests/bench/readme_figures.py --write and look at what it changes"

results=$FORCELAYER_SOURCE_DIR/tests/bench/$(grep -o 'results/[a-z0-9-]*' "$FORCELAYER_SOURCE_DIR/README.md" | head -1)
fresh() {
  rm -rf "$folder/results"
  cp -r "$results" "$folder/results"
  cp "$FORCELAYER_SOURCE_DIR/README.md" "$folder/README.md"
}
copy() { "$check" --readme "$folder/README.md" --results "$folder/results" "$@"; }

fresh
copy || fail "a copy does not agree"

# A figure of a report changes: the README is wrong, and --write mends it.
python3 - "$folder/results/shell_dragon_985.json" <<'END'
import json, sys
report = json.load(open(sys.argv[1]))
for row in report["results"]["meshes"]:
    row["wall_s"] *= 3
json.dump(report, open(sys.argv[1], "w"))
END
! copy 2>"$folder/said" || fail "a changed report was not seen"
grep -q "A shell has" "$folder/said" || fail "it does not say where: $(cat "$folder/said")"
copy --write >/dev/null || fail "--write does not mend"
copy || fail "what --write wrote does not agree"

# What the words say is no longer true.
fresh
sed -i 's/"penetration_frames": 0,/"penetration_frames": 1,/' "$folder/results/stability_table2.json"
! copy 2>"$folder/said" || fail "a false sentence was not seen"
grep -q "no longer true" "$folder/said" || fail "it does not say so: $(cat "$folder/said")"

# A number typed into the README, and a sentence taken out.
fresh
sed -i 's/^## How fast a scene bakes$/&\n\nIt is 1234 times as fast./' "$folder/README.md"
! copy 2>"$folder/said" || fail "a typed number was not seen"
grep -q "1234" "$folder/said" || fail "it does not name it: $(cat "$folder/said")"
fresh
sed -i 's/A shell has/Shells have/' "$folder/README.md"
! copy 2>/dev/null || fail "a missing sentence was not seen"
echo "the README agrees with $(basename "$results")"
