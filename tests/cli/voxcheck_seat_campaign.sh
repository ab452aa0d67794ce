#!/usr/bin/env bash
# Seats of nine kinds at random (seat_campaign.py): the meshes are never wrong, no part goes flat through a wall by the files
# or by a hand, and voxplan --exact finds a way out.
source "$FORCELAYER_SOURCE_DIR/tests/support/command_test.sh"

campaign() { python3 "$FORCELAYER_SOURCE_DIR/tests/support/seat_campaign.py" "$bin" "$@" >out.txt 2>&1 || fail "$*: $(cat out.txt)"; }

campaign files --seeds 2
grep -q '  flat: not clear$' out.txt || fail "no wall was tried: $(cat out.txt)"
campaign pull --kind clip_on_edge --way +x --seeds 2
grep -qx ' *2  flat: held' out.txt || fail "two clips are held: $(cat out.txt)"
if [ -x "$bin/voxcheck-exact" ]; then
  campaign exact --seed 3
  grep -q '  out: clear$' out.txt || fail "nothing came out: $(cat out.txt)"
fi
if [ -x "$bin/voxplan" ]; then
  campaign plan --kind clip_on_edge
  grep -qx ' *1  plan: found' out.txt || fail "no way out: $(cat out.txt)"
fi
finish
