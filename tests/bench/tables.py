#!/usr/bin/env python3
"""Fills the table of results/summary.md from the CSV files in results/.

Usage: tables.py [--check]

A table stands between `<!-- table: NAME -->` and `<!-- end of table -->`. With --check nothing is written. Exit status:
0 done or all equal, 1 a document differs from its table (a line says which), 2 wrong usage.
"""

import math
import pathlib
import re
import sys

import bench_csv
import readme_figures

DOCUMENTS = [readme_figures.SUMMARY]
MARKED = re.compile(r"<!-- table: (\w+) -->\n.*?<!-- end of table -->", re.DOTALL)
IN_1999 = "1999: 70 s, 21 MB"  # the paper's own


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


# How rows are chosen.

def where(**wanted):
    """Chooses the rows whose columns have these values."""
    return lambda rows: [row for row in rows if all(row[key] == value for key, value in wanted.items())]


def by(column, keys, rows):
    """One row for each value of `keys`: its first row, with `of`, the rows by `column`."""
    merged = {}
    for row in rows:
        one = merged.setdefault(tuple(row[key] for key in keys), {**row, "of": {}})
        one["of"].setdefault(row[column], row)
    return list(merged.values())


def median_of(spread):
    """The median, and the interval that holds it with 95%."""
    low, high = spread["median_low"], spread["median_high"]
    return percent(spread["p50"]) + ("" if low is None else f" ({percent(low)} - {percent(high)})")


def markdown(header, lines):
    yield "| " + " | ".join(header) + " |"
    yield "|---" + "|---:" * (len(header) - 1) + "|"
    for line in lines:
        yield "| " + " | ".join(line) + " |"


def summary():
    """The figures, each of the machine that measured it last, and when."""
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
    bays = by("kind", ("triangles",), where(scene="aircraft")(rows("bake_full")))
    paper_bay, large_bay = (next(bay["of"] for bay in bays if bay["triangles"] == count) for count in (593409, 10500000))
    table2 = by("model", ("campaign",), where(campaign="table2")(rows("stability")))[0]["of"]
    rest = by("model", ("campaign",), where(campaign="rest")(rows("stability")))[0]["of"]
    loop = {r["figure"]: r["value"] for r in rows("loop")}
    cores = {row["task"]: row for row in by("threads", ("task",), where(stage="whole")(rows("cores")))}

    def baked(bay):
        full, lean = bay["full"], bay["lean, chebyshev"]
        return (f"{digits(full['cpu_s'])} s of processor time, {digits(full['file_bytes'] / 1e6)} MB; `--kind paper`: "
                f"{digits(lean['cpu_s'])} s, {digits(lean['file_bytes'] / 1e6)} MB")

    def speed_up(task):
        return digits(cores[task]["of"][1]["wall_s"] / cores[task]["of"][8]["wall_s"])

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
        ours = of["default, distances"]
        return [f"{label}, {ours['force']['n']} cases",
                f"field: {said('default, distances')}, {half('default, distances', 'raw force')}; `--kind paper`: "
                f"{said('default, Chebyshev layers')}",
                f"dense floats, our query: {said('dense float distances, our query')}; FCL distance: {said('FCL distance')}, "
                f"{half('FCL distance', 'touching')}", "wrench", measured("wrench", ours["force"])]

    def hand_row():
        of_size = where(voxel_m=0.005, covering_voxels=0.8661)
        groups = {row["contacts"]: row["of"] for row in by("motion", ("contacts",), of_size(rows("wrench_hand")))}
        cases = sum(row["cases"] for row in of_size(rows("wrench_hand_cases")))

        def said(group, name):
            at_rest = groups[group]["at rest"]
            return f"{name}: {percent(at_rest['p50'])}, p95 {percent(at_rest['p95'])}"
        names = {"flush and smooth": "smooth contacts", "corners and wedges": "corners and wedges", "mesh pairs": "mesh pairs"}
        return [f"{readme_figures.HAND}, {cases} cases", "; ".join(said(*name) for name in names.items()), "", "wrench",
                measured("wrench_hand", groups["mesh pairs"]["at rest"])]
    lines = [
        ["contact query, 10^6 points against a wall", f"{digits(ours['p50_us'])} us, p99 {digits(ours['p99_us'])} us",
         f"OpenVDB `ValueAccessor`, every point: {digits(vdb['p50_us'])} us; FCL contacts: {digits(fcl['p50_us'])} us, "
         f"p99 {digits(fcl['p99_us'])} us", "query",
         measured("query", ours)],
        ["contact query, 10^6 points all in contact", f"{digits(every['p50_us'])} us, p99 {digits(every['p99_us'])} us",
         "a frame: 1,000 us", "query", measured("query", every)],
        ["bake of the engine, 1024 voxels across, whole command",
         f"{digits(engine['full']['command_s'])} s; `--kind paper`: {digits(engine['lean, chebyshev']['command_s'])} s",
         f"`vdb_tool -mesh2ls width=6` {digits(engine['full']['vdb_tool_s'])} s, one run", "bake", measured("bake_kinds", engine["full"])],
        ["bake of 10.5 million triangles, 4,000 voxels across", baked(large_bay), "", "bake",
         measured("bake_full", large_bay["full"])],
        ["bake of the paper's 593,409 polygons at 5 mm", baked(paper_bay), IN_1999,
         "bake", measured("bake_full", paper_bay["full"])],
        wrench_row("flush and smooth", "force error, smooth contacts, 5 mm voxels"),
        wrench_row("mesh pairs", "force error, mesh pairs, 5 mm voxels"),
        hand_row(),
        [readme_figures.FRAMES, penetrating("default"),
         f"the paper's model: {penetrating('paper, braking')}; {percent(min(by_stiffness))} to "
         f"{percent(max(by_stiffness))} depending on the stiffness of its field", "stability", measured("stability", table2["default"])],
        ["presses that come to rest", f"{rest['default']['quiet']} of {rest['default']['trials']}",
         f"the paper's model: {rest['paper']['quiet']} of {rest['paper']['trials']}", "stability", measured("stability", rest["default"])],
        [readme_figures.CORES, ", ".join(f"{task} {speed_up(task)}" for task in (
            "voxelize: aircraft", "pointshell: dragon", "pointshell: counter", "query: everything")), "", "cores",
         measured("cores", cores["query: everything"])],
        ["30 minutes at 1 kHz, all cores busy: late frames",
         f"{loop['deadline_misses']} late and {loop['skipped_ticks']:,} skipped, of {loop['frames'] + loop['skipped_ticks']:,}; "
         f"the output went to zero {loop['output_trips']} times; wake-up p99 {digits(loop['wakeup_p99_us'])} us, "
         f"most {loop['wakeup_max_us'] / 1e3:.0f} ms", "", "loop", measured("loop", rows("loop")[0])]]
    return list(markdown(["figure", "Forcelayer", "beside", "page", "measured"],
                         ([*line[:3], f"[{line[3]}](../README.md#{line[3]})", line[4]] for line in lines)))


TABLES = {"summary": summary}


def filled(marked):
    return "\n".join([marked[0].split("\n")[0], *TABLES[marked[1]](), "<!-- end of table -->"])


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
