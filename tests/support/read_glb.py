"""Reads GLB files with nothing but the standard library, as a second reader beside that of the commands."""
import json
import math
import struct

SIZES = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}
KINDS = {5121: "B", 5123: "H", 5125: "I", 5126: "f"}


class Glb:
    def __init__(self, path):
        data = open(path, "rb").read()
        magic, version, size, json_size, kind = struct.unpack_from("<4sIII4s", data)
        assert (magic, version, size, kind) == (b"glTF", 2, len(data), b"JSON"), (magic, version, size, kind)
        self.json = json.loads(data[20:20 + json_size])
        bin_size, kind = struct.unpack_from("<I4s", data, 20 + json_size)
        self.bytes = data[28 + json_size:]
        assert kind == b"BIN\0" and len(self.bytes) == bin_size == self.json["buffers"][0]["byteLength"]
        assert all(size % 4 == 0 for size in (json_size, bin_size))

    def rows(self, number):
        """The numbers of an accessor, as tuples."""
        accessor = self.json["accessors"][number]
        view = self.json["bufferViews"][accessor["bufferView"]]
        width, kind = SIZES[accessor["type"]], KINDS[accessor["componentType"]]
        layout = f"<{width}{kind}"
        assert accessor["count"] * struct.calcsize(layout) == view["byteLength"]
        rows = [struct.unpack_from(layout, self.bytes, view["byteOffset"] + i * struct.calcsize(layout))
                for i in range(accessor["count"])]
        for axis in range(width):
            for key, extreme in ("min", min), ("max", max):
                assert key not in accessor or accessor[key][axis] == extreme(row[axis] for row in rows)
        return rows

    def node(self, name):
        [number] = [n for n, node in enumerate(self.json["nodes"]) if node.get("name") == name]
        return number

    def names(self):
        """Names of the nodes with a mesh, in their order."""
        return [node["name"] for node in self.json["nodes"] if "mesh" in node]

    def triangles(self, name):
        """Vertices (as the node has them) and triangles of a node's mesh."""
        [primitive] = self.json["meshes"][self.json["nodes"][self.node(name)]["mesh"]]["primitives"]
        vertices = self.rows(primitive["attributes"]["POSITION"])
        numbers = [row[0] for row in self.rows(primitive["indices"])]
        assert max(numbers) == len(vertices) - 1 and len(numbers) % 3 == 0
        return vertices, [numbers[i:i + 3] for i in range(0, len(numbers), 3)]

    def pose(self, name, time_s):
        """Position and rotation (x, y, z, w) of a node at a time of the only animation."""
        [animation] = self.json["animations"]
        at = {}
        for channel in animation["channels"]:
            assert channel["target"]["node"] == self.node(name)
            sampler = animation["samplers"][channel["sampler"]]
            assert sampler["interpolation"] == "LINEAR"
            times = [row[0] for row in self.rows(sampler["input"])]
            assert times[0] == 0 and all(a < b for a, b in zip(times, times[1:])), times
            values = self.rows(sampler["output"])
            last = max([n for n, time in enumerate(times) if time <= time_s], default=0)
            if last + 1 == len(times):
                at[channel["target"]["path"]] = values[last]
                continue
            part = (time_s - times[last]) / (times[last + 1] - times[last])
            blend = slerp if channel["target"]["path"] == "rotation" else lerp
            at[channel["target"]["path"]] = blend(values[last], values[last + 1], part)
        return at["translation"], at["rotation"]

    def placed(self, name, time_s):
        """The vertices of the moving node in the world, z up where the node "world" turns it."""
        position, (x, y, z, w) = self.pose(name, time_s)
        placed = []
        for v in self.triangles(name)[0]:
            t = [2 * (y * v[2] - z * v[1]), 2 * (z * v[0] - x * v[2]), 2 * (x * v[1] - y * v[0])]
            placed.append((position[0] + v[0] + w * t[0] + y * t[2] - z * t[1],
                           position[1] + v[1] + w * t[1] + z * t[0] - x * t[2],
                           position[2] + v[2] + w * t[2] + x * t[1] - y * t[0]))
        return placed


def lerp(a, b, part):
    return tuple(x + (y - x) * part for x, y in zip(a, b))


def slerp(a, b, part):
    cosine = sum(x * y for x, y in zip(a, b))
    if cosine < 0:
        b, cosine = tuple(-y for y in b), -cosine
    angle = math.acos(min(1.0, cosine))
    if angle < 1e-6:
        return lerp(a, b, part)
    return tuple((math.sin((1 - part) * angle) * x + math.sin(part * angle) * y) / math.sin(angle)
                 for x, y in zip(a, b))
