#!/usr/bin/python3
"""The memory of the tree: figure 6 of the paper, and how compact the files are.

Usage: tree_memory.py [--bin FOLDER] [--json FILE]

Bakes the sample scene, the engine and the generated aircraft bay at 5 mm (the engine at 1024 voxels
across), as they come and with --lean (the four values alone), and prints

- the bytes of a tree that branches 2^(3N) ways, N = 1 to 4: leaves of 2^(3N) voxels of two bits, above
  them nodes of 2^(3N) entries of four bytes up to one root, uniform boxes collapsed and nothing stored
  twice or shared; beside them what the lean file and the whole one take;
- the bytes per force-layer voxel of the lean file, of the same voxels in a .vdb (UInt8, as voxinfo exports
  it, blosc), and dense in the tight box at two bits.

Writes JSON.
"""

import pathlib
import struct
import subprocess
import sys
import tempfile

import numpy as np

import bench_scenes

BRANCHINGS = (1, 2, 3, 4)
ENTRY_BYTES = 4
UNIFORM = np.uint32(1 << 31)
VARIED = np.int16(-1)  # of a cell that is not uniform; others have their code


class Voxmap:
    """The tree of a .vox file's values (formats/voxmap_format.md)."""

    def __init__(self, path):
        data = path.read_bytes()
        header_bytes, sections = struct.unpack_from("<II", data, 16)
        self.directory_dims = struct.unpack_from("<3I", data, 208)
        parts = {}
        for n in range(sections):
            ident, _, offset, size, _ = struct.unpack_from("<IIQQQ", data, header_bytes + 32 * n)
            parts[ident] = data[offset:offset + size]
        entries = {n: np.frombuffer(parts[n], "<u4") for n in (1, 2, 3)}
        self.directory = entries[1].reshape(self.directory_dims)
        self.upper, self.lower = (entries[n].reshape(-1, 8, 8, 8) for n in (2, 3))
        self.bricks = np.frombuffer(parts[4], "u1").reshape(-1, 128)


def merged(cells):
    """One level up: [.., x, y, z] codes or VARIED of cells, to those of 2^3 cells."""
    *outer, x, y, z = cells.shape
    grouped = cells.reshape(*outer, x // 2, 2, y // 2, 2, z // 2, 2)
    low, high = grouped.min(axis=(-5, -3, -1)), grouped.max(axis=(-5, -3, -1))
    return np.where((low == high) & (low >= 0), low, VARIED)


def varied_cells(cells):
    """How many of the cells of each [n] are not uniform, for its three levels above: [n][3]."""
    counts = []
    for _ in range(3):
        cells = merged(cells)
        counts.append((cells == VARIED).sum(axis=(1, 2, 3)))
    return np.stack(counts, axis=1)


def brick_counts(bricks, chunk=20000):
    """[bricks][3]: varied cells of 2^3, 4^3 and 8^3 voxels."""
    counts = [np.zeros((0, 3), int)]
    for first in range(0, len(bricks), chunk):
        packed = bricks[first:first + chunk]
        codes = (packed[:, :, None] >> np.arange(0, 8, 2, dtype=np.uint8)) & 3
        counts.append(varied_cells(codes.astype(np.int16).reshape(-1, 8, 8, 8)))
    return np.concatenate(counts)


def node_counts(nodes, below):
    """[nodes][levels]: those of the children, summed over all entries, and of the node's own cells."""
    uniform = (nodes & UNIFORM) != 0
    own = varied_cells(np.where(uniform, nodes & 0xff, np.uint32(0xffff)).astype(np.int16))
    children = np.where(uniform, 0, nodes).reshape(len(nodes), -1)
    sums = np.zeros((len(nodes), below.shape[1]), int)
    for level in range(below.shape[1]):
        picked = below[children, level] if len(below) else np.zeros(children.shape, int)
        sums[:, level] = np.where(uniform.reshape(len(nodes), -1), 0, picked).sum(axis=1)
    return np.concatenate([sums, own], axis=1)


def varied_by_level(voxmap):
    """How many aligned cells of 2^l voxels an edge are not uniform, for l = 1, 2, ... to one root."""
    counts = node_counts(voxmap.lower, brick_counts(voxmap.bricks))
    counts = node_counts(voxmap.upper, counts)
    directory = voxmap.directory.reshape(-1)
    uniform = (directory & UNIFORM) != 0
    levels = list(counts[directory[~uniform]].sum(axis=0))
    edge = 1 << (max(voxmap.directory_dims) - 1).bit_length()
    cells = np.zeros((edge, edge, edge), np.int16)  # free beyond the directory
    x, y, z = voxmap.directory_dims
    cells[:x, :y, :z] = np.where(uniform, directory & 0xff, 0xffff).astype(np.int16).reshape(x, y, z)
    while cells.size > 1:
        cells = merged(cells)
        levels.append((cells == VARIED).sum())
    return [int(n) for n in levels]


def tree_bytes(levels, branching):
    """Bytes of a tree of 2^(3N) ways: a node for every varied cell at N, 2N, ..., up to one root."""
    children = 2 ** (3 * branching)
    total = levels[branching - 1] * children // 4 if branching <= len(levels) else 0
    level = 2 * branching
    while level <= len(levels):
        total += levels[level - 1] * children * ENTRY_BYTES
        level += branching
    if level - branching < len(levels):  # a root above the highest whole step
        total += children * ENTRY_BYTES
    return total


def study(bin_folder, scene, voxel_size_m, folder):
    output, vdb = folder / "tree.vox", folder / "tree.vdb"
    whole_bytes = bench_scenes.bake(bin_folder, scene, voxel_size_m, output)["file_bytes"]
    facts = bench_scenes.bake(bin_folder, scene, voxel_size_m, output, options=["--lean"])
    levels = varied_by_level(Voxmap(output))
    subprocess.run([bin_folder / "voxinfo", "export", output, vdb, "--quiet"], check=True)
    x, y, z = facts["dims"]
    return {"scene": scene.name, "voxel_size_m": voxel_size_m, "dims": facts["dims"],
            "surface_voxels": facts["counts"]["surface"], "file_bytes": facts["file_bytes"], "whole_bytes": whole_bytes,
            "vdb_bytes": vdb.stat().st_size, "dense_bytes": x * y * z // 4,
            "tree_bytes": {str(n): tree_bytes(levels, n) for n in BRANCHINGS}}


def print_tables(rows):
    print("Tree bytes (MB) by branching 2^(3N), nothing shared; the files share equal nodes")
    print(f"{'scene':9} {'dims':>18} " + " ".join(f"{f'N={n}':>8}" for n in BRANCHINGS)
          + f" {'--lean':>8} {'whole':>8}")
    for r in rows:
        print(f"{r['scene']:9} {'x'.join(map(str, r['dims'])):>18} "
              + " ".join(f"{r['tree_bytes'][str(n)] / 1e6:8.2f}" for n in BRANCHINGS)
              + f" {r['file_bytes'] / 1e6:8.2f} {r['whole_bytes'] / 1e6:8.2f}")
    print("\nBytes per force-layer voxel")
    print(f"{'scene':9} {'force layer':>12} {'.vox':>8} {'.vdb':>8} {'dense':>8}")
    for r in rows:
        print(f"{r['scene']:9} {r['surface_voxels']:12} " + " ".join(
            f"{r[key] / r['surface_voxels']:8.2f}"
            for key in ("file_bytes", "vdb_bytes", "dense_bytes")))


def main():
    arguments = bench_scenes.arguments(sys.modules[__name__], "tree_memory")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        scenes = [(bench_scenes.sample_scene(), 0.005)]
        scenes += [(scene, scene.longest_m / 1024) for scene in bench_scenes.model_scenes()
                   if scene.name == "engine"]
        scenes.append((bench_scenes.aircraft_scene(folder / "bay"), 0.005))
        rows = [study(arguments.bin, scene, size, folder) for scene, size in scenes]
    print_tables(rows)
    bench_scenes.write_report("tree_memory", rows, arguments.json)


if __name__ == "__main__":
    main()
