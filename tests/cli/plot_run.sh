#!/usr/bin/env bash
# plot_run.py: what the picture says is what the trace holds; a bad trace leaves no picture.
set -euo pipefail
python=/usr/bin/python3
source "$FORCELAYER_SOURCE_DIR/tests/support/skipped.sh"
skip_without python3-matplotlib "$python" -c 'import matplotlib'
plot=$FORCELAYER_SOURCE_DIR/scripts/plot_run.py
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

fail() { echo "FAILED: $*" >&2; exit 1; }

# 5000 frames; a force of (3, 0, 4) N in frame 1234 alone; a turned grip that must not look like
# stretch; 7 mm of stretch in frame 2000, 3.4 mm of depth in frame 777; penetration in 3 frames, guard cuts in 2.
"$python" - >trace.csv <<'END'
header = (["t_s"] + [f"{f}_{n}" for f in ("handle", "part")
          for n in ("x_m", "y_m", "z_m", "qw", "qx", "qy", "qz")]
          + [f"force_{n}_n" for n in "xyz"] + [f"torque_{n}_nm" for n in "xyz"]
          + ["points_proximity", "points_surface", "points_interior", "contacts", "depth_m",
             "guard_cuts", "step_ns"])
print(",".join(header))
half = 0.5 ** 0.5
for n in range(5000):
    handle = [0.1 + n * 1e-5, 0, 0, half, 0, 0, half]       # turned by 90 degrees about z
    stretch = 0.007 if n == 2000 else 0
    part = [handle[0], 0.05, stretch, 1, 0, 0, 0]           # 50 mm along the handle's own x
    force = [3, 0, 4] if n == 1234 else [0, 0, 0]
    row = [n / 1000, *handle, *part, *force, 0, 0, 0.25 if n == 99 else 0, 4, 3,
           int(n in (5, 6, 7)), 2, 0.0034 if n == 777 else 0.001, int(n in (8, 9)), 1000 if n != 4000 else 50000]
    print(",".join(map(repr, row)))
END

"$plot" trace.csv -o run.svg
for words in 'greatest 5 N<' 'greatest 0.25 N m' 'greatest depth 3.4 mm, stretch 7 mm' \
             '3 penetration frames, 2 frames cut' 'p50 1 us, p99 1 us, p99.9 1 us, max 50 us' \
             'time (s)'; do
  grep -qF "$words" run.svg || fail "no '$words' in the picture"
done
cp run.svg first.svg
"$plot" trace.csv -o run.svg
cmp run.svg first.svg || fail "the same trace gave another picture"
"$plot" trace.csv -o run.png
[ "$(head -c 4 run.png | tail -c 3)" = PNG ] || fail "run.png is no PNG"

expect() {  # STATUS WORDS ARGUMENTS...
  local status=$1 words=$2 got=0
  shift 2
  "$plot" "$@" -o bad.svg 2>error.txt || got=$?
  [ "$got" = "$status" ] || fail "status $got, not $status: $*"
  [ "$(tail -n 1 error.txt | grep -c "$words")" = 1 ] || fail "not said: $words: $(cat error.txt)"
  [ ! -e bad.svg ] || fail "a picture of a bad trace"
}
sed '1s/force_x_n/power/' trace.csv >header.csv
sed '3s/0.001/one/' trace.csv >word.csv
sed '1s/depth_m/depth/' trace.csv >old.csv
head -n 1 trace.csv >empty.csv
head -c 3000 trace.csv >cut.csv
expect 4 "line 1: no column 'force_x_n'" header.csv
expect 4 "line 1: no column 'depth_m'" old.csv
expect 4 'line 3: ' word.csv
expect 4 'no row' empty.csv
expect 4 'another length' cut.csv
expect 1 'No such file' nowhere.csv
expect 2 'usage\|arguments' trace.csv --nonsense
