#!/usr/bin/env bash
# Points and memory that a bake tells before it begins are within a factor of two of those that it takes, for
# parts of many kinds.
set -u
source "$FORCELAYER_SOURCE_DIR/tests/support/command_test.sh"
parts=(touching copies solid ball threads grooves)
[ "${FORCELAYER_LONG_TESTS:-0}" = 1 ] && parts+=(bodies fan stray)
python3 "$FORCELAYER_SOURCE_DIR/tests/support/part_traps.py" --csv told.csv --bin "$bin" --parts "${parts[@]}" --within 2 2>err ||
  fail "$(cat err)"
[ "$(wc -l <told.csv)" = $((${#parts[@]} + 1)) ] || fail "rows are missing: $(cat told.csv)"
# The check can fail.
python3 "$FORCELAYER_SOURCE_DIR/tests/support/part_traps.py" --csv told.csv --bin "$bin" --parts copies --within 1.001 2>err &&
  fail "nothing is off by a thousandth"
grep -q "told as told_" err || fail "not the reason: $(cat err)"
exit 0
