#!/usr/bin/env bash
# Measures stability and accuracy of motion anew, both models side by side, and draws the plots: three
# minutes on two idle cores. tests/bench/METHOD.md says how; results go to tests/bench/results/<cpu>/.
source "$(dirname "$0")/common.sh"

install_packages
configure release
build release stability_bench motion_bench
bin=$root/build/release/bin
"$bin/stability_bench" all
"$bin/motion_bench"
"$root/scripts/plot_stability.py" "$(ls -td "$root"/tests/bench/results/*/ | head -1)"
