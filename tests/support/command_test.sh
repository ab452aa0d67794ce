# Sourced by the tests of the commands that count their failures: a scratch folder to work in, removed at the end.
source "$FORCELAYER_SOURCE_DIR/tests/support/skipped.sh"
bin=$FORCELAYER_BIN_DIR
data=$FORCELAYER_SOURCE_DIR/sample_data
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
failures=0

fail() {
  echo "FAILED: $*" >&2
  failures=$((failures + 1))
}

# The last line of a test.
finish() {
  [ $failures = 0 ] && echo "all good"
  exit $((failures > 0))
}
