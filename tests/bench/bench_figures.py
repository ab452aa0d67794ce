#!/usr/bin/env python3
"""Reports of the benchmarks as flat figures: as CSV, and beside the committed ones.

Usage: bench_figures.py folder                   where this machine's results stand
       bench_figures.py csv FOLDER               FOLDER/NAME.csv for every FOLDER/NAME.json
       bench_figures.py compare COMMITTED NEW    which figures of NEW moved by more than noise; where
                                                 COMMITTED lacks a report, beside the README's

A figure's name is its path in the report, items of lists named by what they are of. What noise is,
is said by COMPARED: figures that come out the same on every machine must, figures of a smaller
sample may differ by a factor, and times are compared after dividing by the median ratio of their
report: how fast the machine was on that day.
"""

import csv
import json
import math
import pathlib
import re
import statistics
import sys

import bench_scenes

# What tells the items of a list apart, in this order.
IDENTITY = ("series", "scene", "model", "mesh", "shape", "part", "pair", "contact", "motion", "program", "method",
            "grip", "what", "s", "covering_radius_voxels", "voxels_across", "delay_s", "mass_kg", "rate_hz",
            "stiffness_factor", "voxel_size_m", "target_points", "orientations")

# Figures that are compared, by benchmark: a pattern of their names, and how far they may move: by a
# factor that goes with the machine, of NOISE ("time" after dividing by the report's median, "ratio"
# of times of one run, "memory"), or by one of their own. The latter are compared with another
# machine's figures where this one has none.
NOISE = {"time": 1.6, "ratio": 1.6, "memory": 1.3}
SAME = 1.001
COMPARED = {
    "bake": [(r"ratios / .* / times$", "ratio"), (r"file_bytes$", SAME), (r"scan_voxels$", SAME)],
    "bake_wide": [(r"over_two_bits / times$", "ratio"), (r"_times$", "ratio"), (r"file_bytes$", SAME)],
    "bake_error": [(r"wall_s$", "time"), (r"(missed_voxels|added_voxels|wrong_classes)$", SAME),
                   (r"mid_surface / (rms|max)_voxels$", SAME), (r"peak_rss_bytes$", "memory")],
    "bake_growth": [(r"cpu_s$", "time"), (r"file_bytes$", SAME), (r"peak_rss_bytes$", "memory")],
    "bake_plan": [(r"bytes_ratio$", SAME)],
    "tree_memory": [(r"_bytes", SAME)],
    "shell": [(r"points$|normal_error_deg / p50$|points_over_planar_bound$", SAME), (r"(wall|proof_wall)_s$", "time")],
    "cover": [(r"points$", SAME), (r"force_error$", 1.5), (r"frame_us / p50$", "time")],
    "query": [(r"frame_ns / p50$", "time"), (r"mean_points_in_band$", 1.5)],
    "force_part": [(r"/ (stiffness|bias|noise|direction_deg) / (median|p10|p90)$", SAME)],
    "wrench": [(r"(flush and smooth|corners and wedges|mesh pairs) / .* / (force_error|direction_deg)$", 1.6),
               (r"(flush and smooth|corners and wedges|mesh pairs) / .* / frame_us / p50$", "time")],
    "motion": [(r"(pendulum|pendulum, critical|bounce|spin) / .* / error", 1.02)],
    "trajectory": [(r"error_m / \d+$", 1.02)],
    "stability_table2": [(r"^(paper|default).* / penetration_ratio$", 1.5)],
    "stability_rest": [(r"quiet_share$", 1.3)],
    "stability_map": [(r"cells$", SAME)],
    "stability_device": [(r"(quiet_to|default|bound)$", SAME)],
    "skipped": [(r"(tree|left_out|nodes_of_64_voxels) / ", SAME), (r"of_no_skipping$", "ratio")],
    "paper_table": [(r"^points_at_1_khz / .* / points$", "ratio"),  # as many as the machine's speed allows
                    (r"^(?!points_at_1_khz).*(points|file_bytes|triangles)$", SAME)],
}


def identity(item, index):
    """The name of a list's item."""
    if not isinstance(item, dict):
        return str(index)
    keys = IDENTITY + (("points",) if "motion" in item else ()) + (("triangles",) if "series" in item else ())
    words = [format(item[k], ".6g") if isinstance(item[k], float) else str(item[k]) for k in keys
             if isinstance(item.get(k), (str, int, float))]
    return ", ".join(words) or str(index)


def figures(value, path=""):
    """Yields (name, number or text) of everything in a report's results."""
    if isinstance(value, dict):
        for key, item in value.items():
            yield from figures(item, f"{path} / {key}" if path else key)
    elif isinstance(value, list):
        for index, item in enumerate(value):
            name = identity(item, index)
            yield from figures(item, f"{path} / {name}" if path else name)
    elif value is not None:
        yield path, value


def write_csv(folder):
    for path in sorted(folder.glob("*.json")):
        with open(path.with_suffix(".csv"), "w", newline="") as file:
            rows = csv.writer(file)
            rows.writerow(["figure", "value"])
            rows.writerows(figures(json.loads(path.read_text())["results"]))


def moved(old, new, allowed):
    """Whether two values differ by more than the factor."""
    if isinstance(old, str) or isinstance(new, str) or isinstance(old, bool):
        return old != new
    if old == new:
        return False
    if old == 0 or new == 0 or (old < 0) != (new < 0):
        return True
    return abs(math.log(new / old)) > math.log(allowed)


def pairs_of(committed, new, patterns):
    """(name, old, new, allowed) of every figure that is compared and in both reports."""
    old = dict(figures(committed["results"]))
    for name, value in figures(new["results"]):
        for pattern, allowed in patterns:
            if name in old and re.search(pattern, name):
                yield name, old[name], value, allowed
                break


def compare_report(committed, new, patterns):
    """(how many figures were compared, lines about those that moved, the machine's pace)."""
    pairs = list(pairs_of(committed, new, patterns))
    ratios = [b / a for _, a, b, allowed in pairs if allowed == "time" and a > 0 and b > 0]
    pace = statistics.median(ratios) if ratios else None
    lines = []
    for name, a, b, allowed in pairs:
        expected, factor = a * pace if allowed == "time" else a, NOISE.get(allowed, allowed)
        if not moved(expected, b, factor):
            continue
        old, now = (x if isinstance(x, str) else format(x, ".4g") for x in (a, b))
        why = (f"{b / expected:.2f} of what the others would give" if allowed == "time"
               else f"noise: {100 * (factor - 1):.3g}%")
        lines.append(f"    {name}: {old}, now {now} ({why})")
    return len(pairs), lines, pace


def compare(committed_folder, new_folder):
    total, beyond = 0, 0
    print(f"Beside the committed figures ({committed_folder.name}):")
    for path in sorted(new_folder.glob("*.json")):
        new = json.loads(path.read_text())
        patterns = COMPARED.get(new["benchmark"], [])
        committed, whose = committed_folder / path.name, ""
        if not committed.exists():
            readme = (bench_scenes.ROOT / "README.md").read_text()
            committed = bench_scenes.readme_folder(readme) / path.name
            patterns = [(name, allowed) for name, allowed in patterns if allowed not in NOISE]
            whose = f" that go with no machine, beside {committed.parent.name}"
        if not committed.exists():
            print(f"  {path.stem}: nothing committed to compare with")
            continue
        count, lines, pace = compare_report(json.loads(committed.read_text()), new, patterns)
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
    elif len(words) == 2 and words[0] == "csv":
        write_csv(pathlib.Path(words[1]))
    elif len(words) == 3 and words[0] == "compare":
        compare(pathlib.Path(words[1]), pathlib.Path(words[2]))
    else:
        print(__doc__.split("\n\n")[1], file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
