#!/usr/bin/env bash
# voxplan and study with meshes: a clip of thin sheet leaves its tab where the meshes let it, whatever its shell points
# feel; the search goes on where the meshes refuse a path; a part that is caged in does not come out.
source "$FORCELAYER_SOURCE_DIR/tests/support/command_test.sh"

# A clip over a tab, both 1.5 mm thick with 0.1 mm of air between them: it lifts off, up to z. In `caged` it cannot.
PYTHONPATH=$FORCELAYER_SOURCE_DIR/tests/support PYTHONDONTWRITEBYTECODE=1 python3 - <<'END'
from boxes import boxes
t, g = 1.5, 0.1
a = t / 2 + g
tab = (-t / 2, -30, -60), (t / 2, 30, 0)
boxes("tab.obj", tab)
with open("clip.obj", "w") as obj:  # one solid
    outline = [(-a - t, -20), (-a, -20), (-a, g), (a, g), (a, -20), (a + t, -20), (a + t, g + t), (-a - t, g + t)]
    for y in -10, 10:
        for x, z in outline:
            obj.write(f"v {x} {y} {z}\n")
    n = len(outline)
    for i in range(n):
        obj.write(f"f {i + 1} {(i + 1) % n + 1} {(i + 1) % n + 1 + n} {i + 1 + n}\n")
    obj.write("f 1 8 3 2\nf 3 8 7 4\nf 4 7 6 5\n" + "f 9 10 11 16\nf 11 12 15 16\nf 12 13 14 15\n")
low, high = (-a - t - 1, -12, -22), (a + t + 1, 12, 4)
w = 0.4
walls = []
for axis in range(3):
    for side in range(2):
        box = [[l - w for l in low], [h + w for h in high]]
        box[1 - side][axis] = (low[axis] if side == 0 else box[1][axis]) if side == 0 else box[1 - side][axis]
        if side == 0:
            box[1][axis] = low[axis]
        else:
            box[0][axis] = high[axis]
        walls.append(tuple(map(tuple, box)))
boxes("cage.obj", *walls)
END
# Both in one assembly, as glTF: its y is up.
python3 - <<'END'
import base64, json, struct
def mesh(name):
    corners, faces = [], []
    for line in open(name):
        kind, *words = line.split()
        if kind == "v":
            x, y, z = map(float, words)
            corners.append((x / 1e3, z / 1e3, -y / 1e3))
        else:
            numbers = [int(word) if int(word) > 0 else len(corners) + 1 + int(word) for word in words]
            faces += [[n - 1 for n in (numbers[0], numbers[i], numbers[i + 1])] for i in range(1, len(numbers) - 1)]
    return corners, faces
data, gltf = b"", {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"name": "Rig", "children": [1, 2]}],
                   "meshes": [], "accessors": [], "bufferViews": []}
for name, (corners, faces) in ("Tab", mesh("tab.obj")), ("Clip", mesh("clip.obj")):
    points = b"".join(struct.pack("<3f", *c) for c in corners)
    numbers = b"".join(struct.pack("<3I", *f) for f in faces)
    view = len(gltf["bufferViews"])
    gltf["bufferViews"] += [{"buffer": 0, "byteOffset": len(data), "byteLength": len(points)},
                            {"buffer": 0, "byteOffset": len(data) + len(points), "byteLength": len(numbers)}]
    data += points + numbers
    low, high = [list(f(c[a] for c in corners) for a in range(3)) for f in (min, max)]
    gltf["accessors"] += [{"bufferView": view, "componentType": 5126, "count": len(corners), "type": "VEC3", "min": low, "max": high},
                          {"bufferView": view + 1, "componentType": 5125, "count": 3 * len(faces), "type": "SCALAR"}]
    gltf["nodes"].append({"name": name, "mesh": len(gltf["meshes"])})
    gltf["meshes"].append({"primitives": [{"attributes": {"POSITION": view}, "indices": view + 1}]})
gltf["buffers"] = [{"byteLength": len(data), "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}]
json.dump(gltf, open("rig.gltf", "w"))
END
# plan STATUS ARGUMENTS...
plan() {
  local wanted=$1 status=0
  shift
  "$bin/voxplan" "$@" >out.txt 2>err.txt || status=$?
  [ "$status" -eq "$wanted" ] || fail "status $status instead of $wanted: $*: $(cat out.txt err.txt)"
}
"$bin/voxelize" tab.obj --units mm --voxel-size 1mm -o tab.vox --quiet
"$bin/pointshell" clip.obj --units mm --voxel-size 1mm -o clip.pshell --quiet
meshes=(--exact tab.obj --part clip.obj --units mm)
plan 0 tab.vox clip.pshell --clearance 2mm "${meshes[@]}" --threads 2 -o up.csv --json up.json
grep -q '^  in contact, no surface passes through another: this was checked with the meshes$' out.txt || fail "$(cat out.txt)"
python3 - <<'END' || fail "not straight up: $(cat up.csv)"
import json
assert json.load(open("up.json"))["settled_by"] == "meshes"
rows = [[float(cell) for cell in line.split(",")] for line in open("up.csv").read().splitlines()[1:]]
until = json.load(open("up.json"))["seated"][0]["to_s"]
for row in rows:
    if row[0] <= until:
        assert max(map(abs, row[1:3] + row[5:])) < 1e-9, row
assert max(row[3] for row in rows) > 0.022, rows
END
"$bin/voxcheck" tab.vox clip.pshell up.csv --clearance 2mm --seat 0,0,0m "${meshes[@]}" --quiet || fail "by the meshes"
plan 0 tab.vox clip.pshell --clearance 2mm "${meshes[@]}" --threads 1 -o again.csv --quiet
cmp up.csv again.csv || fail "the same seed, another path"

# In a cage of sheet of 0.4 mm, through which shell points of 1 mm voxels go, it stays.
"$bin/voxelize" tab.obj cage.obj --units mm --voxel-size 1mm --free-seed 2.9mm,0,-10mm -o caged.vox --quiet
plan 6 caged.vox clip.pshell --clearance 0.2mm --exact tab.obj --exact cage.obj --part clip.obj --units mm --time 3s -o no.csv
[ ! -e no.csv ] && grep -q 'no path found' err.txt || fail "$(cat out.txt err.txt)"

# A pin that touches its bore all around, along 40 voxels of 0.5 mm: it slides straight up in a few seconds. Below a stop
# it slides for 7 mm, and the stop is what blocks it, not the bore.
PYTHONPATH=$FORCELAYER_SOURCE_DIR/tests/support PYTHONDONTWRITEBYTECODE=1 python3 - <<'END'
from boxes import boxes
boxes("pin.obj", ((-2, -2, 0), (2, 2, 20)))
boxes("bore.obj", ((-8, -8, 0), (-2, 8, 20)), ((2, -8, 0), (8, 8, 20)), ((-2, -8, 0), (2, -2, 20)), ((-2, 2, 0), (2, 8, 20)),
      ((-8, -8, -6), (8, 8, 0)))
boxes("stop.obj", ((-8, -8, 27), (8, 8, 30)))
END
"$bin/voxelize" bore.obj --units mm --voxel-size 0.5mm -o bore.vox --quiet
"$bin/voxelize" bore.obj stop.obj --units mm --voxel-size 0.5mm -o stopped.vox --quiet
"$bin/pointshell" pin.obj --units mm --voxel-size 0.5mm -o pin.pshell --quiet
plan 0 bore.vox pin.pshell --clearance 0.5mm --exact bore.obj --part pin.obj --units mm --threads 2 -o pin.csv
grep -q '^Comes out, .*+z: slides along bore for the first 20' out.txt || fail "$(cat out.txt)"
plan 6 stopped.vox pin.pshell --clearance 0.5mm --exact bore.obj --exact stop.obj --part pin.obj --units mm --time 4s -o no.csv
grep -qE 'no path found: straight along x, y and z it gets at most 6\.5 mm far \(along \+z\), and a search of [0-9.]+ s found no other way \(0\.5 mm of clearance required\); blocked by bore and stop;' err.txt || fail "$(cat err.txt)"

# Where only the clearance is missing, it says how near the part comes.
PYTHONPATH=$FORCELAYER_SOURCE_DIR/tests/support PYTHONDONTWRITEBYTECODE=1 python3 - <<'END'
from boxes import boxes
boxes("peg.obj", ((-5, -5, 0), (5, 5, 10)))
boxes("pot.obj", ((-9, -9, -3), (9, 9, 0)), ((-9, -9, 0), (-8, 9, 20)), ((8, -9, 0), (9, 9, 20)), ((-8, -9, 0), (8, -8, 20)), ((-8, 8, 0), (8, 9, 20)),
      ((-9, -9, 20), (-5.25, 9, 22)), ((5.25, -9, 20), (9, 9, 22)), ((-5.25, -9, 20), (5.25, -5.25, 22)), ((-5.25, 5.25, 20), (5.25, 9, 22)))
END
"$bin/voxelize" pot.obj --units mm --voxel-size 0.5mm -o pot.vox --quiet
"$bin/pointshell" peg.obj --units mm --voxel-size 0.5mm -o peg.pshell --quiet
plan 6 pot.vox peg.pshell --clearance 0.5mm --exact pot.obj --part peg.obj --units mm --time 4s -o no.csv --json near.json
grep -qE 'no path found: straight along x, y and z it gets at most 9\.[0-9]+ mm far \(along \+z\), and ' err.txt || fail "$(cat err.txt)"
grep -q '"straight along +z it meets nothing, but comes as near as 0\.2[45][0-9]* mm to pot"' near.json &&
  grep -q 'along +z: after 9\.[0-9]* mm, pot is nearer than required"' near.json || fail "$(cat near.json)"
plan 0 pot.vox peg.pshell --clearance 0.2mm --exact pot.obj --part peg.obj --units mm --time 20s -o out.csv

# A part that comes out straight has a straight path: in an oblique bore, whose axis no axis of the world is; past a post beside
# the exit, from which a wider path would bend away; and where only the meshes prove the way along an axis.
PYTHONPATH=$FORCELAYER_SOURCE_DIR/tests/support PYTHONDONTWRITEBYTECODE=1 python3 - <<'END'
import math
from bore import bore
from boxes import boxes
bore()
boxes("post.obj", ((13, -5, 45), (16, 5, 80)), ((13, -5, -160), (16, 5, -150)))
axis, angle = [x / math.sqrt(14) for x in (1, 2, 3)], 0.7
def turned(p):
    along = sum(a * b for a, b in zip(axis, p))
    across = [axis[n - 2] * p[n - 1] - axis[n - 1] * p[n - 2] for n in range(3)]
    return [math.cos(angle) * p[n] + math.sin(angle) * across[n] + (1 - math.cos(angle)) * along * axis[n] for n in range(3)]
for name in "pin", "plate":
    with open(f"oblique_{name}.obj", "w") as obj:
        for line in open(name + ".obj").read().splitlines():
            kind, *words = line.split()
            obj.write(" ".join([kind, *("%.9g" % x for x in turned([float(word) for word in words]))] if kind == "v" else [line]) + "\n")
boxes("part.obj", ((-5, -5, -5), (5, 5, 5)))
# A room with one way out, with 1.3 mm of air at each side, of which voxels of 2 mm prove less than 1 mm.
boxes("room.obj", ((-25, -25, -25), (25, 25, -20)), ((-25, -25, -20), (-20, 25, 15)), ((20, -25, -20), (25, 25, 15)),
      ((-20, -25, -20), (20, -20, 15)), ((-20, 20, -20), (20, 25, 15)), ((-25, -25, 15), (-6.3, 25, 40)),
      ((6.3, -25, 15), (25, 25, 40)), ((-6.3, -25, 15), (6.3, -6.3, 40)), ((-6.3, 6.3, 15), (6.3, 25, 40)))
END
# straight VOXEL DIRECTION PART SCENE...
straight() {
  local size=$1 direction=$2 part=$3 exact=() file
  shift 3
  for file in "$@"; do exact+=(--exact "$file"); done
  "$bin/voxelize" "$@" --units mm --voxel-size "$size" -o straight.vox --quiet
  "$bin/pointshell" "$part" --units mm --voxel-size "$size" -o straight.pshell --quiet
  plan 0 straight.vox straight.pshell --clearance 1mm "${exact[@]}" --part "$part" --units mm --time 30s --threads 2 -o straight.csv
  grep -q "^Comes out, straight along $direction: " out.txt || fail "not straight along $direction: $(cat out.txt)"
}
straight 1mm '(0\.39, -0\.07, 0\.92)' oblique_pin.obj oblique_plate.obj
straight 1mm +z pin.obj plate.obj post.obj
straight 2mm +z part.obj room.obj

# A study searches by the meshes, and its verdict is theirs.
"$bin/forcelayer" study 'rig.gltf#Clip' --voxel-size 1mm --clearance 2mm -o study >out.txt 2>err.txt ||
  fail "the study: $(cat out.txt err.txt)"
grep -q '^\$ voxplan .*--exact rig.gltf --part .rig.gltf#Clip. --without Clip' out.txt || fail "no meshes: $(cat out.txt)"
grep -qE '^Comes out, .*: passes .* with a gap of .*, otherwise stays .* away or more \(measured to ' study/verdict.txt || fail "$(cat study/verdict.txt)"

# Two open meshes that meet: the meshes settle nothing, and it is said at once.
python3 - <<'END'
with open("sheet.obj", "w") as obj:
    obj.write("v -30 -30 0\nv 30 -30 0\nv 0 30 0\nf 1 2 3\n")
with open("tray.obj", "w") as obj:
    for n in range(8):
        obj.write("v %g %g %g\n" % tuple(((-6, -6, 0), (6, 6, 12))[n >> axis & 1][axis] for axis in range(3)))
    for face in (1, 3, 4, 2), (1, 2, 6, 5), (3, 7, 8, 4), (1, 5, 7, 3), (2, 4, 8, 6):
        obj.write("f %d %d %d %d\n" % face)
END
"$bin/voxelize" sheet.obj --units mm --voxel-size 1mm -o sheet.vox --quiet
"$bin/pointshell" tray.obj --units mm --voxel-size 1mm -o tray.pshell --quiet
plan 6 sheet.vox tray.pshell --clearance 1mm --exact sheet.obj --part tray.obj --units mm --time 60s -o no.csv
grep -q 'the meshes prove a path only if the part or the touched object is closed; close all open edges of one of these meshes' err.txt || fail "$(cat err.txt)"

plan 2 tab.vox clip.pshell --exact tab.obj -o x.csv
grep -q '^voxplan: --part: is missing' err.txt || fail "$(cat err.txt)"
plan 2 tab.vox clip.pshell --seat-depth 1mm -o x.csv
grep -q '^voxplan: --seat-depth: has no effect without --exact' err.txt || fail "$(cat err.txt)"
plan 4 tab.vox clip.pshell --clearance 2mm --exact clip.obj --part clip.obj --units mm -o x.csv
grep -q 'was not baked from these meshes' err.txt || fail "$(cat err.txt)"
[ ! -e x.csv ] || fail "x.csv is there"

finish
