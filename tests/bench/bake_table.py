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


def pair(row, peer, ours, clock="wall_s"):
    return " / ".join(f"{row[key][clock] * 1e3:.0f}" for key in (peer, ours))


def cells(row):
    reading = row["vdb_tool"]["wall_s"] - row["vdb_tool_without_reading"]["wall_s"]
    rest = row["command"]["wall_s"] - row["in_memory_to_file"]["wall_s"]
    memory = [row[key] / 1e6 for key in ("vdb_tool_peak_rss_bytes", "command_peak_rss_bytes")]
    share = row["ratios"]["vdb_tool_peak_rss"]["share"]
    return [f"{row['model']} {row['voxels_across']}",
            pair(row, "straightforward_one_thread", "scan_one_thread", "cpu_s"),
            times(row, "straightforward_scan"),
            pair(row, "mesh_to_volume", "scan_all_threads"), times(row, "mesh_to_volume_scan"),
            pair(row, "vdb_tool_without_reading", "in_memory_to_file"),
            times(row, "vdb_tool_in_memory"), pair(row, "vdb_tool", "command"),
            times(row, "vdb_tool_command"), f"{reading * 1e3:.0f} / {max(0, rest) * 1e3:.0f}",
            f"{memory[0]:.0f} / {memory[1]:.0f}", f"{share * 100:.0f}%"]


HEADER = ["voxels across", "scan: straightforward / ours, ms", "times", "scan: meshToVolume / ours, ms",
          "times", "bake: vdb_tool / ours, ms", "times", "whole command, ms", "times",
          "of it reading and start, ms", "peak MB", "share"]


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
