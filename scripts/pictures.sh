#!/usr/bin/env bash
# Draws the README's pictures anew from the sample data: run after scripts/demo.sh.
source "$(dirname "$0")/common.sh"

bin=$root/build/release/bin
demo=$root/build/demo
data=$root/sample_data
pictures=$data/pictures
[ -f "$demo/trace.csv" ] || { echo "run scripts/demo.sh first" >&2; exit 2; }
mkdir -p "$pictures"

"$bin/voxview" "$data/bay.json" "$demo/bay.vox" --size 1200x750 --screenshot "$pictures/bay.png"
"$bin/voxview" "$data/bay.json" "$demo/bay.vox" "$demo/part.pshell" --part "$data/part.obj" \
  --part-units mm --trace "$demo/trace.csv" --at 2.2s --view-from 1,-0.45,0.35 \
  --size 1200x750 --screenshot "$pictures/contact.png"
