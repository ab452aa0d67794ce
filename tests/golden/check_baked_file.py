#!/usr/bin/env python3
"""Refuses .vox and .pshell files as sections 3 to 6 of voxmap_format.md, and 2 and 3 of pshell_format.md, want it,
written from these alone; says of a file that it accepts what it holds.

    check_baked_file.py FILE...     a line each: `ok DIGEST`, or `no REASON`

DIGEST is a hash of everything that a reader can look up: boxes and voxels of each tree in the directory's order,
names, compliance; points, normals, weights, cones, spheres, losses.
"""
import math
import struct
import sys

import read_baked_file as reader

MASK = (1 << 64) - 1
MOST_INDEX = 1 << 52
RULES = {  # id: element bytes, whether it must be there
    "vox": {1: (4, True), 2: (2048, True), 3: (2048, True), 4: (128, True), 5: (4, False), 6: (1, False),
            7: (4, False), 8: (2048, False), 9: (2048, False), 10: (16, False), 11: (4, False),
            12: (2048, False), 13: (2048, False), 14: (16, False), 15: (1, False), 16: (4, False)},
    "pshell": {**{n: (4, True) for n in range(1, 8)}, 8: (16, True), 9: (16, True), 10: (4, False),
               11: (16, False), 12: (1, False), 13: (1, False)}}


class Refused(Exception):
    pass


def require(holds, what):
    if not holds:
        raise Refused(what)


class Digest:
    def __init__(self):
        self.state = 0xcbf29ce484222325

    def add(self, *numbers):
        for number in numbers:
            self.state = ((self.state ^ (number & MASK)) * 0x100000001b3) & MASK


def read_container(data):
    require(data[:8] in (reader.VOX_MAGIC, reader.PSHELL_MAGIC), "magic")
    kind = "vox" if data[:8] == reader.VOX_MAGIC else "pshell"
    require(len(data) >= 64, "shorter than its first fields")
    own = reader.VOX_HEADER if kind == "vox" else reader.PSHELL_HEADER
    header, _ = reader.read_fields(data[:64].ljust(64, b"\0"), reader.FILE_HEADER)
    require(header["endian_tag"] == 0x01020304, "endian tag")
    require(header["major"] == 2, "major")
    newer = header["minor"] > (0 if kind == "vox" else 1)
    size = 384 if kind == "vox" else 256
    given = header["header_bytes"]
    require(given == size or (newer and size <= given <= 4096 and given % 64 == 0), "header_bytes")
    require(header["section_count"] <= 64, "section_count")
    table_end = given + 32 * header["section_count"]
    require(table_end <= len(data), "table")
    front = data[:48] + bytes(8) + data[56:table_end]
    require(reader.xxhash.xxh3_64_intdigest(front) == header["header_checksum"], "header checksum")
    require(header["file_bytes"] == len(data), "file_bytes")
    require(header["required_features"] == 0, "features")
    header, _ = reader.read_fields(data, reader.FILE_HEADER + own)
    if not newer:
        for name in header:
            require(not name.startswith("reserved") or header[name] in (0, bytes(88), bytes(8)), name)
    rules = dict(RULES[kind])
    if header["minor"] == 0:
        rules.pop(13 if kind == "pshell" else None, None)  # two-sided points came with minor version 1
    sections = read_table(data, given, header["section_count"], rules, newer)
    return kind, header, sections


def read_table(data, at, count, rules, newer):
    sections, last, end = {}, 0, at + 32 * count
    first = True
    for index in range(count):
        number, element, offset, length, checksum = struct.unpack_from("<IIQQQ", data, at + 32 * index)
        require(first or number > last, "section order")
        require(number in rules or newer, "unknown section")
        wanted = rules[number][0] if number in rules else element
        require(element == wanted and element > 0 and length % element == 0, "element size")
        require(offset == (end + 63) // 64 * 64, "placement")
        require(offset <= len(data) and length <= len(data) - offset, "beyond the end")
        require(not any(data[end:offset]), "padding")
        section = data[offset:offset + length]
        require(reader.xxhash.xxh3_64_intdigest(section) == checksum, "section checksum")
        if number in rules:
            sections[number] = section
        last, end, first = number, offset + length, False
    require(end == len(data), "end")
    for number, (_, needed) in rules.items():
        require(not needed or number in sections, "missing section")
    return sections


def finite(x):
    return math.isfinite(x)


def check_scene(h, sections):
    s, metric, k = h["voxel_size_m"], h["metric"], h["offset_layers"]
    require(1e-9 <= s <= 1e6, "voxel_size_m")
    require(metric in (0, 1), "metric")
    zero, depth, quantum = h["zero_force_m"], h["force_depth_m"], h["distance_quantum_m"]
    if metric == 0:
        require(zero == 0 and depth == 0 and quantum == 0, "lengths of the Chebyshev metric")
    else:
        require(finite(zero) and zero > 0 and finite(depth) and 0 < depth <= zero, "lengths")
        require(0 <= quantum <= 1e6, "quantum")
        if k == 0:
            require(quantum > 0, "a standoff without distances")
            require((zero - depth) / s >= 888 / 1024 - 1e-6, "standoff")
    require(1 <= h["distance_zero_code"] <= 254 if quantum > 0 else h["distance_zero_code"] == 0, "zero code")
    require(h["object_count"] <= 65535 and k <= 65535, "counts")
    dims = h["directory_dims"]
    require(all(d <= 1 << 21 for d in dims) and dims[0] * dims[1] * dims[2] <= 1 << 28, "directory")
    require(all(d == 0 for d in dims) or all(d > 0 for d in dims), "directory")
    require(all(o % 512 == 0 and abs(o) <= MOST_INDEX for o in h["directory_origin"]), "directory origin")
    tight = h["dims_voxels"]
    counts = [h["interior_voxels"], h["surface_voxels"], h["proximity_voxels"]]
    empty = tight == [0, 0, 0]
    require(empty or all(d > 0 for d in tight), "dims")
    for axis in range(3):
        low, origin = h["directory_origin"][axis], h["origin_voxel"][axis]
        least, most = h["valid_min_voxel"][axis], h["valid_max_voxel"][axis]
        require(abs(least) <= MOST_INDEX and abs(most) <= MOST_INDEX and least <= most, "valid box")
        if empty:
            require(origin == 0, "origin of an empty map")
        else:
            require(low <= origin and origin + tight[axis] <= low + 512 * dims[axis], "tight box")
            require(least <= origin and origin + tight[axis] <= most, "valid box")
    require(sum(counts) <= tight[0] * tight[1] * tight[2] and (sum(counts) == 0) == empty, "counts")
    require(h["cropped_sides"] < 64, "cropped sides")
    require(finite(h["static_deviation_m"]) and h["static_deviation_m"] >= 0, "deviation")
    check_tree(h, sections, 1, 128, 3, clearances=True)
    check_optional_tree(h, sections, 7, 560, 255, quantum > 0)
    check_optional_tree(h, sections, 11, 1040, h["object_count"], h["object_count"] > 0)
    names = sections.get(15, b"")
    require(names == b"" or names[-1] == 0, "end of names")
    require(names.count(0) == h["object_count"], "names")
    require(sections.get(5, b"") == b"", "newtons")
    check_compliance(h, sections.get(16, b""))


def check_optional_tree(h, sections, first, brick_bytes, most, there):
    if there:
        check_tree(h, sections, first, brick_bytes, most, clearances=False)
    else:
        require(not any(sections.get(n) for n in range(first, first + 4)), "a tree that is not announced")


def check_tree(h, sections, first, brick_bytes, most, clearances):
    """`brick_bytes`: those of a brick; where bricks are packed, the most."""
    levels = [sections.get(first + n, b"") for n in range(4)]
    counts = [len(levels[1]) // 2048, len(levels[2]) // 2048, len(levels[3]) // brick_bytes]
    if first > 1:
        counts[2] = max(0, (len(levels[3]) - brick_bytes) // 16 + 1)
    dims = h["directory_dims"]
    require(len(levels[0]) // 4 == dims[0] * dims[1] * dims[2], "directory size")
    for level, children in zip(levels, counts):
        for (entry,) in struct.iter_unpack("<I", level):
            if not entry >> 31:
                require(entry < children, "child")
            elif clearances:
                require(entry & 0xff <= 3 and (entry & 0xff == 0 or entry >> 8 & 0x7fffff == 0), "value")
            else:
                require(entry & 0xffff <= most and entry >> 16 & 0x7fff == 0, "element")


def check_compliance(h, section):
    if not section:
        return
    quantum = h["distance_quantum_m"]
    require(quantum > 0, "compliance without distances")
    pressures = [pressure for (pressure,) in struct.iter_unpack("<f", section)]
    require((len(pressures) - 1) * quantum <= h["zero_force_m"] + (h["distance_zero_code"] + 1) * quantum, "deep")
    require(pressures[0] == 0 and pressures[-1] > 0, "ends of the compliance")
    for before, after in zip(pressures, pressures[1:]):
        step = struct.unpack("<f", struct.pack("<f", after - before))[0] if finite(after) else math.inf
        require(before <= after <= 1e9 and step <= 1e15 * quantum, "compliance")


def check_shell(h, sections):
    points, block, group = h["point_count"], h["block_points"], h["super_block_blocks"]
    require(1 <= points <= 1 << 31, "point_count")
    require(16 <= block <= 4096 and block % 16 == 0 and 1 <= group <= 4096, "blocks")
    require(h["block_count"] == -(-points // block) and h["super_block_count"] == -(-h["block_count"] // group),
            "block counts")
    for name in ("covering_radius_m", "part_deviation_m", "area_m2", "convex_radius_m", "convex_gap_m",
                 "bounding_radius_m"):
        require(finite(h[name]) and h[name] >= 0, name)
    require(1e-9 <= h["voxel_size_m"] <= 1e6, "voxel_size_m")
    require(h["bounding_radius_m"] <= 2 ** 20 * h["voxel_size_m"], "bounding radius")
    require(all(finite(x) for x in h["center_m"] + h["inertia_m2"]), "center or inertia")
    require(all(x >= 0 for x in h["inertia_m2"][:3]), "inertia")
    require(h["mass_source"] in (0, 1) and h["method"] in (0, 1), "source or method")
    volume = h["volume_m3"]
    require(finite(volume) and (volume > 0 if h["mass_source"] == 0 else volume == 0), "volume")
    stored = h["block_count"] * block
    sizes = {**{n: 4 * stored for n in range(1, 8)}, 8: 16 * h["block_count"], 9: 16 * h["super_block_count"]}
    require(all(len(sections[n]) == size for n, size in sizes.items()), "section sizes")
    require(len(sections.get(10, b"")) in (0, 4 * stored), "cones")
    sides = sections.get(13, b"")
    require(len(sides) in (0, stored) and all(side <= 1 for side in sides), "two-sided points")
    require(all(side == sides[points - 1] for side in sides[points:]), "padding")
    entries = [struct.unpack_from("<2d", sections.get(11, b""), at) for at in range(0, len(sections.get(11, b"")), 16)]
    require(len(entries) <= 256, "losses")
    for index, (distance, loss) in enumerate(entries):
        require(finite(distance) and 0 <= loss <= distance, "loss")
        require(index == 0 or (entries[index - 1][0] < distance and loss <= entries[index - 1][1]), "losses")
    columns = [struct.unpack("<%df" % stored, sections[n]) for n in range(1, 8)]
    if sections.get(10):
        columns.append(struct.unpack("<%df" % stored, sections[10]))
    check_points(h, columns, points)
    bits = [struct.unpack("<%dI" % stored, sections[n]) for n in range(1, 8)]
    cones = struct.unpack("<%dI" % stored, sections[10]) if sections.get(10) else None
    for i in range(points, stored):
        require(all(column[i] == column[points - 1] for column in bits[:6]) and bits[6][i] == 0, "padding points")
        require(cones is None or cones[i] == cones[points - 1], "padding cones")
    for number, each in ((8, block), (9, block * group)):
        for index, (x, y, z, radius) in enumerate(struct.iter_unpack("<4f", sections[number])):
            require(all(map(finite, (x, y, z, radius))) and radius >= 0, "sphere")
            limit = radius * radius * (1 + 2 ** -50)
            for i in range(index * each, min(stored, (index + 1) * each)):
                dx, dy, dz = columns[0][i] - x, columns[1][i] - y, columns[2][i] - z
                require(dx * dx + dy * dy + dz * dz <= limit, "a point outside of its sphere")


def check_points(h, columns, points):
    limit = h["bounding_radius_m"] ** 2 * (1 + 2 ** -50)
    weights = 0.0
    for i in range(points):
        x, y, z, nx, ny, nz, weight = (column[i] for column in columns[:7])
        require(x * x + y * y + z * z <= limit, "position")
        require(abs(nx * nx + ny * ny + nz * nz - 1) <= 2e-6, "normal")
        require(finite(weight) and weight >= 0, "weight")
        require(len(columns) < 8 or -1 <= columns[7][i] <= 1, "cone")
        weights += weight
    require(weights > 0, "weights")


def digest_of_tree(digest, h, sections, first, bits):
    tree = reader.Tree(h, sections, first, bits, 0)

    def walk(entry, low, edge, level):
        if entry >> 31:
            digest.add(*low, edge, entry & (0x7fffffff if bits == 2 else 0xffff))
            return
        if level == 3:
            digest.add(*tree.brick(entry))
            return
        for n in range(512):
            child = [low[0] + edge // 8 * (n >> 6), low[1] + edge // 8 * (n >> 3 & 7), low[2] + edge // 8 * (n & 7)]
            walk(tree.levels[level][entry * 512 + n], child, edge // 8, level + 1)

    dims = h["directory_dims"]
    for index, entry in enumerate(tree.levels[0]):
        place = (index // (dims[1] * dims[2]), index // dims[2] % dims[1], index % dims[2])
        walk(entry, [o + 512 * p for o, p in zip(h["directory_origin"], place)], 512, 1)


def digest_of(kind, h, sections):
    digest = Digest()
    if kind == "vox":
        digest_of_tree(digest, h, sections, 1, 2)
        if h["distance_quantum_m"] > 0:
            digest_of_tree(digest, h, sections, 7, 8)
        if h["object_count"] > 0:
            digest_of_tree(digest, h, sections, 11, 16)
        digest.add(*sections.get(15, b""))
        digest.add(*(word for (word,) in struct.iter_unpack("<I", sections.get(16, b""))))
        return digest.state
    for number in range(1, 12):
        digest.add(*(word for (word,) in struct.iter_unpack("<I", sections.get(number, b""))))
    return digest.state


def verdict(data):
    """`ok DIGEST` or `no REASON`."""
    try:
        kind, header, sections = read_container(data)
        (check_scene if kind == "vox" else check_shell)(header, sections)
    except Refused as reason:
        return "no " + str(reason)
    return "ok %016x" % digest_of(kind, header, sections)


if __name__ == "__main__":
    for name in sys.argv[1:]:
        with open(name, "rb") as file:
            print(verdict(file.read()))
