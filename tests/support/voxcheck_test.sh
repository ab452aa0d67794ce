# Sourced by tests of voxcheck.
source "$FORCELAYER_SOURCE_DIR/tests/support/command_test.sh"

# check STATUS ARGUMENTS...: that exit status; what was said is in out.txt and err.txt.
check() {
  local wanted=$1 status=0
  shift
  "$bin/voxcheck" "$@" >out.txt 2>err.txt || status=$?
  [ "$status" -eq "$wanted" ] || fail "status $status instead of $wanted: $*: $(cat out.txt err.txt)"
}
# path NAME "T X Y Z"...: a path in mm.
path() { local name=$1; shift; { echo t_s,x_mm,y_mm,z_mm; printf '%s\n' "$@" | tr ' ' ,; } >"$name.csv"; }
says() { grep -qE -e "$1" out.txt || fail "not said: '$1': $(cat out.txt err.txt)"; }
errs() { grep -qE -e "$1" err.txt || fail "no '$1' on stderr: $(cat err.txt)"; }
