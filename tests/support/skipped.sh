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

# Under valgrind a program with Highway's library cannot be loaded where the processor lacks this instruction, or the
# kernel does not name it.
skip_without_timer_of_highway() {
  [ "$(uname -m)" != x86_64 ] || grep -qw rdtscp /proc/cpuinfo || skip "valgrind cannot run rdtscp here"
}
