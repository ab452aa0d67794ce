#!/usr/bin/python3
"""plot_query.py QUERY.json OUT.svg: time of a frame against shell points, one line per method, from query_bench's report."""
import json
import sys

import matplotlib

matplotlib.use("Agg")
matplotlib.rcParams["svg.hashsalt"] = "forcelayer"  # the same bytes from the same report
matplotlib.rcParams["svg.fonttype"] = "none"
import matplotlib.pyplot as plt

# Ours in one hue, peers in others; in the order of the legend.
STYLE = {
    "all skipping": dict(color="#08519c", marker="o", linewidth=2.4, label="Forcelayer"),
    "no coherence": dict(color="#3182bd", marker="o", linestyle="--", label="without coherence"),
    "no super-blocks": dict(color="#6baed6", marker="o", linestyle="--", label="without super-blocks"),
    "no skipping": dict(color="#9ecae1", marker="o", linestyle="--", label="without any skipping"),
    "scalar, no skipping": dict(color="#bdbdbd", marker="o", linestyle=":", label="scalar, without any skipping"),
    "OpenVDB ValueAccessor": dict(color="#d95f0e", marker="s", label="OpenVDB ValueAccessor, same tree"),
    "OpenVDB level set, trilinear": dict(color="#b30000", marker="s", label="OpenVDB level set, trilinear"),
    "FCL meshes, contacts": dict(color="#31a354", marker="^", label="FCL meshes, all contacts"),
    "FCL meshes, distance": dict(color="#006d2c", marker="^", label="FCL meshes, distance"),
}


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    report = json.load(open(sys.argv[1]))
    rows = [row for row in report["results"]["rows"] if row["motion"] == "wall"]
    if not rows:
        sys.exit(f"{sys.argv[1]}: no rows of the motion 'wall'")
    figure, axes = plt.subplots(figsize=(8.4, 4.8))
    for method, style in STYLE.items():
        points = [row["points"] for row in rows if method in row["methods"]]
        p50 = [row["methods"][method]["frame_ns"]["p50"] / 1e3 for row in rows if method in row["methods"]]
        if points:
            axes.plot(points, p50, markersize=5, **style)
    axes.axhline(1000, color="black", linewidth=0.8)
    axes.text(110, 1000, "1 ms: a frame", va="bottom", fontsize=8)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlabel("points of the shell")
    axes.set_ylabel("contact query, median of a frame, µs")
    machine = report["machine"]
    axes.set_title(
        "A sphere sliding and turning on a wall: one core of "
        f"{machine['cpu']}, {report['results']['instruction_set']}",
        fontsize=10,
    )
    axes.grid(True, which="major", linewidth=0.3)
    axes.legend(fontsize=8, loc="center left", bbox_to_anchor=(1.01, 0.5), frameon=False)
    figure.tight_layout()
    figure.savefig(sys.argv[2], metadata={"Date": None})


if __name__ == "__main__":
    main()
