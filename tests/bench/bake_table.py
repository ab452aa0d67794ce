#!/usr/bin/env python3
"""bake_table.py [FILE...]: what bake_bench measured, as a Markdown table. Of files that
`bake_bench --wide` wrote, where there are no others: its table.

Without files: results/*/bake_*.json of bake_bench beside this script. A ratio that misses its target
is marked with the target.
"""

import json
import pathlib
import sys


def reports(paths):
    listed = [json.loads(pathlib.Path(path).read_text()) for path in paths]
    usual = [report for report in listed if report["benchmark"] == "bake"]
    return usual or [report for report in listed if report["benchmark"] == "bake_wide"]


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


def wide_cells(row):
    def over(name):
        ratio = row["kinds"][name]["over_two_bits"]
        return f"{ratio['times']:.1f}" + ("" if ratio["met"] else f" (of {ratio['target']:g})")

    def by_command(name):  # not with --vectors
        ratio = row["kinds"][name]["over_two_bits"]
        return f"{ratio['command_times']:.1f}" if "command_times" in ratio else "-"

    kinds = row["kinds"]
    usual, most = kinds["two bits"], kinds["8 bits"]
    milliseconds = [f"{kinds[name]['in_memory_to_file']['wall_s'] * 1e3:.0f}" for name in WIDE_KINDS]
    sizes = [row["vdb_bytes"], most["file_bytes"], usual["file_bytes"]]
    return [f"{row['model']} {row['voxels_across']}", " / ".join(milliseconds),
            *(over(name) for name in WIDE_KINDS[1:]),
            *(by_command(name) for name in WIDE_KINDS[1:]),
            f"{row['vdb_tool_without_reading']['wall_s'] * 1e3:.0f}",
            f"{most['vdb_tool_times']:.0f}", f"{row['mesh_to_volume']['wall_s'] * 1e3:.0f}",
            f"{most['mesh_to_volume_times']:.0f}", " / ".join(f"{size / 1e6:.1f}" for size in sizes)]


WIDE_KINDS = ["two bits", "two bits, euclidean", "4 bits", "8 bits"]
WIDE_HEADER = ["voxels across", "bake: two bits / euclidean / 4 / 8 bits, ms", "euclidean, times", "4 bits, times",
               "8 bits, times", "command: euclidean, times", "4 bits, times", "8 bits, times", "vdb_tool, ms",
               "over 8 bits", "meshToVolume, ms", "over 8 bits",
               "MB: .vdb / 8 bits / two bits"]
HEADER = ["voxels across", "scan: straightforward / ours, ms", "times", "scan: meshToVolume / ours, ms",
          "times", "bake: vdb_tool / ours, ms", "times", "whole command, ms", "times",
          "of it reading and start, ms", "peak MB", "share"]


def main():
    paths = sys.argv[1:] or sorted(pathlib.Path(__file__).parent.glob("results/*/bake_*.json"))
    found = reports(paths)
    if not found:
        sys.exit("bake_table.py: no results of bake_bench")
    header, line = (WIDE_HEADER, wide_cells) if found[0]["benchmark"] == "bake_wide" else (HEADER, cells)
    print("| " + " | ".join(header) + " |")
    print("|---" + "|---:" * (len(header) - 1) + "|")
    for report in found:
        for row in report["results"]:
            print("| " + " | ".join(line(row)) + " |")
    machine = found[0]["machine"]
    print(f"\n{machine['cores']} cores of {machine['cpu']}, {machine['memory_gib']:.0f} GiB, "
          f"{machine['system']}")


if __name__ == "__main__":
    main()
