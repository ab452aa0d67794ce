#!/usr/bin/env bash
# No face is lost in silence: for each format but OM the triangles of a file, counted by a script from its text or
# bytes, are those that voxelize bakes.
set -u
source "$FORCELAYER_SOURCE_DIR/tests/support/command_test.sh"
for file in "box.step" "box.igs" "solid.igs solid"; do
  [ ! -x "$bin/make_box_file" ] || "$bin/make_box_file" $file || fail "make_box_file $file"
done
BIN=$bin MODELS=$FORCELAYER_SOURCE_DIR/tests/models python3 - <<'PYTHON' || fail "faces are lost"
import base64, json, os, pathlib, random, re, struct, subprocess, sys

def write(name, data):
    pathlib.Path(name).write_bytes(data if isinstance(data, bytes) else data.encode())
    return name

# A prism over a polygon of seven corners, as polygons: two of seven corners, and seven of four.
rng = random.Random(7)
n = 7
points = [(40 + 30 * x, 40 + 30 * y, z) for z in (0, 25) for x, y in
          ((1, 0), (.7, .7), (0, 1), (-.7, .7), (-1, 0), (-.7, -.7), (.6, -.8))]
faces = [list(range(n))[::-1], list(range(n, 2 * n))] + [[i, (i + 1) % n, n + (i + 1) % n, n + i] for i in range(n)]
triangles = [(f[0], f[k], f[k + 1]) for f in faces for k in range(1, len(f) - 1)]
rng.shuffle(faces)
vertex_lines = lambda: "".join("%g %g %g\n" % p for p in points)
face_lines = lambda: "".join(" ".join(map(str, [len(f), *f])) + "\n" for f in faces)

write("a.obj", "".join("v %g %g %g\n" % p for p in points) + "".join("f " + " ".join(str(i + 1) for i in f) + "\n" for f in faces))
write("a.off", f"OFF\n{len(points)} {len(faces)} 0\n" + vertex_lines() + face_lines())
header = lambda kind: (f"ply\nformat {kind} 1.0\nelement vertex {len(points)}\nproperty float x\nproperty float y\nproperty float z\n"
                       f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n")
write("a.ply", header("ascii") + vertex_lines() + face_lines())
write("b.ply", header("binary_little_endian").encode() + b"".join(struct.pack("<3f", *p) for p in points) +
      b"".join(struct.pack(f"<B{len(f)}i", len(f), *f) for f in faces))
facet = lambda t: "facet normal 0 0 0\nouter loop\n" + "".join("vertex %g %g %g\n" % points[i] for i in t) + "endloop\nendfacet\n"
write("a.stl", "solid a\n" + "".join(map(facet, triangles)) + "endsolid a\n")
write("b.stl", bytes(80) + struct.pack("<I", len(triangles)) +
      b"".join(struct.pack("<12fH", 0, 0, 0, *[c for i in t for c in points[i]], 0) for t in triangles))
buffer = b"".join(struct.pack("<3f", *(1e-3 * c for c in p)) for p in points) + b"".join(struct.pack("<3H", *t) for t in triangles)
place = 12 * len(points)
gltf = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
        "nodes": [{"mesh": 0, "name": "one"}, {"mesh": 0, "name": "two", "translation": [.2, 0, 0]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": len(points), "type": "VEC3"},
                      {"bufferView": 1, "componentType": 5123, "count": 3 * len(triangles), "type": "SCALAR"}],
        "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": place},
                        {"buffer": 0, "byteOffset": place, "byteLength": len(buffer) - place}],
        "buffers": [{"byteLength": len(buffer), "uri": "data:application/octet-stream;base64," + base64.b64encode(buffer).decode()}]}
write("a.gltf", json.dumps(gltf))

def varint(data, at):
    value = shift = 0
    while True:
        value |= (data[at] & 127) << shift
        shift, at = shift + 7, at + 1
        if data[at - 1] < 128:
            return value, at

# The counts: of what stands in the file.
def count(path):
    data = pathlib.Path(path).read_bytes()
    text = data.decode("latin-1")
    kind = pathlib.Path(path).suffix
    if kind == ".obj":
        return sum(len(line.split()) - 3 for line in text.splitlines() if line.startswith("f "))
    if kind == ".off":
        vertices, polygons = map(int, text.split()[1:3])
        return sum(int(line.split()[0]) - 2 for line in text.splitlines()[2 + vertices:2 + vertices + polygons])
    if kind == ".ply":
        polygons = int(re.search(r"element face (\d+)", text)[1])
        body = text.index("end_header\n") + 11
        if "ascii" in text[:40]:
            return sum(int(line.split()[0]) - 2 for line in text[body:].splitlines()[len(points):])
        at, total = body + 12 * len(points), 0
        for _ in range(polygons):
            total, at = total + data[at] - 2, at + 1 + 4 * data[at]
        return total
    if kind == ".stl":
        return text.count("endfacet") or struct.unpack_from("<I", data, 80)[0]
    if kind == ".gltf":
        doc = json.loads(text)
        return sum(doc["accessors"][p["indices"]]["count"] // 3 for node in doc["nodes"] for p in doc["meshes"][node["mesh"]]["primitives"])
    if kind == ".drc":  # Draco 2.2 without metadata: the faces; with edgebreaker a byte and the vertices before them
        assert data[:7] == b"DRACO\x02\x02" and not data[10] & 0x80, path
        return varint(data, varint(data, 12)[1] if data[8] == 1 else 11)[0]
    if kind == ".step":  # faces of a box have two triangles each
        return 2 * len(re.findall(r"ADVANCED_FACE", text))
    faces = [line for line in text.splitlines() if line[72:73] == "D" and int(line[73:80]) % 2 == 1 and int(line[:8]) in (144, 510)]
    return 2 * len(faces)

models = pathlib.Path(os.environ["MODELS"])
files = ["a.obj", "a.off", "a.ply", "b.ply", "a.stl", "b.stl", "a.gltf", *sorted(models.glob("*.stl")),
         *[models / f"{name}.drc" for name in ("bunny", "car", "counter", "dragon")]]
files += [name for name in ("box.step", "box.igs", "solid.igs") if os.path.exists(name)]
lost = []
for path in files:
    units = [] if pathlib.Path(path).suffix in (".step", ".igs", ".gltf") else ["--units", "mm"]
    is_made = not str(path).startswith("/")  # the models are listed only
    what = ["--voxel-size", "5mm", "-o", "a.vox"] if is_made else ["--list"]
    run = subprocess.run([os.environ["BIN"] + "/voxelize", path, *units, *what, "--json", "a.json"], capture_output=True, text=True)
    report = json.load(open("a.json"))
    baked = run.stderr if run.returncode != 0 else report["triangles"] if is_made else report["files"][0]["whole"]["triangles"]
    if baked != count(path):
        lost.append(f"{path}: {count(path)} triangles in the file, {baked} read")
print("\n".join(lost) or f"{len(files)} files, all faces there")
sys.exit(len(lost) > 0)
PYTHON

finish
