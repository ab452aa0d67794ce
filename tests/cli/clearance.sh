#!/usr/bin/env bash
# The clearance of every frame of a run against the exact distance of the meshes, triangle by triangle: the proven one
# is never above it and not far below, and the object that is named is the nearest. The parts of seeded random scenes
# are drawn through them by hands that press into whatever is there.
set -euo pipefail
python=/usr/bin/python3
[ -x "$python" ] || python=$(command -v python3)
source "$FORCELAYER_SOURCE_DIR/tests/support/skipped.sh"
skip_without python3-numpy "$python" -c 'import numpy'
bin=$FORCELAYER_BIN_DIR
export PYTHONDONTWRITEBYTECODE=1
check=$FORCELAYER_SOURCE_DIR/tests/cli/clearance_check.py
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cd "$scratch"

seeds=${FORCELAYER_CLEARANCE_SEEDS:-$(seq 1 6)}
for seed in $seeds; do
  "$python" "$check" make "$seed"
  "$bin/voxelize" scene.json -o scene.vox --quiet
  "$bin/pointshell" part.obj --units m -o part.pshell --voxel-size 5mm --method fast --quiet
  "$bin/voxrun" scene.vox part.pshell --device sim --motion motion.csv --duration 4s --as-fast-as-possible --quiet \
    --trace "run_$seed.csv" --json run.json
  cp scene.json "scene_$seed.json"
done
# shellcheck disable=SC2086
"$python" "$check" judge $seeds
