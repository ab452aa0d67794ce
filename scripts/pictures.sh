#!/usr/bin/env bash
# Draws the picture of the README and the tutorial anew: run after scripts/demo.sh.
source "$(dirname "$0")/common.sh"

bin=$root/build/release/bin
[ -x "$bin/forcelayer" ] || { echo "run scripts/demo.sh first" >&2; exit 2; }
"$bin/forcelayer" study "$root/sample_data/gearbox.glb#Pin" --voxel-size 1mm --pull 0,0,60mm --clearance 1mm -o "$root/build/demo/pin"
cp "$root/build/demo/pin/worst.png" "$root/sample_data/pictures/pin.png"
"$root/scripts/draw_concepts.py"
