#!/usr/bin/env bash
# Measures the point shells: a table of meshes and one of analytic shapes, and their figures as JSON in
# tests/bench/results/<cpu>/shell.json. Arguments go to shell_bench (--mesh dragon --voxels 985 for a
# million points).
source "$(dirname "$0")/common.sh"

install_packages
configure release
build release pointshell shell_bench
say "measuring"
"$root/build/release/bin/shell_bench" "$@"
