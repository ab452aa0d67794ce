#!/usr/bin/env python3
"""bake_table.py [FILE...]: what bake_bench measured, as a Markdown table.

Without files: results/*/bake_*.json of bake_bench beside this script. A ratio that misses its target
is marked with the target.
"""

import json
import pathlib
import sys


def reports(paths):
    listed = [json.loads(pathlib.Path(path).read_text()) for path in paths]
    return [report for report in listed if report["benchmark"] == "bake"]


def times(row, key):
    ratio = row["ratios"][key]
    text = f"{ratio['times']:.1f}" if ratio["times"] < 10 else f"{ratio['times']:.0f}"
    return text if ratio["met"] else f"{text} (of {ratio['target']:g})"


def ms(row, key, clock="wall_s"):
    return f"{row[key][clock] * 1e3:.0f}"


def cells(row):
    reading = row["vdb_tool"]["wall_s"] - row["vdb_tool_without_reading"]["wall_s"]
    share = row["ratios"]["vdb_tool_peak_rss"]["share"]
    return [f"{row['model']} {row['voxels_across']}", ms(row, "straightforward_one_thread", "cpu_s"),
            ms(row, "scan_one_thread", "cpu_s"), times(row, "straightforward_scan"),
            ms(row, "mesh_to_volume"), times(row, "mesh_to_volume_scan"),
            ms(row, "in_memory_to_file"), ms(row, "vdb_tool_without_reading"),
            times(row, "vdb_tool_in_memory"),
            f"{(row['command']['wall_s'] - row['in_memory_to_file']['wall_s']) * 1e3:.0f}",
            f"{reading * 1e3:.0f}", times(row, "vdb_tool_command"),
            f"{row['command_peak_rss_bytes'] / 1e6:.0f}",
            f"{row['vdb_tool_peak_rss_bytes'] / 1e6:.0f}", f"{share * 100:.0f}%"]


HEADER = ["model, voxels across", "straightforward scan ms", "our scan ms", "times",
          "meshToVolume ms", "times", "bake ms", "vdb_tool ms", "times", "rest of command ms",
          "vdb_tool reading ms", "command, times", "MB", "vdb_tool MB", "share"]


def main():
    paths = sys.argv[1:] or sorted(pathlib.Path(__file__).parent.glob("results/*/bake_*.json"))
    found = reports(paths)
    if not found:
        sys.exit("bake_table.py: no results of bake_bench")
    print("| " + " | ".join(HEADER) + " |")
    print("|---" + "|---:" * (len(HEADER) - 1) + "|")
    for report in found:
        for row in report["results"]:
            print("| " + " | ".join(cells(row)) + " |")
    machine = found[0]["machine"]
    print(f"\n{machine['cores']} cores of {machine['cpu']}, {machine['memory_gib']:.0f} GiB, "
          f"{machine['system']}")


if __name__ == "__main__":
    main()
