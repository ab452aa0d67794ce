#!/usr/bin/python3
"""How the time and memory of a bake grow: with triangles, and with 1/s.

Usage: bake_growth.py [--bin FOLDER] [--short] [--repeat N] [--json FILE]

Bakes the generated aircraft bay at 2 mm (4000 voxels across) with 150 thousand to 10.5 million
triangles, then the bay of 593,409 and the models of ../shared/models at 128 to 4096 voxels across,
every bake a process of its own; --short: up to 1.2 million triangles and 1024 voxels.
Prints a table and writes JSON.
"""

import pathlib
import sys
import tempfile

import bench_scenes

POLYGONS = (150000, 300000, 593409, 1200000, 2500000, 5000000, 10500000)
POLYGONS_VOXEL_M = 0.002
ACROSS = (128, 256, 512, 1024, 2048)
ACROSS_AIRCRAFT = (*ACROSS, 4096)
PAPER_VOXEL_M = 0.005


def row(series, scene, voxel_size_m, facts):
    seconds = facts["seconds"]
    return {"series": series, "scene": scene.name, "voxel_size_m": voxel_size_m,
            "voxels_across": max(facts["dims"]) - 2 * (facts["layers"] + 1), "triangles": facts["triangles"],
            "wall_s": facts["wall_s"], "cpu_s": facts["cpu_s"], "read_s": seconds["read"],
            "bake_s": seconds["total"] - seconds["read"],
            "peak_rss_bytes": facts["peak_rss_bytes"], "file_bytes": facts["file_bytes"],
            "surface_voxels": facts["counts"]["surface"]}


def measure(bin_folder, repeat, short):
    rows = []

    def add(series, scene, voxel_size_m, output):
        rows.append(row(series, scene, voxel_size_m, bench_scenes.bake(
            bin_folder, scene, voxel_size_m, output, repeat)))
        print_row(rows[-1])

    print_header()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        output = folder / "growth.vox"
        for polygons in POLYGONS[:4] if short else POLYGONS:
            scene = bench_scenes.aircraft_scene(folder / "bay", polygons)
            add("triangles", scene, POLYGONS_VOXEL_M, output)
        scene = bench_scenes.aircraft_scene(folder / "bay")
        add("paper", scene, PAPER_VOXEL_M, output)
        for across in ACROSS_AIRCRAFT[:4] if short else ACROSS_AIRCRAFT:
            add("resolution", scene, scene.longest_m / across, output)
        for scene in bench_scenes.model_scenes():
            for across in ACROSS[:4] if short else ACROSS:
                add("resolution", scene, scene.longest_m / across, output)
    return rows


def print_header():
    print(f"{'series':10} {'scene':9} {'triangles':>10} {'voxels':>7} {'wall ms':>9} {'cpu ms':>9} "
          f"{'read ms':>8} {'MB peak':>8} {'MB file':>8}")


def print_row(r):
    print(f"{r['series']:10} {r['scene']:9} {r['triangles']:10} {r['voxels_across']:7.0f} "
          f"{r['wall_s'] * 1e3:9.0f} {r['cpu_s'] * 1e3:9.0f} {r['read_s'] * 1e3:8.0f} "
          f"{r['peak_rss_bytes'] / 1e6:8.1f} {r['file_bytes'] / 1e6:8.2f}", flush=True)


def main():
    arguments = bench_scenes.arguments(sys.modules[__name__], "bake_growth", bench_scenes.SHORT, bench_scenes.REPEAT)
    rows = measure(arguments.bin, 1 if arguments.short else arguments.repeat, arguments.short)
    bench_scenes.write_report("bake_growth", rows, arguments.json)


if __name__ == "__main__":
    main()
