#!/usr/bin/env bash
# scripts/pipelines: the commands of the files for GitHub and GitLab, read from them and run in their order on a
# repository made of the sample data. Green; red where a bracket is moved by 3 mm; green again.
set -euo pipefail
source "$FORCELAYER_SOURCE_DIR/tests/support/skipped.sh"
python=/usr/bin/python3
skip_without libvtk9-dev [ -x "$FORCELAYER_BIN_DIR/voxview" ]
skip_without xvfb command -v xvfb-run
skip_without jq command -v jq
skip_without python3-yaml "$python" -c 'import yaml'
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
PATH=$FORCELAYER_BIN_DIR:$PATH "$python" -B "$FORCELAYER_SOURCE_DIR/tests/cli/pipelines.py" github gitlab
