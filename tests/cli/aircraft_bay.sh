#!/usr/bin/env bash
# The generated aircraft bay: as many triangles as asked for, sound solids, the same bytes every time.
set -euo pipefail
python=/usr/bin/python3
[ -x "$python" ] || python=$(command -v python3)
source "$FORCELAYER_SOURCE_DIR/tests/support/skipped.sh"
skip_without python3-numpy "$python" -c 'import numpy'
export PYTHONDONTWRITEBYTECODE=1
make_bay=$FORCELAYER_SOURCE_DIR/scripts/make_aircraft_bay.py
check=$FORCELAYER_SOURCE_DIR/tests/cli/aircraft_bay_check.py
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

"$python" "$make_bay" "$folder/paper"
"$python" "$check" "$folder/paper" 593409
for name in coarse again; do
  "$python" "$make_bay" "$folder/$name" --polygons 100001 --seed 7 --translation 100000,0,-100000
done
"$python" "$check" "$folder/coarse" 100001
diff -r "$folder/coarse" "$folder/again"
grep -q '"100000.0m"' "$folder/coarse/aircraft_bay.json"
if "$python" "$make_bay" "$folder/none" --polygons 1000 2>/dev/null; then
  echo "1000 triangles should be too few" >&2
  exit 1
fi
[ ! -e "$folder/none" ]
