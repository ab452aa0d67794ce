#!/usr/bin/env python3
"""The README's figures come from the committed results: checks that they do, or writes them.

Usage: readme_figures.py [--write] [--readme FILE] [--results FOLDER]

Every claim below is a passage of the README with placeholders, and a function that fills them from
the JSON beside this script. Without --write: every claim stands in the README exactly once and as
filled, the tables are those that bake_table.py and paper_table.py print, and in the sections of measurements no number
stands outside a claim. With --write the README is brought up to the results. Exit status: 0 the
README agrees, 1 it does not (a line says where), 2 wrong usage.
"""

import argparse
import json
import pathlib
import re
import subprocess
import sys

import bench_scenes

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
EPYC = HERE / "results" / "amd-epyc"
EPYC_AVX2 = HERE / "results" / "amd-epyc-avx2"
# Sections in which every number must be part of a claim, of the table or of a file's name.
MEASURED_SECTIONS = ("What stays put", "How large a part can be felt", "How fast a scene bakes",
                     "Run time against error")


class Results:
    """The results of every report of a folder, by its name without .json."""

    def __init__(self, folder):
        self.folder = folder

    def report(self, name):
        path = self.folder / f"{name}.json"
        if not path.exists():
            raise Untrue(f"there is no {path.name}")
        return json.loads(path.read_text())

    def __call__(self, name):
        return self.report(name)["results"]

    def machine(self, name):
        return self.report(name)["machine"]


class Untrue(Exception):
    """A passage whose words, not only its numbers, are no longer what was measured."""


def must(condition, what):
    if not condition:
        raise Untrue(what)


# How numbers are written.

def digits(value, figures=2):
    """So many significant digits, no exponent: 9.0, 47, 1340."""
    if value == 0:
        return "0"
    text = f"{value:.{figures}g}"
    if "e" not in text:
        return text if "." in text or abs(value) >= 10 ** (figures - 1) else f"{value:.{figures - 1}f}"
    return f"{float(text):.0f}" if abs(value) >= 1 else f"{float(text):.12f}".rstrip("0")


def span(values, figures=2, unit=""):
    low, high = digits(min(values), figures), digits(max(values), figures)
    return f"{low}{unit}" if low == high else f"{low} to {high}{unit}"


def percent(share, figures=2):
    return f"{digits(100 * share, figures)}%"


def thousands(n):
    return f"{n:,}"


def listed(words):
    words = list(words)
    return words[0] if len(words) == 1 else ", ".join(words[:-1]) + " and " + words[-1]


# Where the figures are.

def query_ns(results, motion, points, method="all skipping", percentile="p50", report="query"):
    for row in results(report)["rows"]:
        if row["motion"] == motion and row["points"] == points and method in row["methods"]:
            return row["methods"][method]["frame_ns"][percentile]
    raise Untrue(f"{report}.json has no '{method}' for {points} points, {motion}")


def bake_rows(results):
    return [row for path in sorted(results.folder.glob("bake_*.json"))
            if json.loads(path.read_text())["benchmark"] == "bake"
            for row in json.loads(path.read_text())["results"]]


# The claims: a passage, and what fills it.

def stays_put(results):
    table, rest, maps = results("stability_table2"), results("stability_rest"), results("stability_map")
    own, paper = table["default"], table["paper, braking"]
    must(own["penetration_frames"] == 0, "a point of the default model got through")
    must(own["force_layer_frames"] >= 1e6, "fewer than a million contact frames")
    must(rest["default"]["quiet"] == rest["default"]["trials"], "a press does not come to rest")
    cells = "".join(line["cells"] for one in maps["default"] for line in one["rows"])
    must("X" not in cells, "a setting of the map does not calm")
    return {"paper": percent(paper["penetration_ratio"]), "quiet": rest["default"]["quiet"],
            "trials": rest["default"]["trials"],
            "paper_quiet": rest["paper"]["quiet"]}


def loop(results):
    run = results("loop")
    causes, wake = run["miss_causes"], run["wakeup_ns"]
    must(run["penetration_frames"] == 0, "a frame of the loop's run penetrates")
    return {"frames": thousands(run["frames"]), "p50": f"{wake['p50'] / 1e3:.0f}",
            "p99": f"{wake['p99'] / 1e3:.0f}", "p999": f"{wake['p999'] / 1e3:.0f}",
            "misses": run["deadline_misses"],
            "share": percent(run["deadline_misses"] / run["frames"], 1), "late": causes["woke late"],
            "worst": f"{wake['max'] / 1e6:.0f}", "trips": run["output_trips"]}


def query(results):
    million, every = 10 ** 6, query_ns(results, "everything", 10 ** 6)
    isa = results("query")["instruction_set"]
    return {"p50": f"{query_ns(results, 'wall', million) / 1e3:.0f}",
            "p99": f"{query_ns(results, 'wall', million, percentile='p99') / 1e3:.0f}",
            "brute": f"{query_ns(results, 'wall', million, 'no skipping') / query_ns(results, 'wall', million):.0f}",
            "vdb": f"{query_ns(results, 'wall', million, 'OpenVDB ValueAccessor') / query_ns(results, 'wall', million):.0f}",
            "fcl": digits(query_ns(results, "wall", million, "FCL meshes, contacts") / query_ns(results, "wall", million)),
            "every": digits(every / 1e6), "isa": INSTRUCTION_SETS.get(isa, isa),
            "corner": digits(query_ns(results, "corner", million, "FCL meshes, contacts") / query_ns(results, "corner", million))}


def shell(results):
    meshes = results("shell")["meshes"]
    full = [row for row in meshes if row["method"] == "surface"]
    fast = [row["points_over_planar_bound"] for row in meshes if row["method"] == "fast"]
    scans = [r["share_of_voxel_centers"] for r in full if r["mesh"] in ("bunny", "dragon")]
    flat = [r["share_of_voxel_centers"] for r in full if r["mesh"] not in ("bunny", "dragon")]
    large = {row["method"]: row for row in results("shell_dragon_985")["meshes"]}
    must(large["surface"]["points"] >= 1e6, "shell_dragon_985.json has fewer than a million points")
    return {"bound": span([r["points_over_planar_bound"] for r in full], 3),
            "fast": digits(max(fast), 3), "scans": span([100 * s for s in scans]) + "%",
            "flat": span([100 * s for s in flat]) + "%",
            "wall": f"{large['surface']['wall_s']:.0f}",
            "mb": f"{large['surface']['peak_rss_bytes'] / 1e6:.0f}",
            "times": digits(large["surface"]["wall_s"] / large["fast"]["wall_s"])}


def scan_target(results):
    rows = bake_rows(results)
    ratio = {(r["model"], r["voxels_across"]): r["ratios"]["straightforward_scan"] for r in rows}
    met = [f"the {model} at {across} voxels" for (model, across), r in sorted(ratio.items()) if r["met"]]
    fine = [r["times"] for (_, across), r in ratio.items() if across >= 1024 and not r["met"]]
    coarse = [r["times"] for (_, across), r in ratio.items() if across < 1024]
    must(met and fine and not any(r["met"] for (_, a), r in ratio.items() if a < 1024),
         "the scan's target is met elsewhere than the passage says")
    missed = [f"the {row['model']} at {row['voxels_across']} ({r['times']:.1f} times of {r['target']:g})"
              for row in rows for key, r in row["ratios"].items()
              if key != "straightforward_scan" and not r.get("met", True)]
    return {"met": listed(met), "fine": span(fine), "coarse": span(coarse),
            "other": f"missed only for {listed(missed)}" if missed else "met by all of them"}


def wide(_):
    """Of another machine than the rest: the runs that have all kinds of voxels."""
    results = Results(EPYC)
    rows, narrow = results("bake_wide"), results("bake_wide_avx2")
    coarse, narrow_coarse = results("bake_wide_coarse"), results("bake_wide_coarse_avx2")
    must(all(results.machine(report)["vectors"] == "AVX2" for report in ("bake_wide_avx2", "bake_wide_coarse_avx2")),
         "the vectors are others")
    must({row["voxels_across"] for row in coarse + narrow_coarse} == {128}, "coarse is something else")

    def of(kind, figure):
        return span([figure(row["kinds"][kind]) for row in rows])

    def times(kind):
        return kind["over_two_bits"]["times"]

    def command(kind):
        return kind["over_two_bits"]["command_times"]

    def files(row):
        return row["vdb_bytes"] / row["kinds"]["8 bits"]["file_bytes"]
    must(all(kind["vdb_tool_times"] > 1 for row in rows + narrow + coarse + narrow_coarse for kind in row["kinds"].values()),
         "vdb_tool is ahead of a bake")
    target = rows[0]["kinds"]["8 bits"]["over_two_bits"]["target"]
    must(all(figure(row["kinds"]["8 bits"]) <= target for row in rows for figure in (times, command)),
         "8 bits miss the target")
    must(all(command(row["kinds"][kind]) <= target for row in coarse for kind in ("4 bits", "8 bits")),
         "the command misses the target at 128")
    must(all(times(row["kinds"]["8 bits"]) > target for row in coarse + narrow_coarse),
         "the bake alone meets the target at 128")
    must(all(times(row["kinds"]["4 bits"]) <= target for row in rows), "4 bits miss the target")
    before = Results(EPYC_AVX2)("bake_wide")  # of older code
    missed = [f"the {row['model']} at {row['voxels_across']} ({digits(times(row['kinds']['8 bits']))})"
              for row in narrow if times(row["kinds"]["8 bits"]) > target]
    return {"four": of("4 bits", command), "eight": of("8 bits", command),
            "euclidean": of("two bits, euclidean", command), "target": digits(target, 1),
            "memory": of("8 bits", times), "narrow": span([times(row["kinds"]["8 bits"]) for row in narrow]),
            "coarse": span([times(row["kinds"]["8 bits"]) for row in coarse]),
            "narrow_coarse": span([times(row["kinds"]["8 bits"]) for row in narrow_coarse]),
            "coarse_command": span([command(row["kinds"]["8 bits"]) for row in coarse]),
            "missed": listed(missed), "before": span([times(row["kinds"]["8 bits"]) for row in before]),
            "vdb": of("8 bits", lambda kind: kind["vdb_tool_times"]), "files": span([files(row) for row in rows])}


def bake_error(results):
    rows = results("bake_error")
    ours = {(r["scene"], r["voxels_across"]): r for r in rows if r["program"] == "voxelize"}
    must(all(r["wrong_classes"] == r["missed_voxels"] == r["added_voxels"] == 0 for r in ours.values()),
         "voxelize has wrong voxels")

    def of(program, figure):
        return [figure(r, ours[r["scene"], r["voxels_across"]]) for r in rows if r["program"] == program]

    def times(r, own):
        return r["wall_s"] / own["wall_s"]

    def missed(r, _):
        return 100 * r["missed_voxels"] / r["touched_voxels"]

    def added(r, _):
        return 100 * r["added_voxels"] / r["touched_voxels"]
    volume = of("mesh-to-volume-0.5", times) + of("mesh-to-volume-0.866", times)
    rms = [r["mid_surface"]["rms_voxels"] for r in ours.values()]
    return {"scenes": len({scene for scene, _ in ours}), "volume": span(volume), "vtk": span(of("vtk", times)),
            "missed": span(of("mesh-to-volume-0.5", missed)) + "%",
            "added": span(of("mesh-to-volume-0.866", added)) + "%",
            "vtk_missed": digits(max(of("vtk", missed))) + "%", "rms": span(rms),
            "most": digits(max(r["mid_surface"]["max_voxels"] for r in ours.values()))}


def growth(results):
    rows = results("bake_growth")
    paper = next(r for r in rows if r["series"] == "paper")
    most = max((r for r in rows if r["series"] == "triangles"), key=lambda r: r["triangles"])
    return {"polygons": thousands(paper["triangles"]), "s": digits(paper["wall_s"]),
            "mb": digits(paper["peak_rss_bytes"] / 1e6), "file": digits(paper["file_bytes"] / 1e6),
            "many": f"{most['triangles'] / 1e6:.1f}", "across": most["voxels_across"],
            "many_s": digits(most["wall_s"]), "gb": digits(most["peak_rss_bytes"] / 1e9)}


def wrench(results):
    size = next(r for r in results("wrench") if r["s"] == 0.5)
    groups = {"smooth": "flush and smooth", "sharp": "corners and wedges", "meshes": "mesh pairs"}
    methods = {"default": "default", "paper": "paper: tangent plane, N/10", "set": "shell in a trilinear level set",
               "fcl": "FCL mesh contacts", "bullet": "Bullet mesh contacts"}
    values = {}
    for group, group_name in groups.items():
        rows = size["contacts"][group_name]
        own = rows["default"]["frame_us"]["p50"]
        for method, name in methods.items():
            values[f"{group}_{method}"] = percent(rows[name]["force_error"])
            values[f"{group}_{method}_times"] = digits(rows[name]["frame_us"]["p50"] / own)
    rows = size["contacts"]["mesh pairs"]
    must(rows[methods["set"]]["force_error"] < rows["default"]["force_error"], "the level set is no truer between meshes")
    noticeable = size["contacts"]["flush and smooth"]["default"]["of_noticeable"]["force"]
    return {**values, "noticeable": digits(noticeable), "us": digits(size["contacts"]["flush and smooth"]["default"]["frame_us"]["p50"])}


def kinds(_):
    """Of another machine than the rest: the run that knows all kinds of voxels."""
    results = Results(EPYC_AVX2)
    size = next(r for r in results("wrench") if r["s"] == 0.5)
    values = {}
    for group, group_name in {"smooth": "flush and smooth", "sharp": "corners and wedges", "meshes": "mesh pairs"}.items():
        rows = size["contacts"][group_name]
        for bits, name in {"two": "default", "eight": "default, 8 bits", "set": "shell in a trilinear level set"}.items():
            values[f"{group}_{bits}"] = percent(rows[name]["force_error"])
    rows = size["contacts"]["flush and smooth"]
    own = rows["default"]["frame_us"]["p50"]
    return {**values, "time": digits(rows["default, 8 bits"]["frame_us"]["p50"] / own),
            "set_time": digits(rows["shell in a trilinear level set"]["frame_us"]["p50"] / own),
            "bytes": span([b["distance8"]["file_bytes"] / b["chebyshev"]["file_bytes"] for b in size["bill"].values()])}


def cover(results):
    rows = {(r["method"], round(r["asked_radius_voxels"], 3)): r for r in results("cover")}
    usual, dense, centres = rows["surface", 0.866], rows["surface", 0.5], rows["voxel centres", 0.866]
    def error(row, group):
        return percent(row["default"][group]["force_error"])
    def us(row):
        return row["default"]["frame_us"]["p50"]
    return {"points": digits(dense["points"] / usual["points"]), "time": digits(us(dense) / us(usual)),
            "smooth": error(usual, "flush and smooth"), "smooth_dense": error(dense, "flush and smooth"),
            "sharp": error(usual, "corners and wedges"), "sharp_dense": error(dense, "corners and wedges"),
            "centres": digits(centres["points"] / usual["points"]), "centres_time": digits(us(centres) / us(usual)),
            "centres_smooth": error(centres, "flush and smooth")}


def trajectory(results):
    rows = [r for r in results("trajectory") if r["model"] == "default" and r["stiffness_factor"] == 1
            and r["voxel_size_m"] == 0.005]
    at = rows[0]["rates_hz"].index
    return {"errors": listed(f"{digits(1e3 * r['error_m'][at(1000)])} mm ({r['motion']})" for r in rows),
            "gain": span([r["error_m"][at(1000)] / r["error_m"][at(4000)] for r in rows])}


def skipped(results):
    aircraft = next(r for r in results("skipped") if r["scene"] == "aircraft")
    q = aircraft["queries"][-1]
    ways, tree = q["ways"], q["tree"]
    return {"points": thousands(q["points"]), "looked": percent(ways["all skipping"]["points_looked_at"] / q["points"]),
            "times": digits(1 / ways["all skipping"]["of_no_skipping"]),
            "pages": ways["all skipping"]["pages_touched"], "all_pages": tree["pages_of_file"],
            "bricks": percent(tree["bricks_stored"] / tree["bricks_needed"]),
            "voxels": percent(tree["voxels_in_bricks"] / tree["voxels_in_box"])}


def machine(results):
    about = results.machine("wrench")
    return {"cores": about["cores"], "gcc": about["compiler"].split()[-1]}


INSTRUCTION_SETS = {"AVX3": "AVX-512", "AVX3_DL": "AVX-512"}  # as Highway calls them

CLAIMS = [
    ("In a million contact frames of simulated collisions no point got through (the paper's model: in {paper} of "
     "them), {quiet} of {trials} random presses come to rest ({paper_quiet} with the paper's), and no setting of "
     "stiffness, mass and rate in the map shakes by itself.", stays_put),
    ("Debian 12, no PREEMPT_RT): {frames} frames, none penetrating, and a replay of all of them is the same bit for bit. The loop woke late by "
     "{p50} us in the median, {p99} us at the 99th and {p999} us at the 99.9th percentile; {misses} frames ({share}) "
     "missed their deadline, {late} of them because the thread was woken late, up to {worst} ms when the virtual "
     "machine itself stood still: {trips} times late enough that the output went to zero and ramped in again.", loop),
    ("A part of a million points against a wall takes {p50} us a frame in the median, {p99} us at the 99th "
     "percentile (one core, {isa}). In the same run, on the same poses, it takes {brute} times as long without skipping, "
     "{vdb} times with an OpenVDB ValueAccessor on the same tree, and {fcl} times with FCL's mesh contacts. Only points "
     "that can be near are looked at, and those found are always the same as if all had been. In a corner of three "
     "walls FCL takes {corner} times our time, and a part in contact all over takes us {every} ms, beyond a 1 ms frame.",
     query),
    ("A shell has {bound} times the points that a plane would need at the same covering radius ({fast} at most with "
     "`--effort fast`): on scanned surfaces {scans}, on parts with flat faces {flat} of the voxel centres that the "
     "paper takes. A million points take {wall} s and {mb} MB on two cores; `--effort fast` is {times} times as fast.",
     shell),
    ("The scan is meant to be five times as fast. It is so for {met}, {fine} times for the others at 1024 and more, and "
     "{coarse} times at 512, where a triangle covers few voxels and what it costs by itself weighs most", scan_target),
    ("The other targets are {other}. `scripts/bench.sh bake` measures it", scan_target),
    ("Voxels that store distances cost more: from mesh file to `.vox`, of four models at 512 and 1024 voxels across, the "
     "command takes {four} times as long at 4 bits, {eight} times at 8 bits, as at two bits, and {euclidean} times with Euclidean layers. It is meant to be at most {target} times, and "
     "at these sizes is so, as it is for the bake alone, from triangles in memory to the file: {memory} times as long at 8 bits. Held to AVX2 that takes {narrow} times, "
     "more than {target} for {missed}, where triangles cover few voxels; on a processor without AVX-512 older code took "
     "{before} times, which has not been measured again. At 128 voxels, where triangles are about as small as one, the command takes "
     "{coarse_command} times as long at 8 bits, while the bake alone misses that: {coarse} times, held to AVX2 {narrow_coarse}. "
     "All this is of two cores of an AMD EPYC, a virtual machine that others use too; on two others of that name, where programs "
     "start faster and new memory costs less, the command took up to 3.6 times as long, the bake alone up to 4.7 on one (older code; held to AVX2 5.7) "
     "and 5.3 on the other (the engine at 512, the rest at most 4.6). `vdb_tool`, which writes the same distances as floats, takes {vdb} "
     "times as long as the bake of 8 bits, into a file {files} times as large.", wide),
    ("What a finer voxel costs and buys, on {scenes} scenes at 32 to 256 voxels across, each as one object. Finding the "
     "voxels that the mesh touches takes `meshToVolume` {volume} times, and `vtkVoxelModeller` {vtk} times, as long "
     "as the whole bake into the file takes us. Against the exact test, voxel by voxel, ours has none wrong; "
     "`meshToVolume` misses {missed} (centres within 0.5 voxel) or adds {added} (0.866), VTK misses up to "
     "{vtk_missed}. The force layer's mid-surface is {rms} voxel RMS from an offset of the exact mesh (by VTK's "
     "locator), at most {most}: Chebyshev layers stand further off along a diagonal.", bake_error),
    ("A generated aircraft bay of {polygons} polygons at 5 mm takes {s} s, {mb} MB of memory and a file of {file} MB "
     "(the paper's own scene of that size: 70 s and 21 MB, on a machine of 1998: no comparison of methods); one of "
     "{many} million at {across} voxels across {many_s} s and {gb} GB.", growth),
    ("At 5 mm, on flush and smooth contacts of spheres, boxes, cylinders, cones and tori, the force of `default` is "
     "{smooth_default} off the exact one ({noticeable} of what a hand can just notice), in {us} us a frame; the paper's "
     "{smooth_paper}, the same shell in a level set {smooth_set} in {smooth_set_times} times that time, FCL's mesh "
     "contacts {smooth_fcl} in {smooth_fcl_times}, Bullet's {smooth_bullet} in {smooth_bullet_times} times. At corners, "
     "edges and in wedges it is {sharp_default}, {sharp_paper}, {sharp_set}, {sharp_fcl} and {sharp_bullet} in that "
     "order. Between meshes, which mostly touch at a few points, {meshes_default}, {meshes_paper}, {meshes_set}, "
     "{meshes_fcl} and {meshes_bullet}: where features are few voxels wide, the layers of the map are too coarse, and the "
     "level set is truer.", wrench),
    ("With `--bits 8`, which stores a distance in each voxel, the error is {smooth_eight} in place of {smooth_two} (flush and "
     "smooth), {sharp_eight} in place of {sharp_two} (corners, edges, wedges) and {meshes_eight} in place of {meshes_two} (between "
     "meshes), in {time} times the time of a frame; the level set has {smooth_set}, {sharp_set} and {meshes_set}, in {set_time} "
     "times. The file is {bytes} times as large (an AMD EPYC, one orientation of each contact; [plot and bill](tests/bench/METHOD.md)).", kinds),
    ("A covering radius of 0.5 voxel in place of the usual 0.866 takes {points} times the points and {time} times the "
     "time of a frame, and brings the error from {smooth} to {smooth_dense} on flush and smooth contacts and from "
     "{sharp} to {sharp_dense} elsewhere; voxel centres take {centres} times the points and {centres_time} times the "
     "time, for {centres_smooth} on the former.", cover),
    ("At 1 kHz a part in contact is, RMS, {errors} from where the same model takes it at a step of a microsecond, and "
     "{gain} times nearer at 4 kHz.", trajectory),
    ("With {points} points in the aircraft bay the contact query looks at {looked} of them, and a frame is {times} times "
     "as fast as without skipping; it touches {pages} of the file's {all_pages} pages. The tree stores {bricks} of the "
     "bricks that it needs, since equal ones are one, and these hold {voxels} of the box's voxels.", skipped),
    ("a part of as many points, a device of 15 N and 0.1 N m.", lambda results: {}),
    ("All of this is measured on {cores} cores of an Intel Xeon, a virtual machine, with gcc {gcc} on Debian 12; the dates "
     "stand in the plots and reports.", machine),
]

# Tables: their first line, and what prints them.
TABLES = [("| voxels across |", lambda results: bake_table(results)),
          ("|  | 1999 |", lambda results: paper_table(results))]


# Checking and writing.

def pattern_of(template):
    """Matches the passage whatever fills it and wherever its lines end. Its own words must stand at both
    ends: they bound the first and the last placeholder."""
    assert not template.startswith("{") and not template.endswith(("}", "}.")), template
    out = []
    for part in re.split(r"(\{\w+\})", template):
        if re.fullmatch(r"\{\w+\}", part):
            out.append("(.{1,200}?)")
        else:
            out += [r"\s+" if piece.isspace() else re.escape(piece) for piece in re.split(r"(\s+)", part) if piece]
    return re.compile("".join(out), re.DOTALL)


def filled(template, values):
    """The placeholders' texts, in their order."""
    return [str(values[name]) for name in re.findall(r"\{(\w+)\}", template)]


def apply_claims(text, results):
    """The README brought up to the results, the spans of its claims, and what was amiss."""
    faults, spans = [], []
    for template, figures in CLAIMS:
        head = template[:60]
        try:
            wanted = filled(template, figures(results))
        except Untrue as untrue:
            faults.append(f"'{head}...' is no longer true: {untrue}")
            continue
        found = list(pattern_of(template).finditer(text))
        if len(found) != 1:
            faults.append(f"'{head}...' stands in the README {len(found)} times, not once")
            continue
        match = found[0]
        names = re.findall(r"\{(\w+)\}", template)
        pieces, at = [], match.start()
        for group, (name, new) in enumerate(zip(names, wanted), 1):
            old = " ".join(match.group(group).split())
            if old != new:
                faults.append(f"'{head}...': {{{name}}} is '{old}' in the README, '{new}' in the results")
            pieces += [text[at:match.start(group)], match.group(group) if old == new else new]
            at = match.end(group)
        pieces.append(text[at:match.end()])
        passage = "".join(pieces)
        text = text[:match.start()] + passage + text[match.end():]
        spans.append(passage)
    return text, spans, faults


def printed(*command):
    run = subprocess.run([sys.executable, *map(str, command)], check=True, capture_output=True, text=True)
    return [line for line in run.stdout.splitlines() if line.startswith("|")]


def bake_table(results):
    return printed(HERE / "bake_table.py", *sorted(results.folder.glob("bake_*.json")))


def paper_table(results):
    results.report("paper_table")
    return printed(HERE / "paper_table.py", "--table", results.folder / "paper_table.json")


def apply_tables(text, results):
    lines, faults = text.split("\n"), []
    for head, table_of in TABLES:
        first = next((i for i, line in enumerate(lines) if line.startswith(head)), None)
        if first is None:
            faults.append(f"the table '{head}' is not there")
            continue
        last = first
        while lines[last].startswith("|"):
            last += 1
        try:
            table = table_of(results)
        except Untrue as untrue:
            faults.append(f"the table '{head}' cannot be made: {untrue}")
            continue
        if lines[first:last] != table:
            faults.append(f"the table '{head}' is not that of the results")
        lines[first:last] = table
    return "\n".join(lines), faults


def unclaimed(text, passages):
    """Numbers in sections of measurements that no claim covers."""
    for passage in passages:
        text = text.replace(passage, " ")
    faults = []
    for section in re.split(r"^## ", text, flags=re.MULTILINE)[1:]:
        title, _, body = section.partition("\n")
        if title not in MEASURED_SECTIONS:
            continue
        body = re.sub(r"^(\||    ).*$", "", body, flags=re.MULTILINE)      # tables and commands
        body = re.sub(r"AVX-512|`[^`]*`|\]\([^)]*\)|!\[[^\]]*\]", " ", body)        # code, links, pictures
        for line in body.splitlines():
            if re.search(r"\d", line):
                faults.append(f"'{title}': no claim covers the number in '{line.strip()}'")
    return faults


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0], prog="readme_figures.py")
    parser.add_argument("--write", action="store_true", help="bring the README up to the results")
    parser.add_argument("--readme", type=pathlib.Path, default=ROOT / "README.md")
    parser.add_argument("--results", type=pathlib.Path, help="default: where the README's plots are")
    arguments = parser.parse_args()
    old = arguments.readme.read_text()
    results = Results(arguments.results or bench_scenes.readme_folder(old))
    text, passages, faults = apply_claims(old, results)
    text, table_faults = apply_tables(text, results)
    faults += table_faults
    if arguments.write and text != old:
        arguments.readme.write_text(text)
        print(f"wrote {arguments.readme}")
        text, passages, faults = apply_claims(text, results)  # what is left needs a person
    faults += unclaimed(text, passages)
    for fault in faults:
        print(f"readme_figures.py: {fault}", file=sys.stderr)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
