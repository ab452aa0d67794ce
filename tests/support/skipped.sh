# Sourced by the tests of the commands: how one of them says that it cannot run here.

skip() {  # REASON...
  echo "SKIPPED: $*"
  exit 77
}

# For programs that scripts/packages.txt installs: scripts/test.sh fails in CI=true where one is missing.
skip_without() {  # PACKAGE COMMAND...: skips unless COMMAND works
  local package=$1
  shift
  "$@" >/dev/null 2>&1 || skip "needs $package of scripts/packages.txt"
}
