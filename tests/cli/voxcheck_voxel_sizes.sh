#!/usr/bin/env bash
# voxcheck by the meshes says the same whatever the voxels of the files.
source "$FORCELAYER_SOURCE_DIR/tests/support/voxcheck_test.sh"
[ -x "$bin/voxcheck-exact" ] || skip "voxcheck was built without FCL"

# A drawer in a slot that coarse voxels leave no room in, so that the bake fills it: by the files it starts too deep in the
# scene, by the meshes it has 0.3 mm of play. One that is stuck 2 mm deep is refused.
PYTHONPATH=$FORCELAYER_SOURCE_DIR/tests/support PYTHONDONTWRITEBYTECODE=1 python3 - <<'END'
import math
from boxes import boxes
def turned(p):  # by one radian about (1, 2, 3)
    n = [c / math.sqrt(14) for c in (1, 2, 3)]
    along = sum(a * b for a, b in zip(n, p))
    aside = n[1] * p[2] - n[2] * p[1], n[2] * p[0] - n[0] * p[2], n[0] * p[1] - n[1] * p[0]
    return tuple(math.cos(1) * p[a] + math.sin(1) * aside[a] + (1 - math.cos(1)) * along * n[a] for a in range(3))
h = 1.9
boxes("slot.obj", ((-12, -15, -7), (12, 15, -h)), ((-12, -15, h), (12, 15, 7)), ((-12, -15, -h), (-9.3, 15, h)), ((9.3, -15, -h), (12, 15, h)))
boxes("drawer.obj", ((-9, -12, 0.3 - h), (9, 12, h - 0.3)))
boxes("stuck.obj", ((-9, -12, -2 - h), (9, 12, h - 0.3)))
for name in "slot", "drawer", "stuck":
    lines = open(name + ".obj").read().splitlines()
    with open(name + ".obj", "w") as obj:
        for line in lines:
            obj.write(("v %.9g %.9g %.9g" % turned(tuple(map(float, line.split()[1:]))) if line[0] == "v" else line) + "\n")
for name, way in ("pulled", (0, 40, 0)), ("lifted", (0, 0, 40)):
    open(name + ".csv", "w").write("t_s,x_mm,y_mm,z_mm\n0,0,0,0\n1,%.9g,%.9g,%.9g\n" % turned(way))
END
for size in 0.8 1.6; do
  "$bin/voxelize" slot.obj --units mm --voxel-size ${size}mm --quiet -o slot.vox
  for name in drawer stuck; do "$bin/pointshell" $name.obj --units mm --voxel-size ${size}mm --quiet -o $name.pshell; done
  seat=(--clearance 1mm --seat 0,0,0m --exact slot.obj --units mm)
  check 0 slot.vox drawer.pshell pulled.csv "${seat[@]}" --part drawer.obj
  says '^Comes out, .*: passes slot with a gap of 0\.(3|299) mm for the first 28 mm'
  check 6 slot.vox drawer.pshell lifted.csv "${seat[@]}" --part drawer.obj
  check 2 slot.vox stuck.pshell pulled.csv "${seat[@]}" --part stuck.obj
  errs '^voxcheck: slot\.vox: --seat: the part starts .* inside slot; the stored distances allow a seat up to '
done
check 2 slot.vox drawer.pshell pulled.csv --clearance 1mm --seat 0,0,0m --felt-seat
errs '; if voxelize reports a cavity at the start pose, bake the scene with --free-seed, --narrow-passages or smaller voxels; if it reports none there, bake'
if [ -x "$bin/voxplan" ]; then
  plan=("$bin/voxplan" slot.vox --clearance 1mm --seat 0,0,0m --exact slot.obj --units mm --quiet --time 20s -o plan.csv)
  "${plan[@]}" drawer.pshell --part drawer.obj || fail "no path for the drawer"
  check 0 slot.vox drawer.pshell plan.csv "${seat[@]}" --part drawer.obj
  "${plan[@]}" stuck.pshell --part stuck.obj 2>err.txt && fail "a path for a part that is stuck"
  errs '^voxplan: slot\.vox: --seat: the part starts .* inside slot; '
fi

# A pin with 0.098 mm of play in its bore: answer and figures are the same whatever the voxels.
python3 - <<'END'
import math
N = 48
def write(name, profile, faces):  # a body of revolution: radius and height of each corner, mm
    with open(name + ".obj", "w") as file:
        for n in range(N):
            for radius, z in profile:
                file.write("v %r %r %r\n" % (radius * math.cos(2 * math.pi * n / N), radius * math.sin(2 * math.pi * n / N), z))
        file.write("v 0 0 %r\nv 0 0 %r\n" % (profile[0][1], profile[-1][1]))
        for n in range(N):
            a, b = n * len(profile), (n + 1) % N * len(profile)
            for i, j in faces:
                file.write("f %d %d %d\n" % (a + i + 1, b + i + 1, b + j + 1) + "f %d %d %d\n" % (a + i + 1, b + j + 1, a + j + 1))
            if len(profile) == 2:
                file.write("f %d %d %d\n" % (N * 2 + 1, b + 1, a + 1) + "f %d %d %d\n" % (N * 2 + 2, a + 2, b + 2))
write("bore", ((6.049, 0), (20, 0), (20, 15), (6.049, 15)), ((0, 1), (1, 2), (2, 3), (3, 0)))
write("pin", ((6, 2), (6, 25)), ((0, 1),))
for name, aside in ("straight", 0), ("leaning", .03), ("touching", .12):
    with open(name + ".csv", "w") as file:
        file.write("t_s,x_mm,y_mm,z_mm\n0,0,0,0\n1,%g,0,30\n" % aside)
END
sizes=(0.5 1 2 3 5)
[ -z "${FORCELAYER_SANITIZED:-}" ] || sizes=(1 5)  # a check takes ten times as long there
for size in "${sizes[@]}"; do
  "$bin/voxelize" bore.obj --units mm --voxel-size ${size}mm --quiet -o bore.vox || fail "bake bore"
  "$bin/pointshell" pin.obj --units mm --voxel-size ${size}mm --quiet -o pin.pshell || fail "bake pin"
  for path in straight leaning touching; do
    for asked in "0mm" "0.04mm" "0.0488mm" "2mm --seat 0,0,0m"; do
      "$bin/voxcheck" bore.vox pin.pshell $path.csv --exact bore.obj --part pin.obj --units mm --clearance $asked \
        --json "play $path $asked $size.json" --quiet >/dev/null 2>&1 || true
    done
  done
done
python3 - ${#sizes[@]} <<'END' || fail "the play depends on the voxels"
import glob, itertools, json, sys
def key(name):
    return name.rsplit(" ", 1)[0]
kinds = {}
for case, names in itertools.groupby(sorted(glob.glob("play *.json"), key=key), key):
    reports = [json.load(open(name)) for name in names]
    assert len(reports) == int(sys.argv[1]), case
    def figures(report):
        seated = "--seat" in case
        worst = report["violations"][0] if report["violations"] else report["seated"][0] if seated else report["min_clearance"]
        return [worst["exact_m"], worst.get("depth_m") or 0] + [deep["deepest_m"] for deep in report.get("seat_depths", [])]
    for report in reports:
        assert report["kind"] == reports[0]["kind"], (case, report["sentence"], reports[0]["sentence"])
        for a, b in zip(figures(report), figures(reports[0])):
            assert abs(a - b) < 2e-6, (case, report["sentence"], reports[0]["sentence"])
    kinds[case[5:]] = reports[0]["kind"]
assert kinds["straight 0.0488mm"] == "keeps the clearance" and kinds["leaning 0.04mm"] == "does not keep the clearance", kinds
assert kinds["touching 0mm"] == "collides" and kinds["touching 2mm --seat 0,0,0m"] == "does not come out", kinds
assert kinds["leaning 2mm --seat 0,0,0m"] == "comes out", kinds
END
finish
