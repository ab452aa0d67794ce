#!/usr/bin/env bash
# The loop under valgrind: every model and force field steps through contact without reading what was
# never written, touching what is not its own, or leaking.
set -euo pipefail
source "$FORCELAYER_SOURCE_DIR/tests/support/skipped.sh"
skip_without valgrind command -v valgrind
skip_without_timer_of_highway
grep -q '^CMAKE_CXX_FLAGS:.*-fsanitize' "$FORCELAYER_BUILD_DIR/CMakeCache.txt" &&
  skip "valgrind and sanitizers do not mix"
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cd "$scratch"
"$FORCELAYER_BIN_DIR/make_runtime_files" .
check() {
  valgrind --quiet --error-exitcode=9 \
    --leak-check=full --errors-for-leak-kinds=definite,indirect "$FORCELAYER_BIN_DIR/voxrun" \
    floor.vox ball.pshell --motion press.csv --as-fast-as-possible --quiet "$@"
}
check --json run.json --trace run.csv --record run.flr
check --model paper
check --force tangent-plane --device sim:hand=firm --threads 2
check --duration 100ms --udp 127.0.0.1:9
python3 -c 'import json; r = json.load(open("run.json")); assert r["force_layer_frames"] > 100, r'
echo "no error in four runs"
