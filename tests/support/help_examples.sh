#!/usr/bin/env bash
# help_examples.sh SAMPLE_DATA [COMMAND...]: in an empty folder, runs the examples of each command's --help as they stand
# there (of all commands, unless named). The commands are those of PATH, the files those of SAMPLE_DATA and what the
# examples make. What shows a window makes a picture instead, what runs by the clock runs as fast as possible, and
# what needs a device is left out.
set -euo pipefail
shopt -s inherit_errexit
sample_data=$1
shift
[ $# -gt 0 ] || set -- voxelize pointshell voxinfo voxrun voxcheck voxplan voxview forcelayer
cp -r "$sample_data"/. .

examples_of() {  # COMMAND [SUBCOMMAND]: without the words beside them
  "$@" --help | sed '1,/^Examples:/d; s/^  //; s/   *.*//'
}

# Makes the files that an example reads: the scene and part of the commands before, and the pin's.
before() {
  case $1 in
    voxinfo)
      [ -e run.csv ] || run
      [ -e swept.vox ] || voxelize part.obj --units mm --voxel-size 2mm --along lift.csv -o swept.vox --quiet
      ;;
    voxrun) [ -e run.flr ] || run ;;
    voxplan)
      voxelize gearbox.glb --without Pin --voxel-size 1mm -o rest.vox --quiet
      pointshell 'gearbox.glb#Pin' --voxel-size 1mm -o pin.pshell --quiet
      ;;
  esac
}
run() {
  voxrun bay.vox part.pshell --motion press.csv --as-fast-as-possible --trace run.csv --record run.flr --save-path path.csv --quiet
}

count=0
for command in "$@"; do
  before "$command"
  subcommands=$("$command" --help | sed -nE '/^Subcommands:/,/^$/s/^  ([a-z]+) .*/\1/p; s/^vox[a-z]+ ([a-z]+) says .*/\1/p')
  examples=$(examples_of "$command"; for sub in $subcommands; do examples_of "$command" "$sub"; done)
  while read -r example; do
    status=0
    case $example in
      *'--device hid'*) continue ;;
      *--screenshot*) ;;
      voxview*) example+=' --screenshot seen.png --size 400x300' ;;
      'voxrun doctor'*) example+=' --clock 0.1' ;;
      voxrun*) example+=' --as-fast-as-possible' ;;
    esac
    printf '   %s\n' "$example"
    bash -euc "$example" >said.txt 2>&1 </dev/null || status=$?
    case $example in voxrun* | voxcheck* | voxplan* | forcelayer*) [[ $status != [67] ]] || status=0 ;; esac  # no is an answer
    [ $status = 0 ] || { printf 'FAILED with status %s: %s\n' $status "$example" >&2; cat said.txt >&2; exit 1; }
    count=$((count + 1))
  done < <(awk '!seen[$0]++' <<<"$examples")
done
echo "$count examples run"
