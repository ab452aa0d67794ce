#!/usr/bin/env bash
# The space that a part sweeps along a path: baked, exported as a closed surface, and refused without leftovers.
set -u
source "$FORCELAYER_SOURCE_DIR/tests/support/command_test.sh"

# refuse STATUS TEXT COMMAND...: ends with STATUS and one line on stderr that holds TEXT, and leaves no new file.
refuse() {
  local status=$1 text=$2 before got
  shift 2
  before=$(ls -A)
  "$bin/$1" "${@:2}" >"$work.out" 2>"$work.err"
  got=$?
  [ $got = "$status" ] || fail "status $got instead of $status: $*: $(cat "$work.err")"
  [ "$(wc -l <"$work.err")" = 1 ] && grep -qF -- "$text" "$work.err" || fail "no '$text': $*: $(cat "$work.err")"
  [ "$(ls -A)" = "$before" ] || fail "files were left behind by $*: $(ls -A)"
  rm -f "$work.out" "$work.err"
}

# The part of the sample data is lifted. The same path with a quarter turn takes more poses.
part=("$data/part.obj" --units mm --voxel-size 2mm)
"$bin/voxelize" "${part[@]}" --along "$data/lift.csv" -o lifted.vox >out || fail "--along: $(cat out)"
grep -q '^along .*lift.csv: 2 poses, at most 0.0[0-9]* mm from the motion$' out || fail "poses of a straight path: $(cat out)"
"$bin/voxinfo" verify lifted.vox --quiet || fail "verify"
printf '%s\n' t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz 0,0,0,0,1,0,0,0 1,30,10,40,0.70710678,0,0,0.70710678 >turn.csv
"$bin/voxelize" "${part[@]}" --along turn.csv -o turned.vox >out || fail "--along turn.csv: $(cat out)"
"$bin/voxelize" "${part[@]}" -o still.vox --quiet || fail "the part"
for ending in stl ply glb; do
  "$bin/voxinfo" export turned.vox turned.$ending --quiet || fail "$ending"
  "$bin/voxinfo" export turned.vox turned.$ending --quiet || fail "$ending is not replaced"
done
grep -aq '"name": *"solid"' turned.glb || fail "the name of the node"
"$bin/voxinfo" export turned.vox keep_out.ply --offset 4mm || fail "--offset"
"$bin/voxinfo" export lifted.vox lifted.ply || fail lifted.ply
python3 - "$FORCELAYER_SOURCE_DIR" "$data" <<'PYTHON' || fail "the exported surfaces"
import json, math, random, re, struct, sys
sys.path.insert(0, sys.argv[1] + "/tests/support")

def stl(path):
    data = open(path, "rb").read()
    [count] = struct.unpack_from("<I", data, 80)
    assert len(data) == 84 + 50 * count
    numbers, triangles = {}, []
    for n in range(count):
        v = struct.unpack_from("<12f", data, 84 + 50 * n)[3:]
        triangles.append([numbers.setdefault(v[i:i + 3], len(numbers)) for i in (0, 3, 6)])
    return list(numbers), triangles

def ply(path):
    head, body = open(path, "rb").read().split(b"end_header\n", 1)
    vertices, faces = (int(n) for n in re.findall(rb"element \w+ (\d+)", head))
    points = list(struct.iter_unpack("<3d", body[:24 * vertices]))
    triangles = [list(t[1:]) for t in struct.iter_unpack("<B3i", body[24 * vertices:])]
    assert len(triangles) == faces
    return points, triangles

def glb(path):
    data = open(path, "rb").read()
    [length] = struct.unpack_from("<I", data, 12)
    document, binary = json.loads(data[20:20 + length]), data[28 + length:]
    assert "animations" not in document
    def values(accessor, kinds):
        a = document["accessors"][accessor]
        view = document["bufferViews"][a["bufferView"]]
        size = {"VEC3": 3, "SCALAR": 1}[a["type"]] * a["count"]
        return struct.unpack_from(f"<{size}{kinds[a['componentType']]}", binary, view["byteOffset"])
    primitive = document["meshes"][0]["primitives"][0]
    p = values(primitive["attributes"]["POSITION"], {5126: "f"})
    i = values(primitive["indices"], {5123: "H", 5125: "I"})
    return [p[n:n + 3] for n in range(0, len(p), 3)], [list(i[n:n + 3]) for n in range(0, len(i), 3)]

def check_closed(points, triangles):
    edges = {(t[n], t[(n + 1) % 3]) for t in triangles for n in range(3)}
    assert len(edges) == 3 * len(triangles) and all((b, a) in edges for a, b in edges)
    volume = 0
    for t in triangles:
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = (points[n] for n in t)
        volume += (ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)) / 6
    assert volume > 0
    return volume

class Inside:
    """Counts crossings along z, among the triangles of columns of 2 mm."""
    def __init__(self, points, triangles):
        self.columns = {}
        for t in triangles:
            corners = [points[n] for n in t]
            x, y = [c[0] // 0.002 for c in corners], [c[1] // 0.002 for c in corners]
            for i in range(int(min(x)), int(max(x)) + 1):
                for j in range(int(min(y)), int(max(y)) + 1):
                    self.columns.setdefault((i, j), []).append(corners)
    def __call__(self, p):
        count = 0
        for corners in self.columns.get((int(p[0] // 0.002), int(p[1] // 0.002)), []):
            a, b, c = ([u - v for u, v in zip(corner, p)] for corner in corners)
            ab, bc, ca = a[0] * b[1] - a[1] * b[0], b[0] * c[1] - b[1] * c[0], c[0] * a[1] - c[1] * a[0]
            up = ab > 0 and bc > 0 and ca > 0
            if (up or (ab < 0 and bc < 0 and ca < 0)) and (bc * a[2] + ca * b[2] + ab * c[2]) / (ab + bc + ca) > 0:
                count += 1 if up else -1
        return count == 1

vertices, faces = [], []
for line in open(sys.argv[2] + "/part.obj"):
    words = line.split()
    if words[:1] == ["v"]:
        vertices.append([float(w) / 1e3 for w in words[1:4]])
    if words[:1] == ["f"]:
        faces.append([int(w.split("/")[0]) - 1 for w in words[1:4]])
def centroid():
    volume, sums = 0, [0, 0, 0]
    for f in faces:
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = (vertices[n] for n in f)
        piece = ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)
        volume += piece
        sums = [s + piece * sum(corner) / 4 for s, corner in zip(sums, zip((ax, ay, az), (bx, by, bz), (cx, cy, cz)))]
    return [s / volume for s in sums]
center = centroid()
def place(p, f):  # turn.csv at a fraction of its way: the centroid goes straight
    def about(angle, v):
        return [math.cos(angle) * v[0] - math.sin(angle) * v[1], math.sin(angle) * v[0] + math.cos(angle) * v[1], v[2]]
    end = [t + c for t, c in zip((0.03, 0.01, 0.04), about(math.pi / 2, center))]
    arm = about(f * math.pi / 2, [u - v for u, v in zip(p, center)])
    return [(1 - f) * a + f * b + r for a, b, r in zip(center, end, arm)]
def samples(count):
    for _ in range(count):
        a, b, c = (vertices[n] for n in random.choice(faces))
        u, v = sorted((random.random(), random.random()))
        yield [u * x + (v - u) * y + (1 - v) * z for x, y, z in zip(a, b, c)]

random.seed(7)
surface = ply("turned.ply")
volume = check_closed(*surface)
assert abs(check_closed(*stl("turned.stl")) - volume) < 1e-3 * volume
assert abs(check_closed(*glb("turned.glb")) - volume) < 1e-3 * volume
inside = Inside(*surface)
assert all(inside(place(p, random.random())) for p in samples(3000))
assert not inside(place(center, 0.5)[:2] + [0.5])
larger = Inside(*ply("keep_out.ply"))
for p in samples(1000):
    direction = [random.gauss(0, 1) for _ in range(3)]
    length = math.sqrt(sum(d * d for d in direction))
    assert larger([x + 0.004 * d / length for x, d in zip(place(p, random.random()), direction)])
check_closed(*ply("lifted.ply"))
PYTHON

# One mesh of two cubes, the smaller one inside out: the center about which it turns is known too badly for a quarter
# turn, and well enough for small turns.
python3 - >unlike.obj <<'PYTHON'
faces = (1, 3, 7, 5), (2, 6, 8, 4), (1, 5, 6, 2), (3, 4, 8, 7), (1, 2, 4, 3), (5, 7, 8, 6)
for x, half, first, step in (0, 10, 0, 1), (100, 5, 8, -1):
    for n in range(8):
        print("v", *[c + (half if n >> d & 1 else -half) for d, c in enumerate((x, 0, 0))])
    for face in faces:
        print("f", *[first + n for n in face[::step]])
PYTHON
"$bin/pointshell" unlike.obj --units mm --voxel-size 2mm -o unlike.pshell --quiet || fail unlike.pshell
"$bin/voxinfo" path turn.csv --resample 10ms --part unlike.pshell -o dense.csv --quiet || fail dense.csv
unlike=(unlike.obj --units mm --voxel-size 2mm)
refuse 2 "turns by up to 90 degrees from row to row" voxelize "${unlike[@]}" --along turn.csv -o unlike.vox --quiet
"$bin/voxelize" "${unlike[@]}" --along dense.csv -o unlike.vox --quiet || fail "a turn in many rows"
"$bin/voxelize" "${unlike[@]}" --along "$data/lift.csv" -o unlike.vox --quiet || fail "a path without turns"

# Refused, with nothing half-written.
printf '%s\n' t_s,x_mm,y_mm,z_mm 0,0,0,0 >one.csv
refuse 2 "one pose" voxelize "${part[@]}" --along one.csv -o one.vox --quiet
refuse 1 "none.csv" voxelize "${part[@]}" --along none.csv -o one.vox --quiet
refuse 2 "cannot be combined with --shard" voxelize "${part[@]}" --along turn.csv --cache cache --shard 1/2
refuse 2 "has no effect with --list" voxelize "${part[@]}" --along turn.csv --list
refuse 2 "is an input" voxelize "${part[@]}" --along turn.csv -o still.vox --json turn.csv --quiet
"$bin/voxelize" "${part[@]}" --kind lean --along turn.csv -o lean.vox --quiet || fail "lean"
"$bin/voxelize" "${part[@]}" --along turn.csv --roi 0,0,0,1m,1m,1m -o cropped.vox --quiet || fail "cropped"
"$bin/pointshell" "${part[@]}" -o part.pshell --quiet || fail "part.pshell"
refuse 2 "stores no distances" voxinfo export lean.vox lean.stl
refuse 2 "is cropped" voxinfo export cropped.vox cropped.stl
refuse 2 "a scene can be exported to .stl" voxinfo export turned.vox turned.dxf
refuse 2 "a part can be exported to .ply" voxinfo export part.pshell part.stl
refuse 2 "applies only to the surface" voxinfo export turned.vox turned.csv --offset 1mm
refuse 2 "an offset of at most" voxinfo export turned.vox large.stl --offset 2m
refuse 2 "must not be negative" voxinfo export turned.vox small.stl --offset -1mm
refuse 1 "no/such" voxinfo export turned.vox no/such.stl
(ulimit -f 100; refuse 1 "cannot be written" voxinfo export turned.vox short.stl; exit $failures) || fail "a full disk"
finish
