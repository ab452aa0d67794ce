#!/usr/bin/python3
"""How the memory of a bake grows with the triangles of a scene of many files, at one voxel size.

Usage: bake_streams.py [--bin FOLDER] [--short] [--json FILE]

Bakes the generated aircraft bay (169 files) at 2 mm, 4000 voxels across, with default options and with 2.5 to 100
million triangles, every bake a process of its own; --short: up to 25 million. The largest scene takes 2 GB of files,
and as many bytes again twice in the temporary folder. Prints a table and writes JSON.
"""

import pathlib
import shutil
import sys
import tempfile

import bench_scenes

POLYGONS = (2500000, 5000000, 10500000, 25000000, 50000000, 100000000)
VOXEL_M = 0.002


def measure(bin_folder, short):
    print(f"{'triangles':>10} {'largest':>9} {'wall s':>7} {'cpu s':>7} {'MB peak':>8} {'MB on disk':>10} {'MB file':>8}")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for polygons in POLYGONS[:4] if short else POLYGONS:
            scene = bench_scenes.aircraft_scene(folder / "bay", polygons)
            facts = bench_scenes.bake(bin_folder, scene, VOXEL_M, folder / "bay.vox")
            shutil.rmtree(folder / "bay")
            row = {"triangles": facts["triangles"],
                   "largest_part_triangles": max(part["triangles"] for part in facts["parts"]),
                   "files": len(facts["parts"]), "wall_s": facts["wall_s"], "cpu_s": facts["cpu_s"],
                   "peak_bytes": facts["peak_rss_bytes"], "on_disk_bytes": facts["triangle_bytes_on_disk"],
                   "file_bytes": facts["file_bytes"]}
            print(f"{row['triangles']:10} {row['largest_part_triangles']:9} {row['wall_s']:7.1f} {row['cpu_s']:7.1f} "
                  f"{row['peak_bytes'] / 1e6:8.0f} {row['on_disk_bytes'] / 1e6:10.0f} {row['file_bytes'] / 1e6:8.1f}",
                  flush=True)
            yield row


def main():
    arguments = bench_scenes.arguments(sys.modules[__name__], "bake_streams", bench_scenes.SHORT)
    bench_scenes.write_report("bake_streams", list(measure(arguments.bin, arguments.short)), arguments.json)


if __name__ == "__main__":
    main()
