#!/usr/bin/env bash
# No face is lost in silence: for each format but OM the triangles of a file, counted from its text or bytes by
# tests/support/face_counts.py, are those that voxelize bakes.
set -u
source "$FORCELAYER_SOURCE_DIR/tests/support/command_test.sh"
for file in "box.step" "box.igs" "solid.igs solid"; do
  [ ! -x "$bin/make_box_file" ] || "$bin/make_box_file" $file || fail "make_box_file $file"
done
BIN=$bin TESTS=$FORCELAYER_SOURCE_DIR/tests python3 - <<'PYTHON' || fail "faces are lost"
import base64, json, os, pathlib, random, struct, subprocess, sys
sys.path.insert(0, os.environ["TESTS"] + "/support")
sys.dont_write_bytecode = True
from face_counts import count

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

# The same with EXT_meshopt_compression, as its specification has it: vertices in groups of 16 whole bytes, indices in sequence.
def packed_vertices(rows):
    zigzag = lambda d: (d << 1 ^ -(d >> 7 & 1)) & 255
    out, last = b"\xa0", rows[0]
    for k in range(12):
        column = [row[k] for row in rows]
        steps = [zigzag(b - a & 255) for a, b in zip([last[k], *column], column)]
        groups = (len(rows) + 15) // 16
        out += b"\xff" * ((groups + 3) // 4) + bytes(steps) + bytes(16 * groups - len(rows))
    return out + bytes(32 - 12) + rows[0]

def packed_indices(indices):
    out, last = b"\xd1", 0
    for index in indices:
        value, last = (index - last << 1 ^ (index - last >> 31)) << 1, index
        while value > 127:
            out, value = out + bytes([value & 127 | 128]), value >> 7
        out += bytes([value])
    return out + bytes(4)

packed = [packed_vertices([struct.pack("<3f", *(1e-3 * c for c in p)) for p in points]), packed_indices([i for t in triangles for i in t])]
for n, (mode, stride, size) in enumerate((("ATTRIBUTES", 12, len(points)), ("INDICES", 4, 3 * len(triangles)))):
    gltf["bufferViews"][n] = {"buffer": 1, "byteLength": stride * size, "extensions": {"EXT_meshopt_compression": {
        "buffer": 0, "byteOffset": len(packed[0]) * n, "byteLength": len(packed[n]), "byteStride": stride, "count": size, "mode": mode}}}
gltf["accessors"][1]["componentType"] = 5125
gltf["buffers"] = [{"byteLength": len(b"".join(packed))}, {"byteLength": 10**4, "extensions": {"EXT_meshopt_compression": {"fallback": True}}}]
gltf["extensionsRequired"] = ["EXT_meshopt_compression"]
text, binary = json.dumps(gltf).encode(), b"".join(packed)
text, binary = text + b" " * (-len(text) % 4), binary + bytes(-len(binary) % 4)
write("meshopt.glb", struct.pack("<4sIII4s", b"glTF", 2, 28 + len(text) + len(binary), len(text), b"JSON") + text +
      struct.pack("<I4s", len(binary), b"BIN\0") + binary)
no_meshopt = subprocess.run([os.environ["BIN"] + "/voxelize", "--list", "meshopt.glb"], capture_output=True, text=True)
no_meshopt = "libmeshoptimizer" in no_meshopt.stderr

models = pathlib.Path(os.environ["TESTS"]) / "models"
files = ["a.obj", "a.off", "a.ply", "b.ply", "a.stl", "b.stl", "a.gltf", *([] if no_meshopt else ["meshopt.glb"]), *sorted(models.glob("*.stl")),
         *[models / f"{name}.drc" for name in ("bunny", "car", "counter", "dragon")]]
files += [name for name in ("box.step", "box.igs", "solid.igs") if os.path.exists(name)]
lost = []
for path in files:
    units = [] if pathlib.Path(path).suffix in (".step", ".igs", ".gltf", ".glb") else ["--units", "mm"]
    is_made = not str(path).startswith("/")  # the models are listed only
    what = ["--voxel-size", "5mm", "-o", "a.vox"] if is_made else ["--list"]
    run = subprocess.run([os.environ["BIN"] + "/voxelize", path, *units, *what, "--json", "a.json"], capture_output=True, text=True)
    report = json.load(open("a.json"))
    baked = run.stderr if run.returncode != 0 else report["triangles"] if is_made else report["files"][0]["whole"]["triangles"]
    there = count(path) * (2 if pathlib.Path(path).suffix in (".step", ".igs") else 1)  # faces of a box
    if baked != there:
        lost.append(f"{path}: {there} triangles in the file, {baked} read")
print("\n".join(lost) or f"{len(files)} files, all faces there")
sys.exit(len(lost) > 0)
PYTHON

finish
