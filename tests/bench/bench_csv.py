#!/usr/bin/env python3
"""Results of the benchmarks as small tables: one CSV per benchmark and machine.

Usage: bench_csv.py folder                   where this machine's results stand
       bench_csv.py write JSON_FOLDER CSV_FOLDER
       bench_csv.py compare COMMITTED NEW    which figures of NEW moved by more than noise

`write` turns the reports that the benchmarks wrote into CSV files. A file begins with comment lines: the machine, the
commit, then one line per run with its number, command, date and vector instructions. The column `run` refers to these.

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


# The files: columns that tell a row, and columns that are compared.
FILES = {
    "bake": (("model", "voxels"), {**times("bake_s", "command_s", "vdb_tool_s", "straightforward_s", "scan_1_thread_s"),
                                   **same("file_bytes", "scan_voxels")}),
    "bake_kinds": (("vectors", "model", "voxels", "kind"), {**times("bake_s", "command_s"), **same("file_bytes")}),
    "bake_full": (("scene", "voxels", "triangles", "kind"), {**times("cpu_s"), **same("file_bytes"), "peak_bytes": MEMORY}),
    "bake_error": (("scene", "program", "voxels"),
                   {**times("wall_s"), **same("missed_voxels", "added_voxels", "wrong_voxels", "rms_voxels", "max_voxels"),
                    "peak_bytes": MEMORY}),
    "bake_growth": (("series", "scene", "voxels", "triangles"),
                    {**times("cpu_s"), **same("file_bytes"), "peak_bytes": MEMORY}),
    "bake_streams": (("triangles",), {**times("cpu_s"), **same("file_bytes"), "peak_bytes": MEMORY}),
    "bake_plan": (("scene", "voxel_m"), same("planned_bytes", "file_bytes")),
    "tree_memory": (("scene",), same("file_bytes", "whole_bytes", "vdb_bytes", "tree_1_bytes", "tree_2_bytes", "tree_3_bytes",
                                     "tree_4_bytes")),
    "shell": (("mesh", "voxels", "method"), {**same("points", "points_over_bound", "normal_p50_deg"),
                                             **times("wall_s", "proof_s")}),
    "shell_shapes": (("shape", "voxels", "method"), same("points", "normal_p50_deg")),
    "cover": (("method", "radius_voxels", "model"), {**same("points"), **times("frame_p50_us"), "smooth_error": 1.5,
                                                     "sharp_error": 1.5}),
    "query": (("motion", "points", "method"), {**times("p50_us"), "points_in_band": 1.5}),
    "query_kinds": (("motion", "points", "method"), times("p50_us")),
    "force": (("s", "cover", "orientations", "contact", "method"),
              same("stiffness", "bias", "noise", "direction_deg", "torque")),
    "force_cost": (("vectors", "part", "field"), times("ns_per_point", "query_us")),
    "wrench": (("voxel_m", "contacts", "method", "figure", "n"), {"p50": 1.6}),  # of as many cases
    "wrench_cases": (("voxel_m", "contact", "case", "figure"), dict.fromkeys(
        ("default, distances", "default as voxrun runs it", "default, Euclidean layers", "default, Chebyshev layers", "level field, Chebyshev layers",
         "paper: tangent plane, N/10", "dense float distances, our query", "dense float distances, default's slope", "exact closest points, our query",
         "OpenVDB level set, as people use it", "FCL contacts", "FCL distance"), 1.05)),  # seeded, three digits
    "wrench_commanded": (("voxel_m", "compared"), {}),
    "wrench_files": (("voxel_m", "pair", "kind"), same("file_bytes")),
    "motion": (("experiment", "model", "step_s"), {"error": 1.02}),
    "motion_drift": (("model",), {}),
    "trajectory": (("motion", "model", "stiffness_factor", "voxel_m", "rate_hz"), {"error_m": 1.02}),
    "stability": (("campaign", "case", "model"), {"penetration_ratio": 1.5, "quiet_share": 1.3}),
    "stability_field": (("factor",), {"penetration_ratio": 1.5}),
    "stability_hands": (("campaign", "case", "model"), {}),
    "stability_map": (("model", "rate_hz", "mass_kg"), same("10", "100", "1e3", "1e4", "1e5", "1e6")),
    "stability_device": (("task", "model", "grip", "delay_s"), same("quiet_to", "bound", "default")),
    "stability_grips": (("model", "scale", "delay_s", "hand", "clutch", "axis", "arm_m"), {}),
    "stability_loops": (("model", "start", "scale", "loop"), same("loops")),
    "stability_seats": (("seed", "pair", "covering_voxels"), {}),
    "stability_step": (("part",), times("p50_us")),
    "assembly_peg": (("map", "clearance_m", "chamfer_m", "tilt_deg"), {}),
    "assembly_nut": (("map", "voxel_m", "play_m"), {"points": SAME, "lead_pitches": 1.05}),
    "assembly_scans": (("speed_mps", "way"), {}),
    "clearance": (("scenes", "from_voxels", "to_voxels"), {"poses": SAME, "slack_median": 1.02, "slack_p99": 1.02}),
    "clearance_poses": (("scenes",), same("poses", "too_much")),
    "narrow_gaps": (("map", "covering_voxels", "case"), {"all_pass_voxels": 1.25, "some_pass_voxels": 1.25}),
    "skip_bake": (("scene", "bake"), {**times("seconds"), **same("triangles_left_out", "nodes_left_out")}),
    "skip_query": (("scene", "points", "way"), {**times("p50_us")}),
    "skip_tree": (("scene",), same("voxels_in_bricks", "bricks_needed", "bricks_stored")),
    "path": (("scenes", "from_voxels"), {"poses": SAME, "median": 1.02, "p99": 1.02}),
    "path_poses": (("scenes",), same("moments", "too_much", "planted", "found")),
    "path_time": (("clearance_mm", "threads"), {**same("poses", "moments_tested"), **times("cpu_s")}),
    "cores": (("task", "stage", "threads"), times("wall_s")),
    "puzzles": (("puzzle", "validity"), times("poses_per_s", "at_once_poses_per_s", "steps_per_s")),
    "verdicts": (("case",), {**same("poses", "too_near", "contradictions"), "told_m": 1.02}),
    "python": (("question", "points", "threads"), times("python_cpu_s", "cpp_cpu_s")),
    "progress": (("program", "case"), times("cpu_s")),
    "paper": (("figure",), {}),
    "paper_steps": (("model", "points"), times("p50_us", "p99_us")),
    "loop": (("figure",), {}),
}


def bake(rows):
    for r in rows:
        yield "bake", {
            "model": r["model"], "voxels": r["voxels_across"], "triangles": r["triangles"],
            "straightforward_s": r["straightforward_one_thread"]["cpu_s"], "scan_1_thread_s": r["scan_one_thread"]["cpu_s"],
            "mesh_to_volume_s": r["mesh_to_volume"]["wall_s"], "scan_s": r["scan_all_threads"]["wall_s"],
            "vdb_tool_bake_s": r["vdb_tool_without_reading"]["wall_s"], "bake_s": r["in_memory_to_file"]["wall_s"],
            "vdb_tool_s": r["vdb_tool"]["wall_s"], "command_s": r["command"]["wall_s"],
            "vdb_tool_peak_bytes": r["vdb_tool_peak_rss_bytes"], "peak_bytes": r["command_peak_rss_bytes"],
            "vdb_bytes": r["vdb_bytes"], "file_bytes": r["file_bytes"], "scan_voxels": r["scan_voxels"]}


def bake_kinds(rows, machine):
    for r in rows:
        for name, kind in r["kinds"].items():
            yield "bake_kinds", {
                "vectors": machine["vectors"], "model": r["model"], "voxels": r["voxels_across"], "kind": name,
                "bake_s": kind["in_memory_to_file"]["wall_s"], "bake_cpu_s": kind["in_memory_to_file"]["cpu_s"],
                "command_s": kind.get("command", {}).get("wall_s"), "file_bytes": kind["file_bytes"],
                "vdb_tool_bake_s": r["vdb_tool_without_reading"]["wall_s"], "vdb_tool_s": r["vdb_tool"]["wall_s"],
                "mesh_to_volume_s": r["mesh_to_volume"]["wall_s"], "vdb_bytes": r["vdb_bytes"]}


def bake_full(rows):
    for r in rows:
        yield "bake_full", {
            "scene": r["scene"], "voxels": r["voxels_across"], "triangles": r["triangles"], "voxel_m": r["voxel_size_m"],
            "kind": r["kind"], "wall_s": r["wall_s"], "cpu_s": r["cpu_s"], "peak_bytes": r["peak_rss_bytes"],
            "file_bytes": r["file_bytes"]}


def bake_error(rows):
    for r in rows:
        yield "bake_error", {
            "scene": r["scene"], "program": r["program"], "voxels": r["voxels_across"], "voxel_m": r["voxel_size_m"],
            "wall_s": r["wall_s"], "cpu_s": r["cpu_s"], "peak_bytes": r["peak_rss_bytes"],
            "touched_voxels": r["touched_voxels"], "missed_voxels": r["missed_voxels"],
            "added_voxels": r["added_voxels"], "wrong_voxels": r["wrong_classes"],
            "rms_voxels": r["mid_surface"]["rms_voxels"], "max_voxels": r["mid_surface"]["max_voxels"],
            "proven_m": r["proven_separation_m"]}


def bake_growth(rows):
    for r in rows:
        yield "bake_growth", {
            "series": r["series"], "scene": r["scene"], "voxels": r["voxels_across"], "triangles": r["triangles"],
            "voxel_m": r["voxel_size_m"], "wall_s": r["wall_s"], "cpu_s": r["cpu_s"], "read_s": r["read_s"],
            "peak_bytes": r["peak_rss_bytes"], "file_bytes": r["file_bytes"], "surface_voxels": r["surface_voxels"]}


def bake_streams(rows):
    for r in rows:
        yield "bake_streams", r


def bake_plan(rows):
    for r in rows:
        yield "bake_plan", {"scene": r["scene"], "voxel_m": r["voxel_size_m"], "planned_bytes": r["planned_bytes"],
                            "file_bytes": r["file_bytes"], "planned_s": r["planned_s"], "bake_s": r["bake_s"]}


def tree_memory(rows):
    for r in rows:
        yield "tree_memory", {
            "scene": r["scene"], "dims": "x".join(map(str, r["dims"])), "surface_voxels": r["surface_voxels"],
            "file_bytes": r["file_bytes"], "whole_bytes": r["whole_bytes"], "vdb_bytes": r["vdb_bytes"], "dense_bytes": r["dense_bytes"],
            **{f"tree_{n}_bytes": size for n, size in r["tree_bytes"].items()}}


def shell(results):
    for r in results["meshes"]:
        normals = r["normal_error_deg"]
        yield "shell", {
            "mesh": r["mesh"], "voxels": r["voxels_across"], "method": r["method"], "points": r["points"],
            "radius_voxels": r["covering_radius_voxels"], "points_over_bound": r["points_over_planar_bound"],
            "share_of_voxel_centers": r.get("share_of_voxel_centers"), "normal_p50_deg": normals["p50"],
            "normal_p99_deg": normals["p99"], "normal_max_deg": normals["max"],
            "weights_over_area": r["weight_sum_over_area"], "block_voxels": r["mean_block_radius_voxels"],
            "wall_s": r["wall_s"], "cpu_s": r["cpu_s"], "peak_bytes": r["peak_rss_bytes"], "proof_s": r["proof_wall_s"],
            "file_bytes": r["file_bytes"]}
    for r in results["shapes"]:
        yield "shell_shapes", {
            "shape": r["shape"], "voxels": r["voxels_across"], "method": r["method"], "points": r["points"],
            "points_near_edges": r["points_near_edges"], "normal_p50_deg": r["normal_error_deg"]["p50"],
            "normal_p99_deg": r["normal_error_deg"]["p99"], "normal_max_deg": r["normal_error_deg"]["max"],
            "distance_max_voxels": r["distance_voxels"]["max"]}


def cover(rows):
    for r in rows:
        for model in ("paper", "default"):
            smooth, sharp = r[model]["flush and smooth"], r[model]["corners and wedges"]
            yield "cover", {
                "method": r["method"], "radius_voxels": r["covering_radius_voxels"], "points": r["points"],
                "model": model, "frame_p50_us": r[model]["frame_us"]["p50"], "smooth_error": smooth["force_error"],
                "sharp_error": sharp["force_error"], "smooth_noise": smooth["noise"], "sharp_noise": sharp["noise"]}


def query(results):
    for r in results["rows"]:
        for name, method in r["methods"].items():
            time_us = {key: value / 1e3 for key, value in method["frame_ns"].items()}
            row = {"motion": r["motion"], "points": r["points"], "points_in_band": r["mean_points_in_band"],
                   "method": name, "frames": method["frames"], "p50_us": time_us["p50"], "p99_us": time_us["p99"],
                   "p999_us": time_us["p999"], "max_us": time_us["max"]}
            of_lean = name.startswith("lean file")
            if of_lean or (name == "all skipping" and r["motion"] == "wall"):
                yield "query_kinds", row
            if not of_lean:
                yield "query", row


# Contact by contact these methods are kept, at 5 mm; by groups of contacts, all methods and sizes.
FORCE_S = 0.5
FORCE_METHODS = ("tangent plane, N/10", "level field", "2-bit Euclidean, level", "8-bit distance",
                 "exact, the map's standoff")


def force(results):
    for size in results["sizes"]:
        groups = {key: size[key] for key in ("flush_and_smooth", "wedges", "wedges_one_offset") if key in size}
        groups = {key.replace("_", " "): methods for key, methods in groups.items()}
        for contact, methods in [*groups.items(), *size["contacts"].items()]:
            for name, figures in methods.items():
                if contact not in groups and (size["s"] != FORCE_S or name not in FORCE_METHODS):
                    continue
                row = {"s": size["s"], "cover": size["covering_radius_voxels"], "orientations": size["orientations"],
                       "contact": contact, "method": name, "cases": figures["cases"]}
                for key in ("stiffness", "bias", "noise", "direction_deg", "torque", "step"):
                    row[key] = (figures[key] or {}).get("median")
                yield "force", row


def force_cost(rows, machine):
    for r in rows:
        fields = [("tangent plane", r, "tangent_plane"), ("level field", r, "level")]
        for d in r["distances"]:
            fields += [("stored distance", d, "distance"), ("nearest stored distance", d, "nearest")]
        for field, figures, key in fields:
            yield "force_cost", {
                "vectors": machine.get("vectors"), "part": r["part"], "field": field,
                "collected_points": figures["collected_points"], "ns_per_point": figures[f"{key}_ns_per_point"],
                "ns_per_point_new_bricks": figures.get(f"{key}_every_brick_new_ns_per_point"),
                "query_us": figures["query_ns"] / 1e3}


WRENCH_GROUPS = ("flush and smooth", "corners and wedges", "mesh pairs")
WRENCH_BY_CASE = ("force", "raw force", "torque")  # told case by case; the first by pair too


def wrench(rows):
    for r in rows:
        for contacts, methods in r["contacts"].items():
            if contacts not in WRENCH_GROUPS and contacts not in (r["files"] or {}):
                continue
            for method, told in methods.items():
                for figure, spread in told["figures"].items():
                    if contacts in WRENCH_GROUPS or figure == WRENCH_BY_CASE[0]:
                        yield "wrench", {"voxel_m": r["voxel_size_m"], "contacts": contacts, "method": method,
                                         "skips": told["skips"], "figure": figure, **spread}
        if r["commanded"]["compared"]:
            yield "wrench_commanded", {"voxel_m": r["voxel_size_m"], **r["commanded"]}
        for case in r["cases"]:
            for figure in WRENCH_BY_CASE:
                yield "wrench_cases", {"voxel_m": r["voxel_size_m"], "contact": case["contact"], "case": case["case"], "figure": figure,
                                       **{method: None if value is None else float(f"{value:.3g}")
                                          for method, value in case[figure].items()}}
        for pair, kinds in (r["files"] or {}).items():
            for kind, figures in kinds.items():
                yield "wrench_files", {"voxel_m": r["voxel_size_m"], "pair": pair, "kind": kind, **figures}


def clearance(rows):
    for r in rows:
        yield "clearance_poses", {key: r[key] for key in ("scenes", "poses", "too_much", "premise_failed", "objects_right",
                                                          "objects_wrong")}
        for line in r["ranges"]:
            spreads = {f"{name}_{key}": (line[of] or {}).get(key)
                       for name, of in (("slack", "slack"), ("provable", "of_provable"), ("by_points", "of_by_points"))
                       for key in ("median", "p99", "most")}
            yield "clearance", {"scenes": r["scenes"], "from_voxels": line["from_voxels"], "to_voxels": line["to_voxels"],
                                "poses": line["poses"], "without": line["without"], "compared": line["compared"], **spreads}


def motion(results):
    for experiment, models in results.items():
        for model, figures in models.items():
            if experiment == "drift":
                yield "motion_drift", {"model": model, **figures}
                continue
            for step, error in zip(figures["step_s"], figures["error"]):
                yield "motion", {"experiment": experiment, "model": model, "step_s": step, "error": error,
                                 "order": figures["order"]}


def trajectory(rows):
    for r in rows:
        for rate, error, largest in zip(r["rates_hz"], r["error_m"], r["largest_m"]):
            yield "trajectory", {
                "motion": r["motion"], "model": r["model"], "stiffness_factor": r["stiffness_factor"],
                "voxel_m": r["voxel_size_m"], "seeds": len(r["seeds"]), "rate_hz": rate, "error_m": error,
                "largest_m": largest}


OUTCOME = ("trials frames force_layer_frames penetration_frames penetrating_trials penetration_ratio guard_cut_share peak_force_n "
           "rest_force_n_p50 cycle_voxels_max settle_s_max quiet quiet_share energy_generated_j_worst progress_p10 "
           "stuck_share_p50 force_step_n_p99 smallest_distance_m guaranteed_m lag_m_max non_finite_frames").split()


def outcome(file, campaign, case, model, figures):
    low, high = figures["penetration_ratio_95"] or (None, None)
    row = {"campaign": campaign, "case": case, "model": model, **{key: figures.get(key) for key in OUTCOME}}
    return file, {**row, "ratio_95_low": low, "ratio_95_high": high}


def stability_cases(results):
    for case, models in results.items():
        for model, figures in models.items():
            yield outcome("stability", "cases", case, model, figures)


def stability_one_case(campaign, file="stability"):
    def rows(results):
        for model, figures in results.items():
            if "trials" in figures:
                yield outcome(file, campaign, campaign, model, figures)
    return rows


CELLS = {".": "quiet", "~": "calming", "X": "unstable"}
STIFFNESSES = ("10", "100", "1e3", "1e4", "1e5", "1e6")


def stability_map(results):
    for model, maps in results.items():
        for one in maps:
            for line in one["rows"]:
                yield "stability_map", {"model": model, "rate_hz": one["rate_hz"], "mass_kg": line["mass_kg"],
                                        **{k: CELLS[cell] for k, cell in zip(STIFFNESSES, line["cells"])}}


def stability_device(results):
    for task, rows in results.items():
        for r in rows:
            yield "stability_device", {
                "task": task, "model": r["model"], "grip": r["grip"], "delay_s": r["delay_s"], "bound": r["bound"],
                "quiet_to": r["quiet_to"], "trembles_at": r["trembles_at"], "default": r["default"]}


def stability_grips(results):
    for r in results:
        yield "stability_grips", {**r, "clutch": int(r["clutch"]), "quiet": int(r["quiet"])}


def stability_loops(results):
    for r in results:
        yield "stability_loops", r


def stability_field(results):
    for r in results:
        yield "stability_field", r


def stability_seats(results):
    for r in results:
        yield "stability_seats", r


def assembly(task):
    def rows(results):
        for r in results:
            yield f"assembly_{task}", r
    return rows


def stability_step(results):
    for part in ("query", "field", "solve", "beyond_query", "control"):
        yield "stability_step", {"part": part, "contacts": results["contacts_p50"], "steps": results["steps"],
                                 **{f"{key}_us": value for key, value in results[f"{part}_us"].items()}}


def progress(rows):
    for r in rows:
        yield "progress", r


def python_bench(rows):
    for r in rows:
        yield "python", r


def skipped(rows):
    for r in rows:
        b, total = r["bake"], r["bake"]["total"]
        yield "skip_bake", {"scene": r["scene"], "bake": "whole", "parts": total["parts"],
                            "triangles": total["triangles"], "seconds": b["whole"]["seconds"]}
        for key in ("region_of_interest", "cache_nothing_changed", "cache_one_part_moved"):
            yield "skip_bake", {
                "scene": r["scene"], "bake": key.replace("_", " "), "parts": total["parts"],
                "triangles": total["triangles"], "seconds": b[key]["seconds"], "parts_left_out": b[key]["left_out"]["parts"],
                "triangles_left_out": b[key]["left_out"]["triangles"], "nodes": b["nodes_of_64_voxels"]["built"],
                "nodes_left_out": b[key].get("nodes_left_out")}
        tree = r["queries"][0]["tree"]
        yield "skip_tree", {"scene": r["scene"], **tree,
                            "nodes_in_the_box_at_most": b["nodes_of_64_voxels"]["in_the_box_at_most"],
                            "nodes_built": b["nodes_of_64_voxels"]["built"]}
        for q in r["queries"]:
            for way, figures in q["ways"].items():
                yield "skip_query", {
                    "scene": r["scene"], "points": q["points"], "blocks": q["blocks"], "way": way,
                    "points_looked_at": figures["points_looked_at"], "blocks_looked_at": figures["blocks_looked_at"],
                    "points_found": figures["points_found"], "pages_touched": figures["pages_touched"],
                    "pages_of_file": q["tree"]["pages_of_file"], "p50_us": figures["frame_us"]["p50"],
                    "p99_us": figures["frame_us"]["p99"]}


def puzzles(rows):
    for r in rows:
        yield "puzzles", r


def path(rows):
    for r in rows:
        yield "path_poses", {key: r[key] for key in ("scenes", "moments", "too_much", "planted", "found")}
        for line in r["ranges"]:
            yield "path", {"scenes": r["scenes"], **line}


def path_time(rows):
    for r in rows:
        yield "path_time", r


def cores(rows):
    for r in rows:
        yield "cores", r


def verdicts(rows):
    for r in rows:
        yield "verdicts", {key: r[key] for key in ("case", "file", "part", "study", "poses", "seated_poses", "told_m", "least_m",
                                                   "object", "too_near", "told_deeper_m", "deeper_m", "contradictions")}


def paper(results):
    own, part, at_1_khz = results["paper"], results["part"], results["points_at_1_khz"]

    def baked(key):
        return [results["bakes"][model][key] for model in ("paper", "default")]
    figures = [("triangles", own["polygons"], *baked("triangles")), ("bake_s", own["bake_s"], *baked("wall_s")),
               ("bake_cpu_s", None, *baked("cpu_s")), ("file_bytes", own["file_mb"] * 1e6, *baked("file_bytes")),
               ("part_points", own["part_points"], part["voxel-centers"], part["surface"]),
               ("points_at_1_khz", own["points_at_1_khz"], at_1_khz["paper"]["points"], at_1_khz["default"]["points"]),
               ("points_at_1_khz_reached", None, int(at_1_khz["paper"]["reached"]), int(at_1_khz["default"]["reached"])),
               ("penetration_ratio_no_braking", own["penetration_ratio"], None, None),
               ("penetration_ratio_braking", own["penetration_ratio_braking"], None, None)]
    for name, in_1999, paper_model, default in figures:
        yield "paper", {"figure": name, "in_1999": in_1999, "paper_model": paper_model, "default": default}
    for r in results["steps"]:
        yield "paper_steps", {"model": r["model"], "points": r["points"], "frames": r["frames"],
                              "p50_us": r["step_ns"]["p50"] / 1e3, "p99_us": r["step_ns"]["p99"] / 1e3}


LOOP = ("frames force_layer_frames penetration_frames guard_cuts deadline_misses skipped_ticks dropped_frames "
        "minor_faults major_faults involuntary_switches steal_s wall_s output_trips max_device_force_n peak_rss_bytes "
        "replay_is_the_same").split()


def loop(results):
    for key in LOOP:
        yield "loop", {"figure": key, "value": results[key]}
    for cause, misses in results["miss_causes"].items():
        yield "loop", {"figure": f"misses: {cause}", "value": misses}
    for clock in ("step_ns", "tick_ns", "wakeup_ns"):
        for key, value in results[clock].items():
            yield "loop", {"figure": f"{clock[:-3]}_{key}_us", "value": value / 1e3}


ROWS = {"bake": bake, "bake_wide": bake_kinds, "bake_full": bake_full, "bake_error": bake_error, "bake_growth": bake_growth,
        "bake_streams": bake_streams,
        "bake_plan": bake_plan, "tree_memory": tree_memory, "shell": shell, "cover": cover, "query": query,
        "force": force, "force_part": force, "force_cost": force_cost, "wrench": wrench, "clearance": clearance, "motion": motion, "trajectory": trajectory,
        "stability_cases": stability_cases, "stability_rest": stability_one_case("rest"),
        "stability_table2": stability_one_case("table2"),
        "stability_hands": stability_one_case("hands", "stability_hands"), "stability_map": stability_map,
        "stability_device": stability_device, "stability_grips": stability_grips,
        "stability_loops": stability_loops, "stability_seats": stability_seats,
        "stability_field": stability_field, "stability_step": stability_step, "skipped": skipped,
        **{f"assembly_{task}": assembly(task) for task in ("peg", "nut", "scans")},
        "python_bench": python_bench, "progress": progress, "path": path, "path_time": path_time, "cores": cores, "puzzles": puzzles, "verdicts": verdicts, "paper_table": paper, "loop": loop}
OF_VECTORS = (bake_kinds, force_cost)  # which put the vectors of the run into the rows


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
    words = [report["command"], machine["date"][:10]]
    vectors = machine.get("vectors") or (report["results"].get("instruction_set")
                                         if isinstance(report["results"], dict) else None)
    return "; ".join(words + ([vectors] if vectors else []))


def write(reports, folder):
    """Writes the files of these reports, and returns their paths."""
    files = {}
    for report in reports:
        rows_of = ROWS[report["benchmark"]]
        more = (report["machine"],) if rows_of in OF_VECTORS else ()
        for name, row in rows_of(report["results"], *more):
            runs, rows = files.setdefault(name, ([], []))
            if report not in runs:
                runs.append(report)
            rows.append({"run": len(runs), **row})
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
