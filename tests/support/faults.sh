# Shared by the scripts of faults; to be sourced. Each fault is a function; `run_faults` runs them
# all (or those that FORCELAYER_FAULT names), each in a folder of its own, and says which failed and
# which could not be injected here.
bin=$FORCELAYER_BIN_DIR
shim=$FORCELAYER_BIN_DIR/fault_shim.so
# Faults come by LD_PRELOAD, before a sanitizer's own libraries.
export ASAN_OPTIONS=verify_asan_link_order=0:${ASAN_OPTIONS-}
sanitized() { grep -aq -e __asan_init -e __tsan_init "$bin/voxinfo"; }

fail() {
  echo "FAILED: $fault: $*" >&2
  echo 1 >>"$scratch/failures"
}
skip() { echo "SKIPPED: $fault: $*"; }

# expect STATUS TEXT COMMAND...: that status, one line on stderr that holds the text.
expect() {
  local status=$1 text=$2 got
  shift 2
  timeout -k 1 120 "$@" >"$scratch/out.txt" 2>"$scratch/err.txt"
  got=$?
  [ $got = "$status" ] || fail "status $got instead of $status: $*: $(tail -n 3 "$scratch/err.txt")"
  [ "$(wc -l <"$scratch/err.txt")" = 1 ] || fail "not one line on stderr: $*: $(tail -n 3 "$scratch/err.txt")"
  grep -qF -e "$text" "$scratch/err.txt" || fail "no '$text' on stderr: $*: $(tail -n 3 "$scratch/err.txt")"
}

# good COMMAND...: status 0, nothing on stderr.
good() {
  timeout -k 1 120 "$@" >"$scratch/out.txt" 2>"$scratch/err.txt" || fail "status $?: $*: $(tail -n 3 "$scratch/err.txt")"
  [ ! -s "$scratch/err.txt" ] || fail "noise on stderr: $*: $(tail -n 3 "$scratch/err.txt")"
}

same() { cmp -s "$1" "$2" || fail "$3: other bytes"; }
no_leftovers() { [ -z "$(find . -name '.*.tmp')" ] || fail "left behind: $(find . -name '.*.tmp')"; }

# In a mount namespace of its own: as_root COMMAND..., where this is allowed.
can_mount() { unshare --mount true 2>/dev/null; }

run_faults() {
  scratch=$(mktemp -d)
  trap 'chmod -R u+rwx "$scratch"; rm -rf "$scratch"' EXIT
  for fault in ${FORCELAYER_FAULT:-"$@"}; do
    mkdir "$scratch/$fault"
    (cd "$scratch/$fault" && "$fault")
  done
  [ ! -e "$scratch/failures" ] && echo "all good"
  [ ! -e "$scratch/failures" ]
}
