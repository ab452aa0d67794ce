#!/usr/bin/env python3
"""The work that bakes and contact queries skip, and the time that each kind of skipping saves.

Usage: skipped.py [--bin FOLDER] [--short] [--json FILE]

For the sample scene and the aircraft bay at 5 mm with the sample part, and with shells of it that are ten
and a hundred times as dense: triangles and parts that a region of interest leaves out and a cache has already;
64^3-voxel nodes, voxels and bricks that the tree never holds; blocks, points and pages of the file that
the contact query does not touch (skip_bench). Times are the least of the repetitions, or medians of
frames, side by side.
"""

import json
import math
import pathlib
import shutil
import subprocess
import sys
import tempfile

import bench_scenes

VOXEL_M = 0.005
DENSER = (1, 10, 100)          # times as many points as at the paper's covering radius
SHIFT_M = 0.02                 # by which one part moves between two bakes with a cache


def voxelize(bin_folder, manifest, output, repeat, *options):
    """The report of the quickest run."""
    report, best = output.with_suffix(".json"), None
    for _ in range(repeat):
        subprocess.run([bin_folder / "voxelize", manifest, "-o", output, "--quiet", "--json", report, "--voxel-size",
                        f"{VOXEL_M}m", *options], check=True)
        facts = json.loads(report.read_text())
        if best is None or facts["seconds"]["total"] < best["seconds"]["total"]:
            best = facts
    return best


def left_out(parts, key):
    return {"parts": sum(p[key] for p in parts), "triangles": sum(p["triangles"] for p in parts if p[key])}


def moved_copy(scene, folder, shift_m):
    """The manifest with its middle part moved, beside the same meshes."""
    manifest = json.loads(scene.path.read_text())
    part = manifest["parts"][len(manifest["parts"]) // 2]
    # A matrix has its translation in the last column.
    if "matrix" in part:
        part["matrix"][3] = part["matrix"][3] + shift_m
    else:
        old = part.get("translation", ["0m", "0m", "0m"])
        part["translation"] = [f"{shift_m}m", *old[1:]]
    shutil.copytree(scene.path.parent, folder, dirs_exist_ok=True)
    path = folder / scene.path.name
    path.write_text(json.dumps(manifest))
    return path


def roi_of(facts, share=0.125):
    """A box in the middle of the scene, of this share of its volume."""
    corner = []
    for sign in (-1, 1):
        for origin, size in zip(facts["origin_m"], facts["dims"]):
            middle = origin + size * VOXEL_M / 2
            corner.append(f"{middle + sign * size * VOXEL_M / 2 * share ** (1 / 3):.6f}m")
    return ",".join(corner)


def bakes(bin_folder, scene, folder, repeat):
    whole = voxelize(bin_folder, scene.path, folder / f"{scene.name}.vox", repeat)
    roi = voxelize(bin_folder, scene.path, folder / "roi.vox", repeat, "--roi", roi_of(whole))
    cache = folder / f"cache_{scene.name}"
    voxelize(bin_folder, scene.path, folder / "cached.vox", 1, "--cache", cache)
    again = voxelize(bin_folder, scene.path, folder / "cached.vox", repeat, "--cache", cache)
    moves = []  # each to another place, so that no cache has it
    for n in range(1, repeat + 1):
        moved = moved_copy(scene, folder / f"moved_{scene.name}", n * SHIFT_M)
        moves.append(voxelize(bin_folder, moved, folder / "cached.vox", 1, "--cache", cache))
    after = min(moves, key=lambda facts: facts["seconds"]["total"])
    total = {"parts": len(whole["parts"]), "triangles": whole["triangles"]}
    nodes_in_box = math.prod(math.ceil(d / 64) + 1 for d in whole["dims"])
    seconds = whole["seconds"]["total"]
    return {
        "total": total,
        "nodes_of_64_voxels": {"in_the_box_at_most": nodes_in_box, "built": again["nodes"]},
        "region_of_interest": {"left_out": left_out(roi["parts"], "outside_roi"),
                               "seconds": roi["seconds"]["total"], "of_whole": roi["seconds"]["total"] / seconds},
        "cache_nothing_changed": {"left_out": left_out(again["parts"], "from_cache"),
                                  "nodes_left_out": again["nodes_from_cache"],
                                  "seconds": again["seconds"]["total"],
                                  "of_whole": again["seconds"]["total"] / seconds},
        "cache_one_part_moved": {"left_out": left_out(after["parts"], "from_cache"),
                                 "nodes_left_out": after["nodes_from_cache"], "nodes": after["nodes"],
                                 "seconds": after["seconds"]["total"],
                                 "of_whole": after["seconds"]["total"] / seconds},
        "whole": {"seconds": seconds, "file_bytes": whole["file_bytes"]}}


def shell(bin_folder, folder, denser):
    output, radius_m = folder / f"part_{denser}.pshell", 3 ** 0.5 / 2 * VOXEL_M / math.sqrt(denser)
    subprocess.run([bin_folder / "pointshell", bench_scenes.ROOT / "sample_data/part.obj", "--units", "mm", "-o",
                    output, "--quiet", "--effort", "fast", "--voxel-size", f"{VOXEL_M}m", "--covering-radius",
                    f"{radius_m}m"], check=True)
    return output


def query(bin_folder, scene, part, short):
    counts = ["--places", "5", "--frames", "400"] if short else []
    run = subprocess.run([bin_folder / "skip_bench", scene, part, *counts], check=True, capture_output=True, text=True)
    facts = json.loads(run.stdout)
    none = facts["ways"]["no skipping"]["frame_us"]["p50"]
    for way in facts["ways"].values():
        way["of_no_skipping"] = way["frame_us"]["p50"] / none
    return facts


def print_bake(name, b):
    print(f"{name}: {b['total']['triangles']} triangles in {b['total']['parts']} parts, whole bake "
          f"{1e3 * b['whole']['seconds']:.0f} ms; {b['nodes_of_64_voxels']['built']} of at most "
          f"{b['nodes_of_64_voxels']['in_the_box_at_most']} nodes built")
    for key, what in (("region_of_interest", "region of an eighth"), ("cache_nothing_changed", "cache, nothing changed"),
                      ("cache_one_part_moved", "cache, one part moved")):
        print(f"  {what:24} leaves out {b[key]['left_out']['triangles']:7} triangles, takes {b[key]['of_whole']:.2f} "
              "of the time")


def print_query(name, q):
    tree = q["tree"]
    print(f"{name}: {tree['voxels_in_box']} voxels in the box, {tree['voxels_in_bricks']} in bricks; bricks "
          f"{tree['bricks_stored']} stored of {tree['bricks_needed']} needed; {q['blocks']} blocks, {q['points']} points")
    for way, r in q["ways"].items():
        print(f"  {way:16} {r['blocks_looked_at']:8.1f} blocks, {r['points_looked_at']:9.1f} points, "
              f"{r['pages_touched']} pages of {tree['pages_of_file']}; {r['frame_us']['p50']:7.2f} us, "
              f"{r['of_no_skipping']:.2f} of no skipping; {r['points_found']:.1f} found", flush=True)


def main():
    arguments = bench_scenes.arguments(sys.modules[__name__], "skipped", bench_scenes.SHORT)
    rows = []
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        shells = {denser: shell(arguments.bin, folder, denser) for denser in DENSER}
        for scene in (bench_scenes.sample_scene(), bench_scenes.aircraft_scene(folder / "bay")):
            row = {"scene": scene.name, "voxel_size_m": VOXEL_M,
                   "bake": bakes(arguments.bin, scene, folder, 1 if arguments.short else 5)}
            print_bake(scene.name, row["bake"])
            row["queries"] = []
            for denser, part in shells.items():
                found = query(arguments.bin, folder / f"{scene.name}.vox", part, arguments.short)
                row["queries"].append({"target_points": denser, **found})
                print_query(f"{scene.name}, {found['points']} points", found)
            rows.append(row)
    bench_scenes.write_report("skipped", rows, arguments.json)


if __name__ == "__main__":
    main()
