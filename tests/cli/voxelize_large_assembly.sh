#!/usr/bin/env bash
# A generated assembly of 2000 parts, nested, half of them mirrored, each mesh placed 50 times: names, places and counts
# agree with the file, which the test reads by itself, and the voxels with those of the same triangles as one mesh.
set -u
source "$FORCELAYER_SOURCE_DIR/tests/support/command_test.sh"
PYTHONDONTWRITEBYTECODE=1 python3 "$FORCELAYER_SOURCE_DIR/scripts/make_large_assembly.py" . 12 || exit 1

"$bin/voxelize" --list assembly.glb --json list.json --quiet || fail "list"
python3 - <<'PYTHON' || fail "the list differs from the file"
import collections, json, struct

data = open("assembly.glb", "rb").read()
text_bytes = struct.unpack_from("<I", data, 12)[0]
gltf = json.loads(data[20:20 + text_bytes])
binary = data[28 + text_bytes:]
places, meshes_used = {}, collections.Counter()  # path to list of (triangles, low, high)

def points_of(mesh):
    accessor = gltf["accessors"][gltf["meshes"][mesh]["primitives"][0]["attributes"]["POSITION"]]
    start = gltf["bufferViews"][accessor["bufferView"]]["byteOffset"]
    return list(struct.iter_unpack("<3f", binary[start:start + 12 * accessor["count"]]))

def triangles_of(mesh):
    return gltf["accessors"][gltf["meshes"][mesh]["primitives"][0]["indices"]]["count"] // 3

points = [points_of(mesh) for mesh in range(len(gltf["meshes"]))]

def visit(index, above, chain, used):
    node = gltf["nodes"][index]
    label, number = node["name"], 1
    while label in used:
        number += 1
        label = f'{node["name"]}[{number}]'
    used.add(label)
    path = above + [label]
    chain = [node] + chain
    if "mesh" in node:
        meshes_used[node["mesh"]] += 1
        low, high = [1e9] * 3, [-1e9] * 3
        for point in points[node["mesh"]]:
            for step in chain:  # the node's own placing first
                scale, move = step.get("scale", (1, 1, 1)), step.get("translation", (0, 0, 0))
                point = [p * s + t for p, s, t in zip(point, scale, move)]
            point = [point[0], -point[2], point[1]]  # glTF is y up, the world z up
            low, high = list(map(min, low, point)), list(map(max, high, point))
        for n in range(1, len(path) + 1):
            places.setdefault("/".join(path[:n]), []).append((triangles_of(node["mesh"]), low, high))
    below = set()
    for child in node.get("children", []):
        visit(child, path, chain, below)

roots = set()
for root in gltf["scenes"][0]["nodes"]:
    visit(root, [], [], roots)
assert set(meshes_used.values()) == {50} and sum(meshes_used.values()) == 2000, meshes_used
assert any(n.get("scale") == [1, 1, -1] for n in gltf["nodes"])

listed = json.load(open("list.json"))["files"][0]
assert listed["whole"]["instances"] == 2000, listed["whole"]
nodes = {n["node"]: n for n in listed["nodes"]}
assert len(nodes) == len(listed["nodes"]) and set(nodes) == set(places), set(nodes) ^ set(places)
for path, below in places.items():
    node = nodes[path]
    assert node["instances"] == len(below), (path, node)
    assert node["triangles"] == sum(t for t, _, _ in below), (path, node)
    assert node["closed"], path
    for key, pick, corner in (("low_m", min, 1), ("high_m", max, 2)):
        expected = [pick(place[corner][axis] for place in below) for axis in range(3)]
        assert all(abs(a - b) < 1e-9 for a, b in zip(node[key], expected)), (path, key, node[key], expected)
PYTHON

"$bin/voxelize" assembly.glb --voxel-size 5mm -o tree.vox --json tree.json >out 2>err || fail "bake: $(cat err)"
"$bin/voxelize" flat.ply --units mm --voxel-size 5mm -o flat.vox --json flat.json >out 2>err || fail "flat: $(cat err)"
"$bin/voxelize" assembly.glb --without 'level_[0-3]' --voxel-size 5mm -o no.vox 2>err && fail "brackets are no wildcard"
"$bin/voxelize" assembly.glb --without 'right' --voxel-size 5mm -o no.vox 2>err
grep -q "several nodes have this name; use one of: rack/level_0/right, rack/level_1/right" err || fail "$(cat err)"
"$bin/voxelize" assembly.glb --without 'level_?/right' --without '{level_1,level_2,level_3,level_4}' --voxel-size 5mm \
  -o half.vox --json half.json --quiet || fail "half a level"
python3 - <<'PYTHON' || fail "voxels"
import json
tree, flat, half = (json.load(open(n + ".json")) for n in ("tree", "flat", "half"))
assert len(tree["parts"]) == 2000 and len(half["parts"]) == 200
assert len({p["name"] for p in tree["parts"]}) == 2000
assert tree["triangles"] == flat["triangles"]
assert tree["dims"] == flat["dims"] and tree["origin_voxel"] == flat["origin_voxel"]
# Vertices are rounded to 32 bits in the frame of each mesh, or of the whole.
for key, count in tree["counts"].items():
    assert abs(count - flat["counts"][key]) <= 1e-3 * count, (key, tree["counts"], flat["counts"])
PYTHON
finish
