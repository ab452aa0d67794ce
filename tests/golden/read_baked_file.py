#!/usr/bin/env python3
"""Reads .vox and .pshell files from voxmap_format.md and pshell_format.md alone, slowly.

    read_baked_file.py FILE          one line of JSON with the header's fields
    read_baked_file.py FILE --rows   every non-free voxel as `i,j,k,value`, or every shell point as
                                     `x,y,z,nx,ny,nz,weight_m2,block` in the part frame

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
              ("offset_layers", "I"), ("metric", "I"), ("bits_per_voxel", "I"),
              ("directory_origin", "3q"), ("directory_dims", "3I"), ("reserved0", "I"),
              ("interior_voxels", "Q"), ("surface_voxels", "Q"), ("proximity_voxels", "Q"),
              ("triangles", "Q"), ("static_deviation_m", "d"), ("range_m", "d"), ("quantum_m", "d"),
              ("zero_code", "I"), ("surface_code", "I"), ("proximity_code", "I"),
              ("free_code", "I"), ("reserved", "88s")]
PSHELL_HEADER = [("point_count", "Q"), ("block_points", "I"), ("super_block_blocks", "I"),
                 ("block_count", "Q"), ("super_block_count", "Q"), ("covering_radius_m", "d"),
                 ("voxel_size_m", "d"), ("bounding_radius_m", "d"), ("part_deviation_m", "d"),
                 ("center_m", "3d"), ("area_m2", "d"), ("volume_m3", "d"), ("inertia_m2", "6d"),
                 ("mass_source", "I"), ("method", "I"), ("triangles", "Q"), ("reserved", "24s")]
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
    fields = FILE_HEADER + {VOX_MAGIC: VOX_HEADER, PSHELL_MAGIC: PSHELL_HEADER}[data[:8]]
    header, size = read_fields(data, fields)
    assert header["endian_tag"] == 0x01020304 and header["major"] == 1
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


class Voxmap:
    def __init__(self, header, sections):
        self.header, self.bits = header, header["bits_per_voxel"]
        self.levels = [struct.unpack("<%dI" % (len(sections[i]) // 4), sections[i])
                       for i in (1, 2, 3)]
        self.bricks = sections[4]

    def value_of(self, code):
        if self.bits == 2:
            return code
        thresholds = [("surface_code", 1), ("proximity_code", 2), ("free_code", 3)]
        for name, value in thresholds:
            if code < self.header[name]:
                return value
        return 0

    def brick_code(self, brick, n):
        bit = n * self.bits
        byte = self.bricks[brick * 64 * self.bits + bit // 8]
        return byte >> (bit % 8) & ((1 << self.bits) - 1)

    def rows(self):
        dims = self.header["directory_dims"]
        for index, entry in enumerate(self.levels[0]):
            place = (index // (dims[1] * dims[2]), index // dims[2] % dims[1], index % dims[2])
            low = [o + 512 * p for o, p in zip(self.header["directory_origin"], place)]
            yield from self.box_rows(entry, low, 512, 1)

    def box_rows(self, entry, low, edge, level):
        if entry >> 31:
            value = self.value_of(entry & 0xff)
            if value:
                yield from ((low[0] + x, low[1] + y, low[2] + z, value) for x in range(edge)
                            for y in range(edge) for z in range(edge))
            return
        child = edge // 8
        for n in range(512):
            at = [low[0] + child * (n >> 6), low[1] + child * (n >> 3 & 7), low[2] + child * (n & 7)]
            if level < 3:
                yield from self.box_rows(self.levels[level][entry * 512 + n], at, child, level + 1)
            elif value := self.value_of(self.brick_code(entry, n)):
                yield (*at, value)


def shell_rows(header, sections):
    count = header["block_count"] * header["block_points"]
    columns = [struct.unpack("<%df" % count, sections[number]) for number in range(1, 8)]
    for i in range(header["point_count"]):
        position = [header["center_m"][axis] + columns[axis][i] for axis in range(3)]
        yield (*position, *(column[i] for column in columns[3:]), i // header["block_points"])


def main():
    with open(sys.argv[1], "rb") as file:
        header, sections = read_container(file.read())
    is_scene = header["magic"] == VOX_MAGIC
    if sys.argv[2:] == ["--rows"]:
        rows = Voxmap(header, sections).rows() if is_scene else shell_rows(header, sections)
        for row in rows:
            print(*row, sep=",")
        return
    plain = {name: value for name, value in header.items() if not isinstance(value, bytes)}
    print(json.dumps({**plain, "checksums_compared": xxhash is not None}))


if __name__ == "__main__":
    main()
