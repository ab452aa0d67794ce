#!/usr/bin/env python3
"""Results of the benchmarks as small tables: one CSV per benchmark and machine.

Usage: bench_csv.py folder                   where this machine's results stand
       bench_csv.py write JSON_FOLDER CSV_FOLDER
       bench_csv.py compare COMMITTED NEW    which figures of NEW moved by more than noise

`write` turns the reports of the benchmarks into CSV files. A report's results are rows, or rows by the name of their
file. A file begins with comment lines: the machine, the commit, then one line for each run with its number, command,
date and vector instructions. The column `run` refers to these.

`compare` finds the same row by its keys and compares the columns that FILES lists. Times are compared after division
by the median ratio of the file, the pace of the machine on that day. Where COMMITTED lacks a file, columns that do
not depend on the machine are compared with another machine's file.
"""

import csv
import json
import math
import pathlib
import re
import statistics
import subprocess
import sys

import bench_scenes

RESULTS = bench_scenes.ROOT / "tests/bench/results"

# How far a figure may move: by a factor.
SAME = 1.001      # what a bake, a seeded contact or a seeded simulation gives
MEMORY = 1.3
TIME = 1.6        # after division by the file's median ratio
OF_A_MACHINE = (MEMORY, TIME)


def times(*columns):
    return dict.fromkeys(columns, TIME)


def same(*columns):
    return dict.fromkeys(columns, SAME)


# The files: the columns that identify a row, and those that are compared.
FILES = {
    "bake_kinds": (("vectors", "model", "voxels", "kind"), {**times("bake_s", "command_s"), **same("file_bytes")}),
    "bake_full": (("scene", "voxels", "triangles", "kind"), {**times("cpu_s"), **same("file_bytes"), "peak_bytes": MEMORY}),
    "shell": (("mesh", "voxels", "method"), {**same("points", "points_over_bound", "normal_p50_deg"),
                                             **times("wall_s", "proof_s")}),
    "query": (("motion", "points", "method"), {**times("p50_us"), "points_in_band": 1.5}),
    "wrench": (("voxel_m", "contacts", "method", "figure", "n"), {"p50": 1.6}),  # of as many cases
    "wrench_hand": (("voxel_m", "covering_voxels", "contacts", "motion", "n"), {"p50": 1.6}),
    "wrench_hand_cases": (("voxel_m", "covering_voxels", "contacts", "cases"), times("step_p50_us")),
    "wrench_hand_causes": (("voxel_m", "covering_voxels", "contacts", "cause", "n"), {"p50": 1.6}),
    "wrench_hand_each": (("voxel_m", "covering_voxels", "contacts", "number"), {}),
    "motion_drift": (("model", "frames"), {}),
    "stability": (("campaign", "case", "model"), {"penetration_ratio": 1.5, "quiet_fraction": 1.3}),
    "stability_field": (("factor",), {"penetration_ratio": 1.5}),
    "stability_grips": (("model", "scale", "delay_s", "hand", "clutch", "axis", "arm_m"), {}),
    "stability_seats": (("seed", "pair", "covering_voxels"), {}),
    "stability_step": (("part",), times("p50_us")),
    "assembly_peg": (("map", "clearance_m", "chamfer_m", "tilt_deg"), {}),
    "assembly_nut": (("map", "voxel_m", "play_m"), {"points": SAME, "lead_pitches": 1.05}),
    "clearance": (("scenes", "from_voxels", "to_voxels"), {"poses": SAME, "slack_median": 1.02, "slack_p99": 1.02}),
    "clearance_poses": (("scenes",), same("poses", "too_much")),
    "narrow_gaps": (("map", "covering_voxels", "case"), {"all_pass_voxels": 1.25, "some_pass_voxels": 1.25}),
    "path": (("scenes", "from_voxels"), {"poses": SAME, "median": 1.02, "p99": 1.02}),
    "path_poses": (("scenes",), same("moments", "too_much", "planted", "found")),
    "path_time": (("clearance_mm", "threads"), {**same("poses", "moments_tested"), **times("cpu_s")}),
    "disassembly": (("assembly", "parts"), {}),
    "cores": (("task", "stage", "threads"), times("wall_s")),
    "puzzles": (("puzzle", "validity"), times("poses_per_s", "steps_per_s")),
    "loop": (("figure",), {}),
}


def cell(value):
    """As CSV writes it: five significant digits."""
    if value is None:
        return ""
    if isinstance(value, float):
        if value == int(value) and abs(value) < 1e15:
            return str(int(value))
        return format(value, ".5g")
    return str(value)


def machine_line(machine):
    words = [machine["cpu"], f"{machine['cores']} cores"]
    words += [f"{machine['memory_gib']:.0f} GiB"] if "memory_gib" in machine else []
    return ", ".join([*words, re.sub(r" \d.*", "", machine["system"])])


def commit():
    """The commit that was measured, and whether the tree differed from it; empty outside of a repository."""
    return subprocess.run(["git", "-C", bench_scenes.ROOT, "describe", "--always", "--dirty", "--abbrev=7", "--exclude=*"],
                          capture_output=True, text=True).stdout.strip()


def run_line(report):
    machine = report["machine"]
    return "; ".join([report["command"], machine["date"][:10], *filter(None, [machine.get("vectors")])])


def write(reports, folder):
    """Writes the files of these reports, and returns their paths."""
    files = {}
    for report in reports:
        results = report["results"]
        for name, rows_of in (results if isinstance(results, dict) else {report["benchmark"]: results}).items():
            runs, rows = files.setdefault(name, ([], []))
            runs.append(report)
            rows += [{"run": len(runs), **row} for row in rows_of]
    folder.mkdir(parents=True, exist_ok=True)
    for name, (runs, rows) in files.items():
        with open(folder / f"{name}.csv", "w", newline="") as file:
            print(f"# machine: {machine_line(runs[0]['machine'])}", file=file)
            print(f"# commit: {commit()}", file=file)
            for number, report in enumerate(runs, 1):
                print(f"# run {number}: {run_line(report)}", file=file)
            lines = csv.writer(file, lineterminator="\n")
            columns = list(dict.fromkeys(key for row in rows for key in row))
            lines.writerow(columns)
            lines.writerows([cell(row.get(key)) for key in columns] for row in rows)
    return [folder / f"{name}.csv" for name in files]


DATE = r"\d{4}-\d\d-\d\d"


class Table:
    """A CSV file: `machine`, `commit`, `runs` (text by number), `rows` (dicts of numbers, texts and None)."""

    def __init__(self, path):
        lines = path.read_text().splitlines()
        self.machine, self.commit, self.runs = lines[0].removeprefix("# machine: "), "", {}
        while lines[0].startswith("#"):
            line = lines.pop(0)
            if line.startswith("# commit: "):
                self.commit = line.removeprefix("# commit: ")
            if line.startswith("# run "):
                number, text = line.removeprefix("# run ").split(": ", 1)
                self.runs[int(number)] = text
        self.rows = [{key: number_or_text(text) for key, text in row.items()} for row in csv.DictReader(lines)]


def newest(name):
    """The folder of the machine with the last run of a file: that is whose figures the README shows."""
    def date(path):
        return max(re.search(DATE, line)[0] for line in Table(path).runs.values())
    return max(sorted(RESULTS.glob(f"*/{name}.csv")), key=date).parent


def number_or_text(text):
    if text == "":
        return None
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            pass
    return text


def moved(old, new, factor):
    """Whether two values differ by more than the factor."""
    if isinstance(old, str) or isinstance(new, str) or old is None or new is None:
        return old != new
    if old == new:
        return False
    if old == 0 or new == 0 or (old < 0) != (new < 0):
        return True
    return abs(math.log(new / old)) > math.log(factor)


def compare_file(committed, new, keys, noise):
    """(how many figures were compared, lines about those that moved, the machine's pace)."""
    def key_of(row):
        return tuple(row.get(key) for key in keys)
    old_rows = {key_of(row): row for row in committed.rows}
    figures = [(key_of(row), column, old_rows[key_of(row)].get(column), row.get(column), factor)
               for row in new.rows if key_of(row) in old_rows for column, factor in noise.items()
               if not (old_rows[key_of(row)].get(column) is None and row.get(column) is None)]
    ratios = [b / a for _, _, a, b, factor in figures if factor == TIME and a and b]
    pace = statistics.median(ratios) if ratios else None
    lines = []
    for key, column, a, b, factor in figures:
        expected = a * pace if factor == TIME and a else a
        if moved(expected, b, factor):
            lines.append(f"    {', '.join(map(str, key))}: {column} {a}, now {b}")
    return len(figures), lines, pace


def compare(committed_folder, new_folder):
    total, beyond = 0, 0
    print(f"Beside the committed figures ({committed_folder.name}):")
    for path in sorted(new_folder.glob("*.csv")):
        (keys, noise), committed, whose = FILES[path.stem], committed_folder / path.name, ""
        if not committed.exists():
            committed = next(iter(sorted(RESULTS.glob(f"*/{path.name}"))), committed)
            noise = {column: factor for column, factor in noise.items() if factor not in OF_A_MACHINE}
            whose = f" that do not depend on the machine, beside {committed.parent.name}"
        if not committed.exists():
            print(f"  {path.stem}: nothing committed to compare with")
            continue
        count, lines, pace = compare_file(Table(committed), Table(path), keys, noise)
        total, beyond = total + count, beyond + len(lines)
        speed = f", times {pace:.2f} of the committed ones (median)" if pace else ""
        print(f"  {path.stem}: {count} figures{whose}, {len(lines)} moved by more than noise{speed}")
        print("\n".join(lines[:12] + ([f"    ... and {len(lines) - 12} more"] if len(lines) > 12 else [])),
              end="\n" if lines else "")
    print(f"{beyond} of {total} figures moved by more than noise")


def main():
    words = sys.argv[1:]
    if words == ["folder"]:
        print(bench_scenes.results_folder())
    elif len(words) == 3 and words[0] == "write":
        reports = [json.loads(path.read_text()) for path in sorted(pathlib.Path(words[1]).glob("*.json"))]
        for path in write(reports, pathlib.Path(words[2])):
            print(f"wrote {path}")
    elif len(words) == 3 and words[0] == "compare":
        compare(pathlib.Path(words[1]), pathlib.Path(words[2]))
    else:
        print(__doc__.split("\n\n")[1], file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
