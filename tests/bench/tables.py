#!/usr/bin/env python3
"""Fills the tables of the pages, and of the project's README, from the CSV files in results/.

Usage: tables.py [--check]

A table stands between `<!-- table: NAME -->` and `<!-- end of table -->`; TABLES says what NAME shows. One table is
written for each machine that has the file. With --check nothing is written. Exit status: 0 done or all equal, 1 a
document differs from its tables (a line says which), 2 wrong usage.
"""

import math
import pathlib
import re
import sys

import bench_csv
import readme_figures

HERE = pathlib.Path(__file__).resolve().parent
DOCUMENTS = [HERE.parent.parent / "README.md", *sorted(HERE.glob("*.md"))]
MARKED = re.compile(r"<!-- table: (\w+) -->\n.*?<!-- end of table -->", re.DOTALL)


# How numbers are written.

def digits(value, figures=2):
    """So many significant digits, thousands apart: 9.0, 47, 1,340; with an exponent what is very small or large."""
    if value is None:
        return ""
    if value == 0:
        return "0"
    if not 1e-4 <= abs(value) < 1e9:
        return f"{value:.{figures - 1}e}"
    rounded = float(f"{value:.{figures}g}")
    decimals = max(0, figures - 1 - math.floor(math.log10(abs(rounded))))
    return f"{rounded:,.{decimals}f}"


def percent(value, figures=2):
    if value is None:
        return ""
    return "< 0.001%" if 0 < value < 1e-5 else digits(100 * value, figures) + "%"


def times(value, base, figures=2):
    return "" if value is None or base is None else digits(value / base, figures)


def pair(*values, figures=3):
    return " / ".join(digits(v, figures) or "-" for v in values)


def scaled(key, factor=1.0, figures=3):
    """A column of one figure."""
    return lambda row: "" if row[key] is None else digits(factor * row[key], figures)


def text(key):
    """A column of a word or a count."""
    return lambda row: "" if row[key] is None else f"{row[key]:,}" if isinstance(row[key], int) else str(row[key])


def share(key, figures=2):
    return lambda row: percent(row[key], figures)


# How rows are chosen.

def where(**wanted):
    """Rows whose columns have these values; a tuple lists several."""
    def chosen(rows):
        return [row for row in rows if all(row[key] in (value if isinstance(value, tuple) else (value,))
                                           for key, value in wanted.items())]
    return chosen


def by(column, keys, rows):
    """One row for each value of `keys`: its first row, with `of`, the rows by `column`."""
    merged = {}
    for row in rows:
        one = merged.setdefault(tuple(row[key] for key in keys), {**row, "of": {}})
        one["of"].setdefault(row[column], row)
    return list(merged.values())


def pivoted(column, *keys, then=lambda rows: rows):
    return lambda rows: by(column, keys, then(rows))


def wrench_rows(rows):
    """One row for each group and method at 5 mm, with `of`, its figures."""
    groups = bench_csv.WRENCH_GROUPS
    return by("figure", ("contacts", "method"), sorted(where(voxel_m=0.005, contacts=groups)(rows),
                                                       key=lambda r: groups.index(r["contacts"])))


def median_of(spread, write=percent):
    """The median, and the interval that holds it with 95%."""
    low, high = spread["median_low"], spread["median_high"]
    return write(spread["p50"]) + ("" if low is None else f" ({write(low)} - {write(high)})")


def told(figure, write=percent):
    """A figure of wrench_rows()."""
    return lambda row: median_of(row["of"][figure], write) if figure in row["of"] else ""


def quartiles(figure, low="p25", high="p75"):
    return lambda row: f"{percent(row['of'][figure][low])} - {percent(row['of'][figure][high])}"


def of_kind(row, kind):
    """Processor time, s, and size, MB, of a kind of map."""
    return row["of"][kind]["cpu_s"], row["of"][kind]["file_bytes"] / 1e6


def grips(rows):
    """One row for all arms, axes and clutches."""
    groups = {}
    for row in rows:
        groups.setdefault(tuple(row[key] for key in ("run", "model", "scale", "delay_s", "hand")), []).append(row)
    summed = []
    for (run, model, scale, delay_s, hand), group in groups.items():
        steps = [row["swing_steps"] for row in group]
        given, over = ([row[key] for row in group if row.get(key) is not None] for key in ("given_j", "over_j"))
        summed.append({"run": run, "model": model, "scale": scale, "delay_s": delay_s, "hand": hand,
                       "grips": len(group), "quiet": sum(row["quiet"] for row in group),
                       "swing_steps": None if None in steps else max(steps),
                       "given_j": max(given, default=None), "over_j": max(over, default=None)})
    return summed


SEAT_QUANTILES = (0.5, 0.9, 1)


def seats(rows):
    """One row for all pairs of a kind, and one for all."""
    groups = {}
    for row in rows:
        for kind in (row["pair"], "all"):
            groups.setdefault((row["run"], kind), []).append(row)
    summed = []
    for (run, kind), group in sorted(groups.items(), key=lambda item: (item[0][0], item[0][1] == "all")):
        seated = [row for row in group if not row["refused"]]
        depths = {of: sorted(row[column] for row in seated)
                  for of, column in (("depth", "depth_voxels"), ("edges", "edge_depth_voxels"))}
        summed.append({
            "run": run, "covering_voxels": group[0]["covering_voxels"], "pair": kind, "pairs": len(group),
            "refused": len(group) - len(seated),
            **{most: max(row[column] for row in seated) for most, column in (
                ("drift", "drift_voxels"), ("force", "still_force_n"), ("start", "start_depth_voxels"))},
            **{of: pair(*(values[max(0, math.ceil(share * len(values)) - 1)] for share in SEAT_QUANTILES), figures=2)
               for of, values in depths.items()},
            **{f"deep_{of}": sum(depth > 0.6 for depth in values) for of, values in depths.items()},
            "touching": sum(row["touching"] for row in seated) / len(seated),
            "out": f'{sum(row["came_out"] for row in seated)} of {len(seated)}',
            "back": f'{sum(row["went_back"] for row in seated)} of {sum(row["tried_back"] for row in seated)}'})
    return summed


def share_of(events, of, low, high):
    """3 of 8, and its interval."""
    return lambda r: f"{r[events]} of {r[of]} ({digits(100 * r[low], 2)} to {digits(100 * r[high], 2)}%)"


def pegs(rows):
    """One row for all tilts."""
    groups = {}
    for row in rows:
        groups.setdefault(tuple(row[key] for key in ("run", "map", "clearance_m", "chamfer_m")), []).append(row)
    summed = []
    for group in groups.values():
        trials, into = sum(row["trials"] for row in group), sum(row["in"] for row in group)
        low, high = readme_figures.share_95(into, trials)
        nearest = [row["nearest_m"] for row in group if row["nearest_m"] is not None]
        summed.append({**group[0], "trials": trials, "in": into, "low": low, "high": high,
                       "by_tilt": " / ".join(str(row["in"]) for row in group), "each": group[0]["trials"],
                       "room_voxels": group[0]["clearance_m"] / group[0]["voxel_m"],
                       "frames": sum(row["frames"] for row in group), "nearest_m": min(nearest, default=None),
                       "penetrating_frames": sum(row["penetrating_frames"] for row in group)})
    return summed


def least_squares(x, y):
    """The exponent e of y = factor x^e, and the largest factor between a y and it."""
    x, y = [math.log(v) for v in x], [math.log(v) for v in y]
    mean_x, mean_y = sum(x) / len(x), sum(y) / len(y)
    slope = sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y)) / sum((a - mean_x) ** 2 for a in x)
    return slope, math.exp(max(abs(b - mean_y - slope * (a - mean_x)) for a, b in zip(x, y)))


def growth(rows):
    """How time grows with the points of the shell (from 10^4), and with the points in contact: from query.csv."""
    def fit(motion, against, chosen):
        slope, off = least_squares([r[against] for r in chosen], [r["p50_us"] for r in chosen])
        return {"run": 1, "motion": motion, "against": against, "exponent": slope, "off": off,
                "method": chosen[0]["method"]}
    rows = [r for r in rows if r["run"] == 1]
    for motion in dict.fromkeys(r["motion"] for r in rows):
        for method in ("all skipping", "no skipping"):
            chosen = [r for r in rows if (r["motion"], r["method"]) == (motion, method) and r["points"] >= 1e4]
            if len(chosen) > 1:
                yield fit(motion, "points", chosen)
    chosen = [r for r in rows if r["method"] == "all skipping" and r["points_in_band"] >= 100]
    if len(chosen) > 1:
        yield fit("all", "points_in_band", chosen)


# Cells of several columns.

def of(item, key, factor=1.0, figures=3):
    return lambda row: digits(factor * row["of"][item][key], figures) if item in row["of"] else ""


def over(key, item, base):
    return lambda row: times(row["of"].get(item, {}).get(key), row["of"].get(base, {}).get(key))


def threads_ms(threads):
    return lambda row: digits(1e3 * row["of"][threads]["wall_s"], 3) if threads in row["of"] else ""


def speed_up(threads):
    return lambda row: times(row["of"][1]["wall_s"], row["of"][threads]["wall_s"]) if threads in row["of"] else ""


def processors(threads):
    return lambda row: times(row["of"][threads]["cpu_s"], row["of"][threads]["wall_s"]) if threads in row["of"] else ""


def long_stages(rows):
    """Stages of commands that take a hundredth of the whole on one thread; not those whose times are of objects side by side."""
    whole = {row["task"]: row["wall_s"] for row in rows if (row["stage"], row["threads"]) == ("whole", 1)}
    long = {(row["task"], row["stage"]) for row in rows if row["threads"] == 1 and row["wall_s"] > 0.01 * whole[row["task"]]}
    return [row for row in rows if (row["task"], row["stage"]) in long and row["stage"] not in ("whole", "scan", "flood", "cavities")]


def puzzles(rows):
    """Each row with `peer`, FCL's row of the same puzzle."""
    peers = {r["puzzle"]: r for r in rows if r["validity"] == "FCL"}
    return [{**r, "peer": peers[r["puzzle"]]} for r in rows]


def over_peer(key):
    """Ours over FCL's poses a second."""
    return lambda row: times(row[key], row["peer"]["poses_per_s"]) if row["validity"] == "voxplan" else ""


def p50_p99(item):
    return lambda row: pair(row["of"][item]["p50_us"], row["of"][item]["p99_us"]) if item in row["of"] else ""


QUERY_SIZES = [(10 ** n, f"10^{n} points") for n in range(2, 8)]
PEERS = [("no skipping", "no skipping"), ("scalar, no skipping", "scalar"),
         ("OpenVDB ValueAccessor", "ValueAccessor"), ("OpenVDB ValueAccessor, counting", "ValueAccessor, counting"),
         ("OpenVDB level set, trilinear", "level set"), ("FCL meshes, contacts", "FCL contacts"),
         ("FCL meshes, distance", "FCL distance")]
RATES = (250, 500, 1000, 2000, 4000)
STEPS = (0.004, 0.002, 0.001, 0.0005, 0.00025, 0.000125)
GROUPS = ("flush and smooth", "wedges", "wedges one offset")


def only_default(rows):
    return [row for row in rows if row["model"] == "default"]


def interval(row):
    if row["ratio_95_high"] is None:
        return ""
    return f"{digits(100 * row['ratio_95_low'])} to {digits(100 * row['ratio_95_high'])}%"


OUTCOME = [("model", text("model")), ("trials", text("trials")), ("contact frames", text("force_layer_frames")),
           ("penetrating", share("penetration_ratio", 3)), ("95% interval", interval),
           ("trials that penetrate", lambda r: str(r.get("penetrating_trials", ""))),
           ("energy, J", scaled("energy_generated_j_worst", 1, 2)),
           ("nearest / proven, mm", lambda r: pair(r["smallest_distance_m"] and 1e3 * r["smallest_distance_m"],
                                                   1e3 * r["guaranteed_m"]))]

PAPER_ROWS = {"bake_s": ("bake, s", 2), "bake_cpu_s": ("bake, s of processor time", 2), "file_bytes": ("file, MB", 2), "part_points": ("points of a part of 75 mm", 3),
              "points_at_1_khz": ("points at 1 kHz", 2)}


def paper_rows(rows):
    """The paper's penetration ratios are beside the collisions. Where no shell was slow enough, the largest one's points are a bound."""
    reached = {row["run"]: row for row in rows if row["figure"] == "points_at_1_khz_reached"}
    return [{**row, "reached": reached[row["run"]] if row["figure"] == "points_at_1_khz" else {}} for row in rows
            if row["figure"] != "points_at_1_khz_reached" and not row["figure"].startswith("penetration")]


def paper_cell(column):
    def cell(row):
        value = row[column]
        if row["reached"].get(column) == 0:
            return f"> {value:,}"
        return "" if value is None else digits(value / 1e6 if row["figure"] == "file_bytes" else value,
                                               PAPER_ROWS.get(row["figure"], ("", 6))[1])
    return cell


# Each table: its file, which of its rows it shows, and its columns.
TABLES = {
    "bake": ("bake", list, [
        ("model", text("model")), ("voxels across", text("voxels")),
        ("scan: straightforward / ours, ms", lambda r: pair(1e3 * r["straightforward_s"], 1e3 * r["scan_1_thread_s"])),
        ("times", lambda r: times(r["straightforward_s"], r["scan_1_thread_s"])),
        ("scan: `meshToVolume` / ours, ms", lambda r: pair(1e3 * r["mesh_to_volume_s"], 1e3 * r["scan_s"])),
        ("times", lambda r: times(r["mesh_to_volume_s"], r["scan_s"])),
        ("bake: `vdb_tool` / lean Chebyshev, ms", lambda r: pair(1e3 * r["vdb_tool_bake_s"], 1e3 * r["bake_s"])),
        ("times", lambda r: times(r["vdb_tool_bake_s"], r["bake_s"])),
        ("command: `vdb_tool` / lean Chebyshev, ms", lambda r: pair(1e3 * r["vdb_tool_s"], 1e3 * r["command_s"])),
        ("times", lambda r: times(r["vdb_tool_s"], r["command_s"])),
        ("peak memory: `vdb_tool` / lean Chebyshev, MB", lambda r: pair(r["vdb_tool_peak_bytes"] / 1e6, r["peak_bytes"] / 1e6)),
        ("file: `.vdb` / lean Chebyshev, MB", lambda r: pair(r["vdb_bytes"] / 1e6, r["file_bytes"] / 1e6))]),
    "bake_kinds": ("bake_kinds", pivoted("kind", "run", "model", "voxels"), [
        ("vectors", text("vectors")), ("model", text("model")), ("voxels across", text("voxels")),
        ("bake: lean Chebyshev, ms", of("lean, chebyshev", "bake_s", 1e3)),
        *((f"{kind}, times", over("bake_s", kind, "lean, chebyshev")) for kind in ("lean", "full")),
        ("command: lean Chebyshev, ms", lambda r: scaled("command_s", 1e3)(r["of"]["lean, chebyshev"])),
        *((f"{kind}, times", over("command_s", kind, "lean, chebyshev")) for kind in ("lean", "full")),
        ("bake: `vdb_tool` over full", lambda r: times(r["vdb_tool_bake_s"], r["of"]["full"]["bake_s"])),
        ("command: `vdb_tool` over full", lambda r: times(r["vdb_tool_s"], r["of"]["full"]["command_s"])),
        ("bake: `meshToVolume` over full", lambda r: times(r["mesh_to_volume_s"], r["of"]["full"]["bake_s"])),
        ("file: `.vdb` / full / lean Chebyshev, MB", lambda r: pair(
            r["vdb_bytes"] / 1e6, *(r["of"][kind]["file_bytes"] / 1e6 for kind in ("full", "lean, chebyshev"))))]),
    "bake_error": ("bake_error", where(voxels=256), [
        ("scene", text("scene")), ("program", text("program")), ("time, ms", scaled("wall_s", 1e3)),
        ("peak memory, MB", scaled("peak_bytes", 1e-6)),
        ("missed", lambda r: percent(r["missed_voxels"] / r["touched_voxels"])),
        ("added", lambda r: percent(r["added_voxels"] / r["touched_voxels"])), ("wrong voxels", text("wrong_voxels")),
        ("RMS, voxels", scaled("rms_voxels")), ("largest, voxels", scaled("max_voxels")),
        ("proven, mm", scaled("proven_m", 1e3))]),
    "bake_growth": ("bake_growth", lambda rows: [r for r in rows if r["series"] != "resolution" or r["voxels"] >= 1000], [
        ("series", text("series")), ("scene", text("scene")), ("voxel, mm", scaled("voxel_m", 1e3)),
        ("voxels across", text("voxels")), ("triangles", text("triangles")), ("command, s", scaled("wall_s")),
        ("CPU, s", scaled("cpu_s")), ("of it reading, s", scaled("read_s")), ("peak memory, MB", scaled("peak_bytes", 1e-6)),
        ("file, MB", scaled("file_bytes", 1e-6))]),
    "bake_streams": ("bake_streams", list, [
        ("triangles", text("triangles")), ("of the largest part", text("largest_part_triangles")),
        ("command, s", scaled("wall_s")), ("CPU, s", scaled("cpu_s")), ("peak memory, MB", scaled("peak_bytes", 1e-6)),
        ("in the temporary file, MB", scaled("on_disk_bytes", 1e-6)), ("file, MB", scaled("file_bytes", 1e-6))]),
    "bake_plan": ("bake_plan", list, [
        ("scene", text("scene")), ("voxel, mm", scaled("voxel_m", 1e3)),
        ("file: planned / true, MB", lambda r: pair(r["planned_bytes"] / 1e6, r["file_bytes"] / 1e6)),
        ("ratio", lambda r: times(r["planned_bytes"], r["file_bytes"])),
        ("bake: planned / true, ms", lambda r: pair(1e3 * r["planned_s"], 1e3 * r["bake_s"])),
        ("ratio", lambda r: times(r["planned_s"], r["bake_s"]))]),
    "tree_memory": ("tree_memory", list, [
        ("scene", text("scene")), ("box, voxels", text("dims")), ("force-layer voxels", text("surface_voxels")),
        *((f"tree, N = {n}, MB", scaled(f"tree_{n}_bytes", 1e-6)) for n in (1, 2, 3, 4)),
        ("file, `--lean`, MB", scaled("file_bytes", 1e-6)), ("file, default, MB", scaled("whole_bytes", 1e-6)),
        ("bytes a force-layer voxel: `.vox` / `.vdb` / dense", lambda r: pair(
            *(r[f"{kind}_bytes"] / r["surface_voxels"] for kind in ("file", "vdb", "dense"))))]),
    "shell": ("shell", lambda rows: [r for r in rows if r["voxels"] >= 256], [
        ("mesh", text("mesh")), ("voxels across", text("voxels")), ("method", text("method")), ("points", text("points")),
        ("rho / s", scaled("radius_voxels")), ("bound", scaled("points_over_bound")),
        ("share", share("share_of_voxel_centers")), ("n50, deg", scaled("normal_p50_deg", 1, 2)),
        ("n99, deg", scaled("normal_p99_deg", 1, 2)), ("weights", scaled("weights_over_area", 1, 6)),
        ("block / s", scaled("block_voxels", 1, 2)), ("wall, s", scaled("wall_s")), ("CPU, s", scaled("cpu_s")),
        ("peak memory, MB", scaled("peak_bytes", 1e-6)), ("proof, s", scaled("proof_s"))]),
    "shell_shapes": ("shell_shapes", where(voxels=128), [
        ("shape", text("shape")), ("method", text("method")), ("points", text("points")),
        ("near edges", text("points_near_edges")), ("n50, deg", scaled("normal_p50_deg", 1, 2)),
        ("n99, deg", scaled("normal_p99_deg", 1, 2)), ("largest, deg", scaled("normal_max_deg", 1, 2)),
        ("largest distance, voxels", scaled("distance_max_voxels", 1, 2))]),
    "cover": ("cover", only_default, [
        ("shell", text("method")), ("covering radius, voxels", scaled("radius_voxels")), ("points", text("points")),
        ("frame, us", scaled("frame_p50_us")), ("error: flush and smooth", share("smooth_error")),
        ("error: corners and wedges", share("sharp_error"))]),
    "query": ("query", pivoted("points", "motion", then=where(method="all skipping")), [
        ("motion", text("motion")), *((label, p50_p99(points)) for points, label in QUERY_SIZES)]),
    "query_peers": ("query", pivoted("method", "motion", "points", then=where(run=1, points=(100, 10 ** 5, 10 ** 6))), [
        ("motion", text("motion")), ("points", text("points")), ("ours, us", of("all skipping", "p50_us")),
        ("no coherence", over("p50_us", "no coherence", "all skipping")),
        *((label, over("p50_us", method, "all skipping")) for method, label in PEERS)]),
    "query_cold": ("query", pivoted("method", "motion", "points", then=where(motion="wall")), [
        ("points", text("points")), ("frames", text("frames")), ("warm, p50 / p99, us", p50_p99("all skipping")),
        ("cold frames", of("all skipping, cold", "frames")), ("cold, p50 / p99, us", p50_p99("all skipping, cold"))]),
    "query_kinds": ("query_kinds", pivoted("method", "points"), [
        ("points", text("points")), ("frames", text("frames")), ("full file, p50 / p99, us", p50_p99("all skipping")),
        *((f"{kind}, over it", over("p50_us", kind, "all skipping"))
          for kind in ("lean file, Euclidean layers", "lean file, Chebyshev layers"))]),
    "query_growth": ("query", growth, [
        ("motion", text("motion")), ("method", text("method")), ("against", lambda r: r["against"].replace("_", " ")),
        ("exponent", scaled("exponent", 1, 2)), ("off by at most, times", scaled("off", 1, 2))]),
    "force": ("force", pivoted("contact", "run", "method", then=where(s=0.5, contact=GROUPS)), [
        ("covering radius, voxels", scaled("cover")), ("method", text("method")),
        ("stiffness", of("flush and smooth", "stiffness", 1, 3)),
        *((key, lambda r, key=key: percent(r["of"]["flush and smooth"][key])) for key in ("bias", "noise")),
        ("deg", of("flush and smooth", "direction_deg", 1, 2)), ("torque", of("flush and smooth", "torque", 1, 2)),
        ("step", lambda r: percent(r["of"]["flush and smooth"]["step"])),
        ("wedges, deg", of("wedges", "direction_deg", 1, 2)),
        ("wedges, one offset, deg", of("wedges one offset", "direction_deg", 1, 2))]),
    "force_sizes": ("force", lambda rows: [r for r in rows if r["contact"] == "flush and smooth" and r["cover"] > 0.5
                                           and r["method"] in ("tangent plane, N/10", "level field", "8-bit distance")], [
        ("voxel, mm", scaled("s", 10)), ("method", text("method")), ("stiffness", scaled("stiffness", 1, 2)),
        ("bias", share("bias")), ("noise", share("noise")), ("deg", scaled("direction_deg", 1, 2)),
        ("torque", scaled("torque", 1, 2)), ("step", share("step"))]),
    "force_contacts": ("force", pivoted("method", "contact", then=lambda rows: [
        r for r in rows if r["s"] == 0.5 and r["cover"] > 0.5 and r["contact"] not in GROUPS]), [
        ("contact", text("contact")),
        *((label, lambda r, m=method: pair(r["of"][m]["direction_deg"], r["of"][m]["torque"], figures=2)
           if m in r["of"] else "")
          for method, label in (("tangent plane, N/10", "tangent plane"), ("level field", "level field"),
                                ("2-bit Euclidean, level", "Euclidean layers"), ("8-bit distance", "8 bits"),
                                ("exact, the map's standoff", "exact, at the map's standoff")))]),
    "force_cost": ("force_cost", list, [
        ("vectors", text("vectors")), ("part", text("part")), ("field", text("field")),
        ("collected points", text("collected_points")),
        ("ns a point", scaled("ns_per_point", 1, 2)), ("every brick new, ns a point", scaled("ns_per_point_new_bricks", 1, 2)),
        ("query, us", scaled("query_us", 1, 2))]),
    "wrench": ("wrench", wrench_rows, [
        ("contacts", text("contacts")), ("method", text("method")), ("skips", text("skips")), ("n", lambda r: str(r["of"]["force"]["n"])),
        ("force error", told("force")), ("quartiles", quartiles("force")), ("5%, 95%", quartiles("force", "p5", "p95")),
        ("frame, us", told("frame, us", digits)), ("n of frame", lambda r: str(r["of"]["frame, us"]["n"]))]),
    "wrench_more": ("wrench", wrench_rows, [
        ("contacts", text("contacts")), ("method", text("method")),
        *((figure, told(figure)) for figure in ("raw force", "pressing", "touching", "torque", "raw torque", "deviation", "noise")),
        ("direction, deg", told("direction, deg", digits))]),
    "wrench_pairs": ("wrench", lambda rows: by("method", ("contacts",), [
        r for r in rows if r["voxel_m"] == 0.005 and r["figure"] == "force" and r["contacts"] not in bench_csv.WRENCH_GROUPS]), [
        ("pair", text("contacts")), ("n", lambda r: str(r["n"])),
        *((label, lambda r, m=method: median_of(r["of"][m]))
          for method, label in (("default, distances", "default"), ("dense float distances, our query", "dense floats"),
                                ("exact closest points, our query", "exact points"),
                                ("default, Euclidean layers", "Euclidean layers"), ("default, Chebyshev layers", "Chebyshev layers"),
                                ("FCL contacts", "FCL contacts"), ("FCL distance", "FCL distance")))]),
    "wrench_commanded": ("wrench_commanded", list, [
        ("voxel, mm", scaled("voxel_m", 1e3)), ("presses", text("compared")), ("of more than ten contacts", text("many_contacts")),
        ("difference, median", share("off_p50")), ("most", share("off_max"))]),
    "wrench_files": ("wrench_files", where(voxel_m=0.005), [
        ("pair", text("pair")), ("kind", text("kind")), ("file, MB", scaled("file_bytes", 1e-6, 2)),
        ("bake, ms of processor time", scaled("bake_cpu_s", 1e3, 2))]),
    "motion": ("motion", pivoted("step_s", "experiment", "model"), [
        ("experiment", text("experiment")), ("model", text("model")),
        *((f"{1e3 * step:g} ms", lambda r, step=step: f"{r['of'][step]['error']:.1e}") for step in STEPS),
        ("order", lambda r: "exact" if r["order"] is None else f"{r['order']:.2f}")]),
    "motion_drift": ("motion_drift", list, [
        ("model", text("model")), ("frames", text("frames")),
        *((label, lambda r, key=key: f"{r[key]:.1e}")
          for label, key in (("momentum, relative", "momentum_relative"), ("energy, relative", "energy_relative"),
                             ("swing of energy, relative", "energy_swing_relative"), ("place, m", "place_m")))]),
    "trajectory": ("trajectory", pivoted("rate_hz", "motion", "model", "stiffness_factor", "voxel_m"), [
        ("motion", text("motion")), ("model", text("model")), ("stiffness, times", scaled("stiffness_factor")),
        ("voxel, mm", scaled("voxel_m", 1e3)), *((f"{rate} Hz, mm", of(rate, "error_m", 1e3, 2)) for rate in RATES)]),
    "stability_table2": ("stability", where(campaign="table2"), OUTCOME),
    "stability_field": ("stability_field", list, [
        ("field over coupling", lambda r: "as derived" if r["factor"] is None else digits(r["factor"])),
        ("field, N/m", scaled("field_n_per_m", 1, 2)), ("trials", text("trials")),
        ("contact frames", text("force_layer_frames")), ("penetrating", share("penetration_ratio", 2)),
        ("95% interval", interval), ("trials that penetrate", text("penetrating_trials")),
        ("energy, J", scaled("energy_generated_j", 1, 2))]),
    "stability_hands": ("stability_hands", list, [("run of", text("ran")), *OUTCOME]),
    "stability_rest": ("stability", where(campaign="rest"), [
        ("model", text("model")), ("trials", text("trials")), ("quiet", text("quiet")),
        ("last motion, s", scaled("settle_s_max")), ("largest cycle, voxels", scaled("cycle_voxels_max", 1, 2)),
        ("penetrating", share("penetration_ratio", 3))]),
    "stability_cases": ("stability", where(campaign="cases"), [
        ("case", text("case")), ("model", text("model")), ("penetrating", share("penetration_ratio")),
        ("guard cuts", share("guard_cut_share")), ("peak force, N", scaled("peak_force_n", 1, 2)),
        ("rest force, N", scaled("rest_force_n_p50", 1, 2)), ("cycle, voxels", scaled("cycle_voxels_max", 1, 2)),
        ("last motion, s", scaled("settle_s_max")), ("energy, J", lambda r: "> 1e6" if r["energy_generated_j_worst"] > 1e6 else digits(r["energy_generated_j_worst"])),
        ("progress", scaled("progress_p10", 1, 2)), ("stuck", share("stuck_share_p50")),
        ("force step, N", scaled("force_step_n_p99", 1, 2)),
        ("nearest / proven, mm", OUTCOME[-1][1]), ("lag, mm", scaled("lag_m_max", 1e3, 2)),
        ("not finite", text("non_finite_frames"))]),
    "stability_map": ("stability_map", pivoted("mass_kg", "model", "rate_hz"), [
        ("model", text("model")), ("rate, Hz", text("rate_hz")),
        *((state, lambda row, state=state: str(sum(line[k] == state for line in row["of"].values()
                                                   for k in bench_csv.STIFFNESSES)))
          for state in bench_csv.CELLS.values())]),
    "stability_device": ("stability_device", list, [
        ("task", lambda r: r["task"].split("_")[0]), ("model", text("model")), ("grip", text("grip")),
        ("delay, ms", scaled("delay_s", 1e3)), ("default", scaled("default", 1, 2)), ("bound", scaled("bound", 1, 2)),
        ("quiet up to", scaled("quiet_to", 1, 2))]),
    "stability_grips": ("stability_grips", grips, [
        ("run of", text("ran")), ("model", text("model")), ("scale", text("scale")), ("delay, ms", scaled("delay_s", 1e3)), ("hand", text("hand")),
        ("quiet", text("quiet")), ("of", text("grips")), ("most, encoder steps", scaled("swing_steps", 1, 2)),
        ("given at most, uJ", scaled("given_j", 1e6, 2)), ("beyond the sampled spring, uJ", scaled("over_j", 1e6, 2))]),
    "stability_loops": ("stability_loops", list, [
        ("run of", text("ran")), ("model", text("model")), ("start", text("start")), ("scale", text("scale")), ("loop", text("loop")), ("loops", text("loops")),
        ("given at most, uJ", scaled("given_j", 1e6, 2)), ("beyond the sampled spring, uJ", scaled("over_j", 1e6, 2)),
        ("beyond it by 20 uJ", text("over_bound"))]),
    "stability_seats": ("stability_seats", seats, [
        ("pair", text("pair")), ("covering radius", scaled("covering_voxels", 1, 2)), ("pairs", text("pairs")),
        ("refused", text("refused")), ("drift", scaled("drift", 1, 2)), ("still, N", scaled("force", 1, 2)),
        ("at the start", scaled("start", 1, 2)), ("depth: median / 90% / most", text("depth")),
        ("above 0.6", text("deep_depth")), ("edges: median / 90% / most", text("edges")),
        ("above 0.6", text("deep_edges")), ("meshes meet", share("touching", 2)), ("came out", text("out")),
        ("went back", text("back"))]),
    "assembly_peg": ("assembly_peg", pegs, [
        ("map", text("map")), ("clearance, mm", scaled("clearance_m", 1e3, 2)), ("voxels", scaled("room_voxels", 1, 2)),
        ("chamfer, mm", scaled("chamfer_m", 1e3, 2)), ("in at 0 / 2 / 4 degrees", text("by_tilt")), ("of each", text("each")),
        ("in, of all (95%)", share_of("in", "trials", "low", "high")), ("frames", text("frames")),
        ("penetrating", text("penetrating_frames")),
        ("nearest / proven, mm", lambda r: pair(r["nearest_m"] and 1e3 * r["nearest_m"], 1e3 * r["guaranteed_m"]))]),
    "assembly_nut": ("assembly_nut", list, [
        ("map", text("map")), ("voxel, mm", scaled("voxel_m", 1e3, 2)), ("play, mm", scaled("play_m", 1e3, 3)),
        ("room, voxels", scaled("room_voxels", 1, 2)), ("points", text("points")),
        ("frame, us", scaled("frame_p50_us", 1, 2)), ("starts inside", text("starts_inside")), ("turned (95%)", share_of("turned", "trials", "turned_95_low", "turned_95_high")),
        ("advance a turn, pitches", scaled("lead_pitches")), ("held", text("held")), ("pulled at most, mm", scaled("pulled_m", 1e3, 2)),
        ("frames", text("frames")), ("penetrating", text("penetrating_frames")),
        ("nearest / proven, mm", lambda r: pair(r["nearest_m"] and 1e3 * r["nearest_m"], 1e3 * r["guaranteed_m"]))]),
    "assembly_scans": ("assembly_scans", list, [
        ("speed, m/s", scaled("speed_mps", 1, 2)), ("poses of", text("way")), ("trials", text("trials")), ("poses", text("poses")),
        ("contact reported", text("reported")), ("meshes meet", text("meeting")), ("missed", text("missed")),
        ("missed, at most (95%)", lambda r: percent(r["missed_95_high"]) if r["meeting"] else ""),
        ("nearest / proven, mm", lambda r: pair(1e3 * r["nearest_m"], 1e3 * r["guaranteed_m"] or None) if not r["meeting"] else "")]),
    "stability_step": ("stability_step", list, [
        ("part of the step", lambda r: r["part"].replace("_", " the ")), ("contacts", text("contacts")),
        ("steps", text("steps")),
        *((f"{key.replace('999', '99.9')}, us", scaled(f"{key}_us", 1, 2)) for key in ("p50", "p99", "p999", "max"))]),
    "bake_full": ("bake_full", pivoted("kind", "scene", "voxels", "triangles"), [
        ("scene", text("scene")), ("voxels across", text("voxels")), ("triangles", text("triangles")),
        ("lean Chebyshev: processor s / MB", lambda r: pair(*of_kind(r, "lean, chebyshev"))),
        ("full: processor s / MB", lambda r: pair(*of_kind(r, "full"))),
        *((f"{kind} over lean Chebyshev: processor / bytes", lambda r, kind=kind: pair(
            *(a / b for a, b in zip(of_kind(r, kind), of_kind(r, "lean, chebyshev"))), figures=2)) for kind in ("lean", "full"))]),
    "clearance_poses": ("clearance_poses", list, [
        ("scenes", text("scenes")), ("poses", text("poses")), ("claimed too much", text("too_much")),
        ("beyond a cropped side", text("premise_failed")),
        ("nearest object right", lambda r: percent(r["objects_right"] / (r["objects_right"] + r["objects_wrong"]), 4)),
        ("of", lambda r: f"{r['objects_right'] + r['objects_wrong']:,}")]),
    "clearance": ("clearance", list, [
        ("scenes", text("scenes")),
        ("exact distance, voxels", lambda r: f"{r['from_voxels']:g} to {'the end' if r['to_voxels'] is None else format(r['to_voxels'], 'g')}"),
        ("poses", text("poses")), ("nothing proven", lambda r: percent(r["without"] / r["poses"])),
        *((f"{label}: median, 99%, most", lambda r, key=key: pair(*(r[f"{key}_{of}"] for of in ("median", "p99", "most")), figures=2)
           if r[f"{key}_median"] is not None else "")
          for label, key in (("slack", "slack"), ("best of the files", "provable"), ("exact points", "by_points")))]),
    "narrow_gaps": ("narrow_gaps", list, [
        ("part", text("case")), ("map", text("map")), ("covering radius, voxels", scaled("covering_voxels")),
        ("runs", text("runs")), ("all pass from", scaled("all_pass_voxels", 1, 2)),
        ("none passes below", scaled("some_pass_voxels", 1, 2)), ("nearest / proven", lambda r: pair(
            r["nearest_voxels"], r["guaranteed_voxels"]))]),
    "skip_bake": ("skip_bake", list, [
        ("scene", text("scene")), ("bake", text("bake")), ("parts left out", text("parts_left_out")),
        ("of", text("parts")), ("triangles left out", text("triangles_left_out")), ("of", text("triangles")),
        ("nodes left out", text("nodes_left_out")), ("of", text("nodes")), ("time, ms", scaled("seconds", 1e3))]),
    "skip_tree": ("skip_tree", list, [
        ("scene", text("scene")), ("voxels in the box", text("voxels_in_box")), ("in bricks", text("voxels_in_bricks")),
        ("bricks needed", text("bricks_needed")), ("stored", text("bricks_stored")),
        ("nodes built", text("nodes_built")), ("pages of the file", text("pages_of_file"))]),
    "skip_query": ("skip_query", list, [
        ("scene", text("scene")), ("points", text("points")), ("skipping", text("way")),
        ("points looked at", scaled("points_looked_at")), ("blocks looked at", scaled("blocks_looked_at")),
        ("pages touched", text("pages_touched")), ("found", scaled("points_found")),
        ("p50 / p99, us", lambda r: pair(r["p50_us"], r["p99_us"]))]),
    "path_poses": ("path_poses", list, [
        ("scenes", text("scenes")), ("moments", text("moments")), ("proven too much", text("too_much")),
        ("paths too near", text("planted")), ("found", text("found"))]),
    "path": ("path", list, [
        ("scenes", text("scenes")), ("exact distance, voxels", lambda r: f"{r['from_voxels']} to {r['to_voxels']}"),
        ("poses", text("poses")), ("slack: median", scaled("median", 1, 2)), ("p99", scaled("p99", 1, 2)),
        ("most", scaled("most", 1, 2))]),
    "path_time": ("path_time", list, [
        ("required, mm", text("clearance_mm")), ("threads", text("threads")), ("points", text("points")),
        ("poses", text("poses")), ("moments looked at", text("moments_tested")), ("violations", text("violations")),
        ("reading, s", scaled("read_s", 1, 2)), ("checking, s", scaled("check_s", 1, 2)),
        ("processor, s", scaled("cpu_s", 1, 2)), ("memory, MB", scaled("peak_bytes", 1e-6))]),
    "cores": ("cores", pivoted("threads", "task", then=where(stage="whole")), [
        ("task", text("task")), ("1 thread", threads_ms(1)), ("2", threads_ms(2)), ("4", threads_ms(4)), ("8", threads_ms(8)),
        ("16", threads_ms(16)), ("speed-up at 8", speed_up(8)), ("at 16", speed_up(16)),
        ("processors used at 8", processors(8)), ("at 16", processors(16))]),
    "cores_stages": ("cores", pivoted("threads", "task", "stage", then=long_stages), [
        ("task", text("task")), ("stage", text("stage")), ("1 thread", threads_ms(1)), ("2", threads_ms(2)), ("4", threads_ms(4)),
        ("8", threads_ms(8)), ("16", threads_ms(16)), ("speed-up at 8", speed_up(8)), ("at 16", speed_up(16))]),
    "verdicts": ("verdicts", list, [
        ("part", text("case")), ("study", text("study")), ("poses", text("poses")), ("in the seat", text("seated_poses")),
        ("least told, mm", lambda r: digits(1e3 * r["told_m"], 4)), ("least of all poses, mm", lambda r: digits(1e3 * r["least_m"], 4)),
        ("to", text("object")), ("poses too near", text("too_near")),
        ("deeper in its seat, found, mm", lambda r: digits(1e3 * r["told_deeper_m"])),
        ("at poses, mm", lambda r: digits(1e3 * r["deeper_m"])), ("contradictions", text("contradictions"))]),
    "puzzles": ("puzzles", puzzles, [
        ("puzzle", lambda r: r["puzzle"] if r["validity"] == "voxplan" else ""),
        ("voxel, mm", lambda r: digits(1e3 * r["voxel_m"], 3) if r["validity"] == "voxplan" else ""), ("validity test", text("validity")),
        ("solved", lambda r: f"{r['solved']} of {r['seeds']}"),
        ("q1, median, q3", lambda r: ", ".join(digits(r[key]) for key in ("q1_s", "median_s", "q3_s")) if r["solved"] else ""),
        *((label, scaled(f"{key}_per_s")) for label, key in (
            ("poses a second", "poses"), ("with tests at once", "at_once_poses"), ("motions a second", "motions"),
            ("steps a second", "steps"), ("alone", "alone_poses"))),
        ("poses, times FCL's", over_peer("poses_per_s")), ("with tests at once, times FCL's", over_peer("at_once_poses_per_s"))]),
    "progress": ("progress", list, [
        ("command", lambda r: f"`{r['program']}`"), ("case", text("case")), ("processor time, s", scaled("cpu_s", 1, 2)),
        ("lines", text("lines")), ("told over true, least", lambda r: digits(r["least"])),
        ("greatest", lambda r: digits(r["greatest"])), ("within a factor of two", share("within_two"))]),
    "python": ("python", list, [
        ("question", lambda r: f"`{r['question']}`"), ("points", text("points")), ("threads", text("threads")),
        ("poses", text("poses")), ("Python, us a pose", lambda r: digits(1e6 * r["python_cpu_s"] / r["poses"], 3)),
        ("C++, us a pose", lambda r: digits(1e6 * r["cpp_cpu_s"] / r["poses"], 3)),
        ("speed of Python over C++", lambda r: digits(r["cpp_cpu_s"] / r["python_cpu_s"])),
        ("by the clock", lambda r: digits(r["cpp_wall_s"] / r["python_wall_s"]))]),
    "paper": ("paper", paper_rows, [
        ("figure", lambda r: PAPER_ROWS.get(r["figure"], (r["figure"].replace("_", " "),))[0]),
        ("1999", paper_cell("in_1999")), ("paper's model", paper_cell("paper_model")), ("`default`", paper_cell("default"))]),
    "paper_steps": ("paper_steps", list, [
        ("model", text("model")), ("points", text("points")), ("p50, us", scaled("p50_us")), ("p99, us", scaled("p99_us"))]),
    "loop": ("loop", list, [("figure", lambda r: f"`{r['figure']}`"), ("value", text("value"))]),
}


def markdown(header, lines):
    yield "| " + " | ".join(header) + " |"
    yield "|---" + "|---:" * (len(header) - 1) + "|"
    for line in lines:
        yield "| " + " | ".join(line) + " |"


def of_machine(path, name):
    """The lines of a table of one machine, none where it has no such rows."""
    _, choose, columns = TABLES[name]
    table = bench_csv.Table(path)
    rows = list(choose(table.rows))
    if not rows:
        return []
    runs = []
    for number in dict.fromkeys(r["run"] for r in rows):
        command, *rest = table.runs[number].split("; ")
        runs.append(f"`{command}` ({', '.join(rest)})")
    for row in rows:
        row["ran"] = ", ".join(table.runs[row["run"]].split("; ")[1:])
    cells = [[cell(row) for _, cell in columns] for row in rows]
    kept = [n for n in range(len(columns)) if any(line[n] for line in cells)]
    return [f"**{path.parent.name}** ({table.machine}{table.commit and ', commit ' + table.commit}): {', '.join(runs)}", "",
            *markdown([columns[n][0] for n in kept], ([line[n] for n in kept] for line in cells)), ""]


def summary():
    """The README's: ten figures, each of the machine that measured it last, and when."""
    def table(name):
        return bench_csv.Table(bench_csv.newest(name) / f"{name}.csv")

    def rows(name):
        return table(name).rows

    def measured(name, row):
        machine = table(name).machine.split("(")[0].removesuffix(" ").split(",")[0]
        return f"{machine}, {re.search(bench_csv.DATE, table(name).runs[row['run']])[0]}"

    wall = by("method", ("motion",), where(motion="wall", points=10 ** 6)(rows("query")))[0]["of"]
    ours, vdb, fcl = (wall[m] for m in ("all skipping", "OpenVDB ValueAccessor", "FCL meshes, contacts"))
    every = where(motion="everything", points=10 ** 6, method="all skipping")(rows("query"))[0]
    by_stiffness = [row["penetration_ratio"] for row in rows("stability_field")]
    engine = by("kind", ("model",), where(model="engine", voxels=1024)(rows("bake_kinds")))[0]["of"]
    in_1999 = {r["figure"]: r["in_1999"] for r in rows("paper")}
    bays = by("kind", ("triangles",), where(scene="aircraft")(rows("bake_full")))
    paper_bay, large_bay = (next(bay["of"] for bay in bays if bay["triangles"] == count) for count in (593409, 10500000))
    table2 = by("model", ("campaign",), where(campaign="table2")(rows("stability")))[0]["of"]
    rest = by("model", ("campaign",), where(campaign="rest")(rows("stability")))[0]["of"]
    loop = {r["figure"]: r["value"] for r in rows("loop")}
    cores = {row["task"]: row for row in by("threads", ("task",), where(stage="whole")(rows("cores")))}

    def baked(bay):
        full, lean = bay["full"], bay["lean, chebyshev"]
        return (f"{digits(full['cpu_s'])} s of processor time, {digits(full['file_bytes'] / 1e6)} MB; `--metric chebyshev`: "
                f"{digits(lean['cpu_s'])} s, {digits(lean['file_bytes'] / 1e6)} MB")

    def penetrating(model):
        row = table2[model]
        return f"{percent(row['penetration_ratio'])}, in {row['penetrating_trials']} of {row['trials']} trials"

    def wrench_row(contacts, label):
        of = by("method", ("contacts",), by("figure", ("contacts", "method"), where(voxel_m=0.005, contacts=contacts)(rows("wrench"))))
        of = {method: row["of"] for method, row in of[0]["of"].items()}

        def said(method):
            force = of[method]["force"]
            return f"{median_of(force)} in {digits(of[method]['frame, us']['p50'])} us"

        def half(method, figure):
            return f"{figure.removesuffix(' force')} {percent(of[method][figure]['p50'])}"
        ours, run = of["default, distances"], "default as voxrun runs it"
        return [f"{label}, {ours['force']['n']} cases",
                f"field: {said('default, distances')}, {half('default, distances', 'raw force')}; as `voxrun` runs it: "
                f"{median_of(of[run]['force'])}, {half(run, 'touching')}, {half(run, 'raw force')}; `--metric chebyshev`: "
                f"{said('default, Chebyshev layers')}",
                f"dense floats, our query: {said('dense float distances, our query')}; FCL distance: {said('FCL distance')}, "
                f"{half('FCL distance', 'touching')}", "wrench", measured("wrench", ours["force"])]
    lines = [
        ["contact query, 10^6 points against a wall", f"{digits(ours['p50_us'])} us, p99 {digits(ours['p99_us'])} us",
         f"OpenVDB `ValueAccessor`, every point: {digits(vdb['p50_us'])} us; FCL contacts: {digits(fcl['p50_us'])} us, "
         f"p99 {digits(fcl['p99_us'])} us", "query",
         measured("query", ours)],
        ["contact query, 10^6 points all in contact", f"{digits(every['p50_us'])} us, p99 {digits(every['p99_us'])} us",
         "a frame: 1,000 us", "query", measured("query", every)],
        ["bake of the engine, 1024 voxels across, whole command",
         f"{digits(engine['full']['command_s'])} s; `--metric chebyshev`: {digits(engine['lean, chebyshev']['command_s'])} s",
         f"`vdb_tool -mesh2ls width=6` {digits(engine['full']['vdb_tool_s'])} s, one run", "bake", measured("bake_kinds", engine["full"])],
        ["bake of 10.5 million triangles, 4,000 voxels across", baked(large_bay), "", "bake",
         measured("bake_full", large_bay["full"])],
        ["bake of the paper's 593,409 polygons at 5 mm", baked(paper_bay), f"1999: {in_1999['bake_s']} s, {in_1999['file_bytes'] / 1e6:g} MB",
         "bake", measured("bake_full", paper_bay["full"])],
        wrench_row("flush and smooth", "force error, smooth contacts, 5 mm"),
        wrench_row("mesh pairs", "force error, pairs of meshes, 5 mm"),
        [readme_figures.FRAMES, penetrating("default"),
         f"the paper's model: {penetrating('paper, braking')}; {percent(min(by_stiffness))} to "
         f"{percent(max(by_stiffness))} by the stiffness of its field", "stability", measured("stability", table2["default"])],
        ["presses that come to rest", f"{rest['default']['quiet']} of {rest['default']['trials']}",
         f"the paper's model: {rest['paper']['quiet']} of {rest['paper']['trials']}", "stability", measured("stability", rest["default"])],
        [readme_figures.CORES, ", ".join(f"{task} {speed_up(8)(cores[task])}" for task in (
            "voxelize: aircraft", "pointshell: dragon", "pointshell: counter", "query: everything")), "", "cores",
         measured("cores", cores["query: everything"])],
        ["30 minutes at 1 kHz, all cores busy: late frames",
         f"{loop['deadline_misses']} late and {loop['skipped_ticks']:,} left out of {loop['frames'] + loop['skipped_ticks']:,}; "
         f"the output went to zero {loop['output_trips']} times; wake-up p99 {digits(loop['wakeup_p99_us'])} us, "
         f"most {loop['wakeup_max_us'] / 1e3:.0f} ms", "", "loop", measured("loop", rows("loop")[0])]]
    return list(markdown(["figure", "Forcelayer", "beside", "page", "measured"],
                         ([*line[:3], f"[{line[3]}](tests/bench/{line[3]}.md)", line[4]] for line in lines)))


def readme_table():
    """The figures of the README, each with its committed value and stated interval."""
    lines, said = [], None
    for figure in readme_figures.FIGURES:
        row = figure.of(bench_csv.newest(figure.file))
        if row is None:
            continue
        low, high, words = figure.interval(figure, row)
        readme, said = "" if figure.readme == said else figure.readme, figure.readme

        def shown(value, figures=5 if words == "the same" else 3):
            return digits(value, figures)
        lines.append([readme, figure.name, shown(figure.value(row)),
                      "of one machine" if figure.of_machine else f"{shown(low)} to {shown(high)} ({words})", f"`{figure.part}`"])
    return list(markdown(["README", "figure", "committed", "stated interval", "part"], lines))


def filled(marked):
    name = marked[1]
    lines = summary() if name == "summary" else readme_table() if name == "readme_figures" else [
        line for path in sorted(bench_csv.RESULTS.glob(f"*/{TABLES[name][0]}.csv")) for line in of_machine(path, name)]
    return "\n".join([f"<!-- table: {name} -->", *lines, "<!-- end of table -->"])


def main():
    if sys.argv[1:] not in ([], ["--check"]):
        print(__doc__.split("\n\n")[1], file=sys.stderr)
        return 2
    status = 0
    for document in DOCUMENTS:
        old = document.read_text()
        new = MARKED.sub(filled, old)
        if new == old:
            continue
        if sys.argv[1:]:
            print(f"tables.py: {document}: its tables are not those of the results; run tests/bench/tables.py",
                  file=sys.stderr)
            status = 1
        else:
            document.write_text(new)
            print(f"wrote {document}")
    return status


if __name__ == "__main__":
    sys.exit(main())
