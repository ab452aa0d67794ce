#!/usr/bin/env bash
# Measures the contact query beside its peers, writes the table as JSON and draws it: both stand in
# tests/bench/results/<cpu>/ afterwards, query.json and query.svg. Arguments go to query_bench
# (--largest 10000000 for ten million points: 4 GB of memory and some minutes).
source "$(dirname "$0")/common.sh"

install_packages
configure release
build release query_bench
say "measuring"
"$root/build/release/bin/query_bench" "$@" | tee "$root/build/release/query_bench.txt"
report=$(sed -n 's/^wrote //p' "$root/build/release/query_bench.txt")
/usr/bin/python3 "$root/scripts/plot_query.py" "$report" "${report%.json}.svg"
echo "wrote ${report%.json}.svg"
