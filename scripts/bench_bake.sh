#!/usr/bin/env bash
# Measures the bake beside vdb_tool, meshToVolume and the straightforward scan, then how time and memory
# grow and what the tree takes. Tables in Markdown and text, figures as JSON and plots in
# tests/bench/results/<cpu>/. Needs the models of ../shared/models and, on top of packages.txt,
# libopenvdb-tools. Some ten minutes; arguments go to bake_bench (--case bunny --voxels 512).
source "$(dirname "$0")/common.sh"

install_packages
command -v vdb_tool >/dev/null || { echo "vdb_tool is missing: install libopenvdb-tools" >&2; exit 1; }
configure release
build release voxelize voxinfo bake_bench
bench=$root/tests/bench
say "measuring the bake"
"$root/build/release/bin/bake_bench" "$@" | tee "$root/build/release/bake_bench.txt"
python3 "$bench/bake_table.py" "$(sed -n 's/^wrote //p' "$root/build/release/bake_bench.txt")"
say "measuring growth"
"$bench/bake_growth.py"
say "measuring the tree"
"$bench/tree_memory.py"
