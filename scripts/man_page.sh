#!/usr/bin/env bash
# man_page.sh COMMAND PAGE.gz: writes the man page of a built command from its --help, subcommands included.
set -euo pipefail
command=$1 page=$2
mkdir -p "$(dirname "$page")"
extra=$(mktemp)
trap 'rm -f "$extra"' EXIT

help=$("$command" --help)
summary=${help%%$'\n'*}
{
  echo '[EXIT STATUS]'
  echo '0 done; 1 internal or I/O failure; 2 wrong usage; 3 unusable mesh or scene, or a bake too large;'
  echo '4 unusable baked file; 5 device failure; 6 checked, and the answer is no; 128+n ended by signal n.'
  echo '[ENVIRONMENT]'
  echo 'NO_COLOR: where it is set and not empty, nothing is colored on a terminal.'
  # Options stand in the summary's own layout: they are read as they are.
  for subcommand in $(sed -nE '/^Subcommands:/,/^$/s/^  ([a-z]+) .*/\1/p; s/^vox[a-z]+ ([a-z]+) says .*/\1/p' <<<"$help"); do
    echo "[SUBCOMMAND ${subcommand^^}]"
    echo '.nf'
    "$command" "$subcommand" --help | sed 's/\\/\\e/g; s/^\./\\\&./'
    echo '.fi'
  done
} >"$extra"
help2man --no-info --name "${summary,}" --include "$extra" --source Forcelayer "$command" | gzip -9n >"$page.new"
mv "$page.new" "$page"
