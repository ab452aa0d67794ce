#!/usr/bin/env bash
# "Lean" is about dependencies, start-up and memory: the programs of a workstation load no library of the bake or the
# workbench, start in a few milliseconds of work, and take little memory beside the files.
set -euo pipefail
source "$FORCELAYER_SOURCE_DIR/tests/support/skipped.sh"
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
fail=0

# Dependencies.
for program in voxrun voxrun-doctor voxrun-plugin voxcheck voxinfo forcelayer; do
  binary=$FORCELAYER_BIN_DIR/$program
  [ -x "$binary" ] || { echo "FAILED: $binary is missing" >&2; exit 1; }
  [ "$program" != voxinfo ] || continue  # it exports .vdb where OpenVDB is
  if ldd "$binary" | grep -E 'openvdb|OpenMesh|draco|libtbb|vtk|boost|fcl|ompl|libTK'; then
    echo "FAILED: $program links an offline library" >&2
    fail=1
  fi
done

# Memory: the peak of a process, in kB. 14,000 and 20,000 today; the libraries' pages are most of it.
peak_kb() {  # COMMAND...
  python3 - "$@" <<'END'
import resource, subprocess, sys
subprocess.run(sys.argv[1:], stdout=subprocess.DEVNULL, check=True)
print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)
END
}
cd "$scratch"
"$FORCELAYER_BIN_DIR/make_runtime_files" .
at_most() {  # NUMBER MOST WHAT
  echo "$3: $1, at most $2"
  [ "$1" -le "$2" ] || { echo "FAILED: $3 takes more" >&2; fail=1; }
}
at_most "$(peak_kb "$FORCELAYER_BIN_DIR/voxrun" --version)" 25000 "kB of voxrun --version"
at_most "$(peak_kb "$FORCELAYER_BIN_DIR/voxrun" floor.vox ball.pshell --motion press.csv --duration 100ms \
  --as-fast-as-possible --quiet)" 40000 "kB of a small run"

# Start-up: instructions beyond those of `true`: the dynamic loader's are among them, and 3 million with which Highway's
# library measures a timer while it is loaded. 7.6 million today, give or take a tenth.
if ! grep -q '^CMAKE_BUILD_TYPE:.*=Release' "$FORCELAYER_BUILD_DIR/CMakeCache.txt"; then
  echo "no optimized build: its instructions are not counted"
  exit $fail
fi
skip_without valgrind command -v valgrind
skip_without_timer_of_highway
instructions() {  # COMMAND...
  valgrind --tool=callgrind --callgrind-out-file=/dev/null "$@" 2>&1 |
    sed -n 's/.*refs: *//p' | tr -d ,
}
at_most "$(($(instructions "$FORCELAYER_BIN_DIR/voxrun" --version) - $(instructions true)))" 12000000 \
  "instructions of voxrun --version beyond true"
exit $fail
