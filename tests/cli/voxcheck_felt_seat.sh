#!/usr/bin/env bash
# A closed wall thicker than twice the covering radius is felt in a seat, however it lies between the voxels: by voxcheck
# --felt-seat, voxplan and voxrun.
source "$FORCELAYER_SOURCE_DIR/tests/support/command_test.sh"

printf 't_s,x_m,y_m,z_m\n0,0,0,0\n1,0.04,0,0\n' >sideways.csv
# A clip over a plate, with 0.1 mm of air. The plate is symmetric about x = 0, so no voxel of 1 mm is wholly inside of it.
for thickness in 1.75 1.95; do
  PYTHONPATH=$FORCELAYER_SOURCE_DIR/tests/support PYTHONDONTWRITEBYTECODE=1 python3 - "$thickness" <<'END'
import sys
from boxes import boxes
t, w, g = float(sys.argv[1]), 4, 0.1
a = t / 2 + g
boxes("tab.obj", ((-t / 2, -30, -60), (t / 2, 30, 0)))
boxes("clip.obj", ((-a - w, -10, -20), (-a, 10, g + w)), ((a, -10, -20), (a + w, 10, g + w)), ((-a, -10, g), (a, 10, g + w)))
END
  "$bin/voxelize" tab.obj --units mm --voxel-size 1mm -o tab.vox --quiet
  "$bin/pointshell" clip.obj --units mm --voxel-size 1mm -o clip.pshell --quiet
  seat=(--seat 0,0,0m --clearance 2mm)
  "$bin/voxcheck" tab.vox clip.pshell sideways.csv "${seat[@]}" --felt-seat >out.txt 2>err.txt && fail "sideways through a wall of $thickness mm: $(cat out.txt)"
  grep -qE '^Does not come out, .*: goes at least 0\.[0-9]+ mm deeper into tab than in the installed pose' out.txt || fail "$thickness mm: $(cat out.txt err.txt)"
  "$bin/voxplan" tab.vox clip.pshell "${seat[@]}" --time 20s -o path.csv --quiet || fail "no path off a wall of $thickness mm"
  python3 -c 'import csv
*_, last = csv.DictReader(open("path.csv"))
x, z = float(last["x_m"]), float(last["z_m"])
assert abs(x) < 0.003 and z > 0.020, last' || fail "the path does not lead up from a wall of $thickness mm"
  "$bin/voxrun" tab.vox clip.pshell --pull 40,0,0mm --device sim --as-fast-as-possible >out.txt 2>err.txt || fail "$(cat err.txt)"
  grep -qE '^the part did not leave its seat on tab, .*; the hand pulled 40 mm, the part moved 0\.0[0-9]+ mm, held, against tab' out.txt || fail "$thickness mm: $(cat out.txt)"
done
finish
