#!/usr/bin/env bash
# Points and memory that a bake tells before it begins are within a factor of two of those that it takes, for
# parts of many kinds. Detail finer than a voxel and surface inside other bodies cost no more than the rest.
set -u
source "$FORCELAYER_SOURCE_DIR/tests/support/command_test.sh"
traps() { python3 "$FORCELAYER_SOURCE_DIR/tests/support/part_traps.py" --bin "$bin" "$@" 2>err; }
parts=(touching copies solid ball threads grooves)
[ "${FORCELAYER_LONG_TESTS:-0}" = 1 ] && parts+=(bodies fan stray)
traps --csv told.csv --parts "${parts[@]}" --within 2 || fail "$(cat err)"
[ "$(wc -l <told.csv)" = $((${#parts[@]} + 1)) ] || fail "rows are missing: $(cat told.csv)"
traps --csv overlapping.csv --parts overlapping || fail "$(cat err)"
python3 - 2>err <<'END' || fail "$(cat err told.csv overlapping.csv)"
import csv
rows = {row["part"]: row for name in ("told", "overlapping") for row in csv.DictReader(open(name + ".csv"))}
off = {part: float(row["cpu_s"]) / float(row["told_cpu_s"]) for part, row in rows.items() if row["told_cpu_s"]}
typical = max(off[part] for part in ("touching", "copies", "solid", "ball"))  # of this machine
for part in "threads", "grooves":  # nine times as told, if each sliver takes pieces of its own
    assert off[part] < 5 * typical, (part, off)
# A third of the time that the points take. Twice that time, if each place asks for a winding number.
assert 0 < float(rows["overlapping"]["hidden_s"]) < float(rows["overlapping"]["points_s"]), "surface inside other bodies"
END
# The check can fail.
traps --csv told.csv --parts copies --within 1.001 && fail "nothing is off by a thousandth"
grep -q "told as told_" err || fail "not the reason: $(cat err)"
finish
