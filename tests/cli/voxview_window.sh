#!/usr/bin/env bash
# voxview's window on a virtual screen: every key and mouse habit shows, a run beside it is not
# harmed by its end, nor it by the run's.
set -euo pipefail
bin=$FORCELAYER_BIN_DIR data=$FORCELAYER_SOURCE_DIR/sample_data
source "$FORCELAYER_SOURCE_DIR/tests/support/skipped.sh"
skip_without libvtk9-dev [ -x "$bin/voxview" ]
skip_without xvfb command -v Xvfb
python=/usr/bin/python3
skip_without python3-numpy "$python" -c 'import numpy'
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"$bin/voxelize" "$data/bay.json" -o bay.vox --voxel-size 8mm --quiet
"$bin/pointshell" "$data/part.obj" --units mm -o part.pshell --voxel-size 8mm --quiet
"$bin/voxrun" bay.vox part.pshell --device sim --motion "$data/press.csv" --duration 10s --quiet \
  --as-fast-as-possible --trace trace.csv
"$python" "$FORCELAYER_SOURCE_DIR/tests/cli/voxview_window.py" "$bin" "$data"
