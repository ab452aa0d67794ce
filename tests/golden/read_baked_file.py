#!/usr/bin/env python3
"""Reads .vox and .pshell files from voxmap_format.md and pshell_format.md alone, slowly.

    read_baked_file.py FILE          one line of JSON with the header's fields
    read_baked_file.py FILE --rows   every non-free voxel as `i,j,k,value`, or every shell point as
                                     `x,y,z,nx,ny,nz,weight_m2,block` in the part frame
    read_baked_file.py FILE --distances   every voxel whose code is not 255 as `i,j,k,code`
    read_baked_file.py FILE --objects     every voxel that has an object as `i,j,k,object`

Checksums are compared where the python module `xxhash` is installed.
"""
import json
import struct
import sys

try:
    import xxhash
except ImportError:
    xxhash = None

FILE_HEADER = [("magic", "8s"), ("endian_tag", "I"), ("major", "H"), ("minor", "H"),
               ("header_bytes", "I"), ("section_count", "I"), ("file_bytes", "Q"),
               ("required_features", "Q"), ("optional_features", "Q"), ("header_checksum", "Q"),
               ("reserved_file", "Q")]
VOX_HEADER = [("voxel_size_m", "d"), ("origin_voxel", "3q"), ("dims_voxels", "3Q"),
              ("valid_min_voxel", "3q"), ("valid_max_voxel", "3q"), ("cropped_sides", "I"),
              ("offset_layers", "I"), ("metric", "I"), ("reserved0", "I"),
              ("directory_origin", "3q"), ("directory_dims", "3I"), ("object_count", "I"),
              ("interior_voxels", "Q"), ("surface_voxels", "Q"), ("proximity_voxels", "Q"),
              ("triangles", "Q"), ("static_deviation_m", "d"), ("zero_force_m", "d"),
              ("force_depth_m", "d"), ("distance_quantum_m", "d"), ("distance_zero_code", "i"),
              ("reserved1", "I"), ("reserved", "88s")]
PSHELL_HEADER = [("point_count", "Q"), ("block_points", "I"), ("super_block_blocks", "I"),
                 ("block_count", "Q"), ("super_block_count", "Q"), ("covering_radius_m", "d"),
                 ("voxel_size_m", "d"), ("bounding_radius_m", "d"), ("part_deviation_m", "d"),
                 ("center_m", "3d"), ("area_m2", "d"), ("volume_m3", "d"), ("inertia_m2", "6d"),
                 ("mass_source", "I"), ("method", "I"), ("triangles", "Q"), ("convex_radius_m", "d"), ("convex_gap_m", "d"),
                 ("reserved", "8s")]
VOX_MAGIC = bytes([0x89]) + b"FLV\r\n\x1a\n"
PSHELL_MAGIC = bytes([0x89]) + b"FLP\r\n\x1a\n"


def read_fields(data, fields):
    """The fields of a packed little-endian structure, arrays as lists; its size."""
    values, at = {}, 0
    for name, kind in fields:
        parts = struct.unpack_from("<" + kind, data, at)
        at += struct.calcsize("<" + kind)
        values[name] = parts[0] if len(parts) == 1 else list(parts)
    return values, at


def check_checksum(data, expected, what):
    if xxhash is not None:
        assert xxhash.xxh3_64_intdigest(data) == expected, what + " is damaged"


def read_container(data):
    """Header fields and sections {id: bytes} of either format."""
    fields, major = {VOX_MAGIC: (VOX_HEADER, 2), PSHELL_MAGIC: (PSHELL_HEADER, 2)}[data[:8]]
    fields = FILE_HEADER + fields
    header, size = read_fields(data, fields)
    assert header["endian_tag"] == 0x01020304 and header["major"] == major
    assert header["header_bytes"] == size and header["file_bytes"] == len(data)
    assert header["required_features"] == 0
    for name, value in header.items():
        assert not name.startswith("reserved") or value in (0, bytes(len(value or b""))), name
    end = size + 32 * header["section_count"]
    check_checksum(data[:48] + bytes(8) + data[56:end], header["header_checksum"], "header")
    sections, last_id = {}, 0
    for index in range(header["section_count"]):
        number, element, offset, length, checksum = struct.unpack_from("<IIQQQ", data,
                                                                       size + 32 * index)
        assert number > last_id and offset == (end + 63) // 64 * 64 and length % element == 0
        assert not any(data[end:offset])
        sections[number] = data[offset:offset + length]
        check_checksum(sections[number], checksum, "section %d" % number)
        last_id, end = number, offset + length
    assert end == len(data)
    return header, sections


def distance_brick(data, at):
    """The 512 codes of the packed brick of distances that begins at byte `at`."""
    slopes, widths = data[at:at + 4], data[at + 4:at + 36]
    codes, at = [], at + 36
    for row in range(64):
        width = min(8, widths[row // 2] >> 4 * (row % 2) & 15)
        fields = int.from_bytes(data[at:at + width], "little")
        at += width
        codes += [(fields >> z * width & (1 << width) - 1) - (1 << width >> 1) for z in range(8)]
    for n in range(512):  # sums over all voxels before, along one axis after the other
        codes[n] += codes[n - 1] if n % 8 else 0
    for n in range(512):
        codes[n] += codes[n - 8] if n // 8 % 8 else 0
    for n in range(512):
        codes[n] += codes[n - 64] if n // 64 else 0
    return [(code + slopes[0] + slopes[1] * (n // 64) + slopes[2] * (n // 8 % 8) + slopes[3] * (n % 8)) % 256
            for n, code in enumerate(codes)]


def object_brick(data, at):
    """The 512 numbers of the packed brick of objects that begins at byte `at`."""
    bits = data[at]
    if bits not in (1, 2, 4):
        return list(struct.unpack_from("<512H", data, at + 2))
    palette = struct.unpack_from("<%dH" % (1 << bits), data, at + 2)
    indices = int.from_bytes(data[at + 2 + (2 << bits):][:64 * bits], "little")
    return [palette[indices >> n * bits & (1 << bits) - 1] for n in range(512)]


class Tree:
    """One of the three trees: `first` is its directory's section, `background` is left out."""

    def __init__(self, header, sections, first, bits, background):
        self.header, self.bits, self.background = header, bits, background
        self.levels = []
        for number in range(first, first + 3):
            section = sections.get(number, b"")
            self.levels.append(struct.unpack("<%dI" % (len(section) // 4), section))
        self.bricks = sections.get(first + 3, b"")

    def brick(self, brick):
        """The 512 elements of a brick."""
        if self.bits == 8:
            return distance_brick(self.bricks, 16 * brick)
        if self.bits == 16:
            return object_brick(self.bricks, 16 * brick)
        return [self.bricks[128 * brick + n // 4] >> 2 * (n % 4) & 3 for n in range(512)]

    def rows(self):
        dims = self.header["directory_dims"]
        for index, entry in enumerate(self.levels[0]):
            place = (index // (dims[1] * dims[2]), index // dims[2] % dims[1], index % dims[2])
            low = [o + 512 * p for o, p in zip(self.header["directory_origin"], place)]
            yield from self.box_rows(entry, low, 512, 1)

    def box_rows(self, entry, low, edge, level):
        if entry >> 31:
            element = entry & (0xff if self.bits == 2 else 0xffff)
            if element != self.background:
                yield from ((low[0] + x, low[1] + y, low[2] + z, element) for x in range(edge)
                            for y in range(edge) for z in range(edge))
            return
        child = edge // 8
        elements = self.brick(entry) if level == 3 else None
        for n in range(512):
            at = [low[0] + child * (n >> 6), low[1] + child * (n >> 3 & 7), low[2] + child * (n & 7)]
            if level < 3:
                yield from self.box_rows(self.levels[level][entry * 512 + n], at, child, level + 1)
            elif (element := elements[n]) != self.background:
                yield (*at, element)


def object_names(header, sections):
    names = sections.get(15, b"").split(bytes(1))
    assert names.pop() == b"" and len(names) == header["object_count"]
    return [name.decode("utf-8", "replace") for name in names]


def shell_rows(header, sections):
    count = header["block_count"] * header["block_points"]
    columns = [struct.unpack("<%df" % count, sections[number]) for number in range(1, 8)]
    for i in range(header["point_count"]):
        position = [header["center_m"][axis] + columns[axis][i] for axis in range(3)]
        yield (*position, *(column[i] for column in columns[3:]), i // header["block_points"])


def losses(sections):
    """Entries [distance_m, loss_m] of a shell's table, checked."""
    section = sections.get(11, b"")
    entries = [list(struct.unpack_from("<2d", section, at)) for at in range(0, len(section), 16)]
    assert len(entries) <= 256
    for index, (distance, loss) in enumerate(entries):
        assert 0 <= loss <= distance < float("inf")
        assert index == 0 or (entries[index - 1][0] < distance and loss <= entries[index - 1][1])
    return entries


def two_sided_points(header, sections):
    """How many points have no inside; the section is checked."""
    if 13 not in sections:
        return 0
    sides = sections[13]
    count = header["point_count"]
    assert header["minor"] >= 1 and len(sides) == header["block_count"] * header["block_points"]
    assert all(side in (0, 1) for side in sides) and len(set(sides[count - 1:])) == 1
    return sum(sides[:count])


def surface_distance(header, entries, distance):
    """The distance of the part's surface that shell points at this distance prove (section 4)."""
    bounds = [0.0, distance - header["covering_radius_m"]]
    if distance >= header["convex_radius_m"]:
        bounds.append((distance ** 2 - header["convex_radius_m"] ** 2) ** 0.5
                      - header["convex_gap_m"])
    for own, loss in entries:
        if distance >= own:
            bounds.append(distance - loss)
        elif distance ** 2 >= own ** 2 - (own - loss) ** 2:
            bounds.append((distance ** 2 - own ** 2 + (own - loss) ** 2) ** 0.5)
    return max(bounds)


def main():
    with open(sys.argv[1], "rb") as file:
        header, sections = read_container(file.read())
    is_scene = header["magic"] == VOX_MAGIC
    trees = {"--rows": (1, 2, 0), "--distances": (7, 8, 255), "--objects": (11, 16, 0)}
    if sys.argv[2:]:
        tree = trees[sys.argv[2]]
        rows = Tree(header, sections, *tree).rows() if is_scene else shell_rows(header, sections)
        for row in rows:
            print(*row, sep=",")
        return
    plain = {name: value for name, value in header.items() if not isinstance(value, bytes)}
    if is_scene:
        plain["objects"] = object_names(header, sections)
    else:
        entries = losses(sections)
        plain["losses"] = entries
        plain["two_sided_points"] = two_sided_points(header, sections)
        plain["surface_distance_of_2_voxels_m"] = surface_distance(header, entries,
                                                                   2 * header["voxel_size_m"])
    print(json.dumps({**plain, "checksums_compared": xxhash is not None}))


if __name__ == "__main__":
    main()
