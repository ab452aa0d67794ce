#!/usr/bin/python3
"""How the memory of a bake grows with the triangles of a scene of many files, where its parts and its voxels stay.

Usage: bake_streams.py [--bin FOLDER] [--short] [--json FILE]

Bakes the generated aircraft bay of 10.5 million triangles (169 files) at 2 mm, 4000 voxels across, with default options,
as 1 to 10 copies of every file in the same place, so that the voxels stay; every bake a process of its own.
--short: up to 3 copies. The largest scene takes 7 GB in the temporary folder. Prints a table and writes JSON.
"""

import json
import os
import pathlib
import sys
import tempfile

import bench_scenes

POLYGONS = 10_500_000
COPIES = (1, 2, 3, 5, 10)
VOXEL_M = 0.002


def copied(scene, copies):
    """A manifest beside that of the scene which names every file so many times, each time by another name."""
    manifest = json.loads(scene.path.read_text())
    parts = []
    for n in range(copies):
        for part in manifest["parts"]:
            file = scene.path.parent / part["mesh"]
            link = file.with_stem(f"{file.stem}_{n}")
            if not link.exists():
                os.link(file, link)
            parts.append({**part, "name": f"{part['name']}_{n}", "mesh": link.name})
    path = scene.path.with_stem(f"copies_{copies}")
    path.write_text(json.dumps({**manifest, "parts": parts}))
    return bench_scenes.Scene(scene.name, path, scene.units, scene.longest_m)


def measure(bin_folder, short):
    print(f"{'triangles':>10} {'files':>6} {'wall s':>7} {'cpu s':>7} {'MB peak':>8} {'MB on disk':>10} {'MB file':>8}")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        bay = bench_scenes.aircraft_scene(folder / "bay", POLYGONS)
        for copies in COPIES[:3] if short else COPIES:
            facts = bench_scenes.bake(bin_folder, copied(bay, copies), VOXEL_M, folder / "bay.vox")
            row = {"triangles": facts["triangles"], "files": len(facts["parts"]),
                   "largest_part_triangles": max(part["triangles"] for part in facts["parts"]),
                   "wall_s": facts["wall_s"], "cpu_s": facts["cpu_s"], "peak_bytes": facts["peak_rss_bytes"],
                   "on_disk_bytes": facts["triangle_bytes_on_disk"], "file_bytes": facts["file_bytes"]}
            print(f"{row['triangles']:10} {row['files']:6} {row['wall_s']:7.1f} {row['cpu_s']:7.1f} "
                  f"{row['peak_bytes'] / 1e6:8.0f} {row['on_disk_bytes'] / 1e6:10.0f} {row['file_bytes'] / 1e6:8.1f}",
                  flush=True)
            yield row


def main():
    arguments = bench_scenes.arguments(sys.modules[__name__], "bake_streams", bench_scenes.SHORT)
    bench_scenes.write_report("bake_streams", list(measure(arguments.bin, arguments.short)), arguments.json)


if __name__ == "__main__":
    main()
