#!/usr/bin/env bash
# Draws the README's picture, sample_data/contact.png, from the sample data and a run of it.
#   scripts/make_pictures.sh [FOLDER WITH THE COMMANDS]     (default: build/release/bin)
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
bin=${1:-$root/build/release/bin}
data=$root/sample_data
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

"$bin/voxelize" "$data/bay.json" -o "$folder/bay.vox" --voxel-size 5mm --quiet
"$bin/pointshell" "$data/part.obj" --units mm -o "$folder/part.pshell" --voxel-size 5mm --quiet
"$bin/voxrun" "$folder/bay.vox" "$folder/part.pshell" --device sim --motion "$data/press.csv" \
  --duration 10s --as-fast-as-possible --trace "$folder/trace.csv" --quiet
"$bin/voxview" "$data/bay.json" "$folder/bay.vox" "$folder/part.pshell" --part "$data/part.obj" \
  --part-units mm --trace "$folder/trace.csv" --at 2.2s --view-from 1,-0.45,0.35 --focus part \
  --size 1400x875 --screenshot "$data/contact.png"
