"""Writers of mesh files: STL, OBJ, PLY, OFF in millimetres, glTF binary in metres."""

import json
import struct


def _number(value):
    return f"{value:.4f}".rstrip("0").rstrip(".")


def write_stl(path, solid):
    """Binary STL, facet normals left zero as many exporters do."""
    data = [b"millimetres".ljust(80), struct.pack("<I", len(solid.triangles))]
    for triangle in solid.triangles:
        corners = [c for n in triangle for c in solid.vertices[n]]
        data.append(struct.pack("<12fH", 0, 0, 0, *corners, 0))
    path.write_bytes(b"".join(data))


def write_obj(path, solid, name):
    lines = ["# millimetres", f"o {name}"]
    lines += ["v " + " ".join(_number(c) for c in v) for v in solid.vertices]
    lines += ["f " + " ".join(str(n + 1) for n in t) for t in solid.triangles]
    path.write_text("\n".join(lines) + "\n", encoding="ascii")


def write_off(path, solid):
    lines = ["OFF", f"{len(solid.vertices)} {len(solid.triangles)} 0"]
    lines += [" ".join(_number(c) for c in v) for v in solid.vertices]
    lines += ["3 " + " ".join(str(n) for n in t) for t in solid.triangles]
    path.write_text("\n".join(lines) + "\n", encoding="ascii")


def write_ply(path, solid):
    """Binary little-endian PLY."""
    header = "\n".join([
        "ply", "format binary_little_endian 1.0", "comment millimetres",
        f"element vertex {len(solid.vertices)}", "property float x", "property float y",
        "property float z", f"element face {len(solid.triangles)}",
        "property list uchar int vertex_indices", "end_header"]) + "\n"
    data = [header.encode("ascii")]
    data += [struct.pack("<3f", *v) for v in solid.vertices]
    data += [struct.pack("<B3i", 3, *t) for t in solid.triangles]
    path.write_bytes(b"".join(data))


def _y_up(vector):
    """A vector of the world, which is z up, in the axes of glTF, which is y up."""
    x, y, z = vector
    return [x, z, 0 - y]


class GlbScene:
    """A glTF 2.0 binary: named meshes and a tree of named nodes. Metres. All is given z up."""

    def __init__(self):
        self._binary = bytearray()
        self._gltf = {"asset": {"version": "2.0", "generator": "make_sample_data.py"}, "scene": 0,
                      "scenes": [{"nodes": []}], "nodes": [], "meshes": [], "accessors": [],
                      "bufferViews": []}

    def _view(self, data, target):
        self._gltf["bufferViews"].append(
            {"buffer": 0, "byteOffset": len(self._binary), "byteLength": len(data),
             "target": target})
        self._binary += data + bytes(-len(data) % 4)
        return len(self._gltf["bufferViews"]) - 1

    def _accessor(self, **fields):
        self._gltf["accessors"].append(fields)
        return len(self._gltf["accessors"]) - 1

    def mesh(self, name, solid):
        """Adds a mesh (given in mm) and returns its index."""
        points = [struct.unpack("<3f", struct.pack("<3f", *_y_up([c / 1000 for c in v])))
                  for v in solid.vertices]
        vertices = self._view(b"".join(struct.pack("<3f", *p) for p in points), 34962)
        indices = self._view(b"".join(struct.pack("<3H", *t) for t in solid.triangles), 34963)
        position = self._accessor(
            bufferView=vertices, componentType=5126, count=len(points), type="VEC3",
            min=[min(p[n] for p in points) for n in range(3)],
            max=[max(p[n] for p in points) for n in range(3)])
        corners = self._accessor(bufferView=indices, componentType=5123, type="SCALAR",
                                 count=3 * len(solid.triangles))
        self._gltf["meshes"].append(
            {"name": name,
             "primitives": [{"attributes": {"POSITION": position}, "indices": corners}]})
        return len(self._gltf["meshes"]) - 1

    def node(self, name, parent=None, **fields):
        """Adds a node (mesh, translation in metres, rotation x y z w, scale); returns its index."""
        if "translation" in fields:
            fields["translation"] = _y_up(fields["translation"])
        if "rotation" in fields:
            fields["rotation"] = [*_y_up(fields["rotation"][:3]), fields["rotation"][3]]
        if "scale" in fields:
            x, y, z = fields["scale"]
            fields["scale"] = [x, z, y]
        nodes = self._gltf["nodes"]
        nodes.append({"name": name, **fields})
        siblings = (self._gltf["scenes"][0]["nodes"] if parent is None
                    else nodes[parent].setdefault("children", []))
        siblings.append(len(nodes) - 1)
        return len(nodes) - 1

    def write(self, path):
        self._gltf["buffers"] = [{"byteLength": len(self._binary)}]
        text = json.dumps(self._gltf, separators=(",", ":")).encode("ascii")
        text += b" " * (-len(text) % 4)
        path.write_bytes(
            struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(self._binary))
            + struct.pack("<I4s", len(text), b"JSON") + text
            + struct.pack("<I4s", len(self._binary), b"BIN\0") + bytes(self._binary))
