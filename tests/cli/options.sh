#!/usr/bin/env bash
# The number of options over all commands and subcommands, by their --help, and its limit: a default that needs no
# option is better than an option. The habits of every command (--json, --quiet, --help, --version) do not count, and
# an option that several subcommands of forcelayer have under one name, with one meaning, counts once.
set -euo pipefail
bin=$FORCELAYER_BIN_DIR
limit=140

# options_of COMMAND [SUBCOMMAND]: the first spelling of each of its options, a line each.
options_of() { "$bin/$1" "${@:2}" --help | sed -nE 's/^  (-[^ ]+).*/\1/p' | grep -vE -- '--(json|quiet|help|version)$' || true; }
# subcommands_of COMMAND
subcommands_of() { "$bin/$1" --help | sed -nE '/^Subcommands:/,/^$/s/^  ([a-z]+) .*/\1/p; s/^vox[a-z]+ ([a-z]+) lists .*/\1/p'; }

all=0
shared=
for command in voxelize pointshell voxinfo voxrun voxcheck voxplan voxview forcelayer; do
  if [ ! -x "$bin/$command" ]; then echo "no $command in this build"; continue; fi
  for subcommand in "" $(subcommands_of "$command"); do
    count=0
    for option in $(options_of "$command" $subcommand); do
      if [ "$command" = forcelayer ]; then
        case "$shared " in *" ${option%%,*} "*) continue ;; esac
        shared+=" ${option%%,*}"
      fi
      count=$((count + 1))
    done
    [ "$count" = 0 ] || printf '%4d  %s\n' "$count" "$command${subcommand:+ $subcommand}"
    all=$((all + count))
  done
done
printf '%4d  options, at most %d\n' "$all" "$limit"
[ "$all" -gt 0 ] && [ "$all" -le "$limit" ]
