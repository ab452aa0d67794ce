#!/usr/bin/env bash
# voxplan: parts leave their seats; voxcheck proves the paths; the same seed, the same path; an honest no; its errors.
source "$FORCELAYER_SOURCE_DIR/tests/support/command_test.sh"
gearbox=$data/gearbox.glb
"$bin/voxelize" "$gearbox" --without Lid --voxel-size 2mm -o opened.vox --quiet
"$bin/voxelize" "$gearbox" --without Cover --voxel-size 1mm -o bolted.vox --quiet
"$bin/pointshell" "$gearbox#Cover" --voxel-size 2mm -o cover.pshell --quiet
"$bin/pointshell" "$gearbox#Cover" --voxel-size 1mm -o fine.pshell --quiet
# plan STATUS ARGUMENTS...
plan() {
  local wanted=$1 status=0
  shift
  "$bin/voxplan" "$@" >out.txt 2>err.txt || status=$?
  [ "$status" -eq "$wanted" ] || fail "status $status instead of $wanted: $*: $(cat out.txt err.txt)"
}
errs() { grep -qE -e "$1" err.txt || fail "no '$1' on stderr: $(cat err.txt)"; }

# The cover goes up where no bolt holds it: by files alone, and by the meshes.
plan 0 opened.vox cover.pshell --clearance 2mm -o up.csv --json up.json --threads 2
grep -qE '^Comes out, .*: (slides along Housing.* for|leaves Housing.* within) the first [0-9.]+ mm, otherwise stays [0-9.]+ mm away or more \((proven; nearest to [A-Z][a-z]+(\[[0-9]\])?, after [0-9.]+ of [0-9.]+ mm|nothing is nearer); 2 mm required\)\.$' out.txt || fail "$(cat out.txt)"
grep -qE '^  found in [0-9.]+ s$' out.txt || fail "$(cat out.txt)"
grep -qE '^  in its seat from 0\.0 to [0-9.]+ mm along the path: at least 0 mm .* to ' out.txt || fail "$(cat out.txt)"
grep -qE '^  not checked: hidden objects less than 6 mm behind an object of the seat or of --allow; check the path with voxcheck --exact$' out.txt || fail "$(cat out.txt)"
"$bin/voxcheck" opened.vox cover.pshell up.csv --clearance 2mm --seat 0,0,0m --felt-seat --quiet --json check.json ||
  fail "by files alone"
"$bin/voxcheck" opened.vox cover.pshell up.csv --clearance 2mm --seat 0,0,0m --quiet \
  --exact "$gearbox" --without Lid --part "$gearbox#Cover" || fail "by the meshes"
python3 - <<'END' || fail "the report: $(cat up.json)"
import json
report = json.load(open("up.json"))
assert report["found"] and report["verdict"] == "clear" and report["kind"] == "comes out", report
assert report["sentence"] == open("out.txt").readline().strip(), report["sentence"]
assert report["required_clearance_m"] == 0.002 <= report["min_clearance"]["clearance_m"]
rows = [line.split(",") for line in open("up.csv").read().splitlines()]
assert report["rows"] == len(rows) - 1 and float(rows[-1][0]) == report["duration_s"]
assert [float(cell) for cell in rows[1]] == [0, 0, 0, 0, 1, 0, 0, 0], rows[1]
assert report["seat"][0] == "Gearbox/Housing" and report["seated"][0]["from_s"] == 0
check = json.load(open("check.json"))
assert all(report[key] == check[key] for key in ("seat", "seated", "min_clearance", "hidden_within_m")), (report, check)
END
plan 0 opened.vox cover.pshell --clearance 2mm -o again.csv --threads 1 --quiet
[ ! -s out.txt ] || fail "--quiet: $(cat out.txt)"
cmp up.csv again.csv || fail "the same seed, another path"

# It is smooth enough to be felt: no corner between two rows of more than 10 degrees, and 3 degrees a millimeter at most.
cat >corners.py <<'END'
import math, sys
rows = [[float(cell) for cell in line.split(",")][1:4] for line in open(sys.argv[1]).read().splitlines()[1:]]
for a, b, c in zip(rows, rows[1:], rows[2:]):
    legs = math.dist(a, b), math.dist(b, c)
    if min(legs) < 1e-9: continue
    cosine = sum((q - p) * (r - q) for p, q, r in zip(a, b, c)) / legs[0] / legs[1]
    corner = math.degrees(math.acos(max(-1, min(1, cosine))))
    assert corner < 10 and corner / (1e3 * min(legs)) < 3, (corner, legs)
END
python3 corners.py up.csv || fail "it has corners: $(cat up.csv)"

# The scene holds the part too: that is said before the search.
"$bin/voxelize" "$gearbox" --voxel-size 2mm -o whole.vox --quiet
plan 2 whole.vox cover.pshell --clearance 1mm --time 0.5s -o no.csv
errs '^voxplan: warning: the scene seems to contain the part itself: every point of the part touches the scene; bake the scene --without the part'

# A pin goes exactly straight along its bore, as a hand would draw it.
"$bin/voxelize" "$gearbox" --without Pin --voxel-size 1mm -o rest.vox --quiet
"$bin/pointshell" "$gearbox#Pin" --voxel-size 1mm -o pin.pshell --quiet
plan 0 rest.vox pin.pshell --clearance 1mm -o pin.csv --json pin.json
python3 - <<'END' || fail "the pin leans: $(cat pin.csv)"
import json
out_s = json.load(open("pin.json"))["seated"][0]["to_s"]
rows = [[float(cell) for cell in line.split(",")] for line in open("pin.csv").read().splitlines()[1:]]
seated = [row for row in rows if row[0] <= out_s]
after = rows[len(seated)]
assert after[3] > 0.02, rows
for row in seated + [after]:
    assert max(map(abs, row[1:3] + row[5:])) < 1e-9 and abs(row[4] - 1) < 1e-9, row
END

python3 corners.py pin.csv || fail "the pin's way has corners: $(cat pin.csv)"

# To a pose.
plan 0 opened.vox cover.pshell --clearance 2mm --goal 0,0,40mm -o to.csv --quiet
tail -n 1 to.csv | grep -qE '^[0-9.]+(,-?[0-9.e-]+){7}$' || fail "$(tail -n 1 to.csv)"
python3 - <<'END' || fail "not at the goal: $(tail -n 1 to.csv)"
row = [float(cell) for cell in open("to.csv").read().splitlines()[-1].split(",")]
assert max(abs(a - b) for a, b in zip(row[1:], [0, 0, 0.04, 1, 0, 0, 0])) < 1e-9
END

# Bolts hold it; voxels of 1 mm feel their heads.
plan 6 bolted.vox fine.pshell --clearance 2mm --time 1s -o no.csv --json no.json
errs '^voxplan: fine.pshell: no path found: a search of [0-9.]+ s moved (no point by more than [0-9.]+|it by less than 0\.001) mm.* \(2 mm of clearance required\); blocked by .*Bolt.*; this does not prove'
[ ! -e no.csv ] || fail "a path is there"
python3 -c 'import json; r = json.load(open("no.json")); assert not r["found"] and r["verdict"] == "not clear" and r["kind"] == "no path found" and r["best"]["out_m"] < 0.02, r' || fail "no.json"

# A bolt with its nut clamps a plate and a bracket: they hold it, and no neighbor that stands 5 voxels away.
python3 - <<'END'
def turned(name, profile, closed):
    """A square prism of these half widths and heights, mm; a tube where the profile is closed."""
    with open(name, "w") as obj:
        for half, z in profile:
            for x, y in ((1, 1), (-1, 1), (-1, -1), (1, -1)):
                obj.write(f"v {half * x} {half * y} {z}\n")
        rings = len(profile)
        for n in range(rings if closed else rings - 1):
            for side in range(4):
                a, b = 4 * n + side, 4 * n + (side + 1) % 4
                obj.write("f " + " ".join(str(1 + c % (4 * rings)) for c in (a, b, b + 4, a + 4)) + "\n")
        if not closed:
            last = 4 * rings
            obj.write(f"f 4 3 2 1\nf {last - 3} {last - 2} {last - 1} {last}\n")
turned("bolt.obj", [(10, -19), (10, -15), (5, -15), (5, 15), (10, 15), (10, 19)], False)
turned("plate.obj", [(5, -15), (30, -15), (30, 0), (5, 0)], True)
turned("bracket.obj", [(5, 0), (30, 0), (30, 15), (5, 15)], True)
turned("neighbor.obj", [(5, 15), (5, 19)], False)
END
cat >clamped.json <<'END'
{"parts": [{"name": "plate", "mesh": "plate.obj", "units": "mm"}, {"name": "bracket", "mesh": "bracket.obj", "units": "mm"},
           {"name": "east", "mesh": "neighbor.obj", "units": "mm", "translation": ["20mm", 0, 0]},
           {"name": "west", "mesh": "neighbor.obj", "units": "mm", "translation": ["-20mm", 0, 0]},
           {"name": "north", "mesh": "neighbor.obj", "units": "mm", "translation": [0, "20mm", 0]},
           {"name": "south", "mesh": "neighbor.obj", "units": "mm", "translation": [0, "-20mm", 0]}]}
END
"$bin/voxelize" clamped.json --voxel-size 1mm -o clamped.vox --quiet
"$bin/pointshell" bolt.obj --units mm --voxel-size 1mm -o bolt.pshell --quiet
plan 6 clamped.vox bolt.pshell --clearance 1mm --time 1s -o no.csv --json no.json
errs 'blocked by (plate and bracket|bracket and plate|plate, bracket|bracket, plate)'
python3 -c '
import json
best = json.load(open("no.json"))["best"]
assert best["out_m"] < 0.001 and sorted(best["blocked_by"][:2]) == ["bracket", "plate"], best' || fail "who holds the bolt: $(cat no.json)"

# Distances that end at the mesh hold no seat.
"$bin/voxelize" "$gearbox" --without Lid --voxel-size 2mm --layers 5 -o shallow.vox --quiet
plan 2 shallow.vox cover.pshell -o x.csv --clearance 1mm
errs '--seat: the part touches Gearbox/[^ ]*, but no distances are stored deep enough for a seat; .* --range$'
"$bin/voxelize" "$gearbox" --without Lid --voxel-size 2mm --layers 5 --range 14mm -o shallow.vox --quiet
plan 0 shallow.vox cover.pshell -o x.csv --clearance 1mm --quiet

plan 2 opened.vox cover.pshell -o x.csv --out-of-scene
errs 'is an option of an earlier version; leave it out: it is the default'
plan 2 opened.vox cover.pshell -o x.csv --goal 0,0,1mm --clearance 2mm
errs '--goal: the part is nearer to Housing than --clearance: only [0-9.]+ mm are proven'
plan 2 opened.vox cover.pshell -o x.csv --goal 0,0,100km --clearance 2mm --time 1s
errs '--goal: is more than a million voxels from the seat'
plan 2 opened.vox cover.pshell -o opened.vox
plan 1 none.vox cover.pshell -o x.csv
errs 'none.vox: no such file'

# Out of a scene in which it never was: its unit or its seat is wrong.
plan 0 opened.vox cover.pshell -o far.csv --seat 5m,0,0m --clearance 1mm --json far.json
errs 'warning: the part is never near the scene: check that part and seat belong to this scene'

# Where all sides of the scene are cropped no way leads beside it: that is said at once, and why an end is refused.
"$bin/voxelize" "$gearbox" --without Lid --voxel-size 2mm --roi 10mm,10mm,10mm,70mm,60mm,60mm -o cropped.vox --quiet
plan 2 cropped.vox cover.pshell -o x.csv --seat 0,0,0m --clearance 2mm --time 20s
errs '--seat: the part is nearer to a cropped side of the scene than --clearance, and nothing is known beyond this side; bake'
printf 'v %s\n' '20 20 50' '24 20 50' '20 24 50' '20 20 54' >tip.obj
printf 'f %s\n' '1 3 2' '1 2 4' '1 4 3' '2 3 4' >>tip.obj
"$bin/pointshell" tip.obj --units mm --voxel-size 2mm -o tip.pshell --quiet
plan 2 cropped.vox tip.pshell -o x.csv --clearance 1mm --time 20s
errs '--goal: is missing, and all sides of the scene are cropped, so nothing is known outside of the scene; add --goal'
plan 0 cropped.vox tip.pshell -o x.csv --clearance 1mm --goal 2mm,0,0m --quiet
plan 2 cropped.vox tip.pshell -o x.csv --clearance 1mm --goal 50mm,0,0m
errs '--goal: the part is nearer to a cropped side of the scene than --clearance'
# Above a tub whose lid was cropped away a part is not out of the scene: the way goes on to a side where the scene ends.
PYTHONPATH=$FORCELAYER_SOURCE_DIR/tests/support PYTHONDONTWRITEBYTECODE=1 python3 - <<'END'
from boxes import boxes
walls = [((-12, -12, 0), (-10, 12, 10)), ((10, -12, 0), (12, 12, 10)), ((-10, -12, 0), (10, -10, 10)), ((-10, 10, 0), (10, 12, 10))]
boxes("tub.obj", ((-12, -12, -2), (12, 12, 0)), *walls)
boxes("lid.obj", ((-40, -40, 60), (40, 40, 62)))
boxes("chip.obj", ((-2, -2, 4), (2, 2, 8)))
# A room with a window of 10 x 10 mm in its ceiling, and a bar of 6 x 6 x 30 mm that lies in it: a meter from the origin.
def frame(half, outer, low, high):
    return [((-outer, -outer, low), (-half, outer, high)), ((half, -outer, low), (outer, outer, high)),
            ((-half, -outer, low), (half, -half, high)), ((-half, half, low), (half, outer, high))]
def aside(*all):
    return [tuple((x + 1000, y, z) for x, y, z in pair) for pair in all]
boxes("room.obj", *aside(((-25, -25, -25), (25, 25, -20)), *frame(20, 25, -20, 20), *frame(5, 25, 20, 25)))
boxes("bar.obj", *aside(((-15, -3, -3), (15, 3, 3))))
boxes("crate.obj", ((-20, -20, -20), (20, 20, 20)))  # all around the chip
END
"$bin/voxelize" tub.obj lid.obj --units mm --voxel-size 1mm --roi=-50mm,-50mm,-50mm,50mm,50mm,30mm -o tub.vox --quiet
"$bin/pointshell" chip.obj --units mm --voxel-size 1mm -o chip.pshell --quiet
plan 0 tub.vox chip.pshell --clearance 1mm -o tub.csv
python3 - <<'END' || fail "it ends within the scene: $(tail -n 1 tub.csv)"
x, y, z = [1e3 * float(cell) for cell in open("tub.csv").read().splitlines()[-1].split(",")][1:4]
assert max(abs(x), abs(y)) > 12 or z < -2, (x, y, z)
END

# A bar that fits through a window on end alone stands up and goes: 2 mm of room on each side.
"$bin/voxelize" room.obj --units mm --voxel-size 0.5mm --free-seed 1m,0,10mm -o room.vox --quiet
"$bin/pointshell" bar.obj --units mm --voxel-size 0.5mm -o bar.pshell --quiet
plan 0 room.vox bar.pshell --clearance 1mm --time 10s -o bar.csv --json bar.json
python3 - "$(cat out.txt)" <<'END' || fail "how long its way is: $(cat out.txt)"
import json, math, re, sys
report = json.load(open("bar.json"))  # no point is faster than 0.1 m/s, and the centroid is no faster than a point
rows = [[float(cell) for cell in line.split(",")] for line in open("bar.csv").read().splitlines()[1:]]
def centroid_mm(t, x, y, z, w, i, j, k):  # it is at x = 1000 mm of the part
    return [1e3 * (x + 1 - 2 * (j * j + k * k)), 1e3 * (y + 2 * (i * j + w * k)), 1e3 * (z + 2 * (i * k - w * j))]
least_mm = sum(math.dist(centroid_mm(*a), centroid_mm(*b)) for a, b in zip(rows, rows[1:]))
length_mm = float(re.search(r" of ([0-9.]+) mm;", sys.argv[1])[1])
assert 20 < least_mm - 0.1 < length_mm < 100 * report["duration_s"] + 0.1, (least_mm, sys.argv, report)
assert report["length_m"] > 1, report  # of the frame's origin
END
"$bin/voxcheck" room.vox bar.pshell bar.csv --clearance 1mm --quiet || fail "the bar's way is not clear"
plan 6 room.vox bar.pshell --clearance 2.1mm --time 0.5s -o no.csv

# A shell for other voxels proves less.
"$bin/pointshell" bar.obj --units mm --voxel-size 2mm -o coarse.pshell --quiet
plan 6 room.vox coarse.pshell --clearance 1.2mm --time 0.5s -o no.csv --json no.json
errs '^voxplan: warning: the part.s covering radius, 1\.73 mm, is larger than a voxel of the scene, 0\.5 mm, .* --voxel-size 0\.5mm$'
grep -q 'covering radius' no.json || fail "the coarse shell is not in the report"
# A part that is modeled around an object.
"$bin/voxelize" chip.obj --units mm --voxel-size 1mm -o chip.vox --quiet
"$bin/pointshell" crate.obj --units mm --voxel-size 1mm -o crate.pshell --quiet
plan 2 chip.vox crate.pshell --clearance 1mm --time 1s -o no.csv
errs '--seat: chip lies inside the part at this pose; bake the scene without that object'

finish
