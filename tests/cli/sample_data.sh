#!/usr/bin/env bash
# The sample data in the repository are what their generator writes, and sound solids all of them.
set -euo pipefail
python=/usr/bin/python3
[ -x "$python" ] || python=$(command -v python3)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

PYTHONDONTWRITEBYTECODE=1 "$python" "$FORCELAYER_SOURCE_DIR/scripts/make_sample_data.py" "$folder"
diff -r --exclude=pictures "$folder" "$FORCELAYER_SOURCE_DIR/sample_data" ||
  { echo "sample_data differs from what scripts/make_sample_data.py writes"; exit 1; }
"$python" "$FORCELAYER_SOURCE_DIR/tests/cli/sample_data_check.py" "$folder"
bytes=$(cat "$folder"/* | wc -c)
[ "$bytes" -lt 2000000 ] || { echo "sample_data holds $bytes bytes, more than 2 MB"; exit 1; }
