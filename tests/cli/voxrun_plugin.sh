#!/usr/bin/env bash
# Every way in which a device with motors can fail, with voxrun as a user runs it; what the motors did
# is what the device itself wrote down (tests/support/fault_plugin.c).
set -euo pipefail
# Milliseconds decide which fault it is, and a sanitizer's build is too slow for that.
source "$FORCELAYER_SOURCE_DIR/tests/support/skipped.sh"
grep -q '^CMAKE_CXX_FLAGS:.*-fsanitize' "$FORCELAYER_BUILD_DIR/CMakeCache.txt" &&
  skip "a build with sanitizers is too slow for the loop's clock"
bin=$FORCELAYER_BIN_DIR
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cd "$scratch"
"$bin/make_runtime_files" .
FORCELAYER_BIN_DIR=$bin exec python3 "$FORCELAYER_SOURCE_DIR/tests/cli/voxrun_plugin_check.py"
