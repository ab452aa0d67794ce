#!/usr/bin/env bash
# Builds all commands, then runs the whole chain on the sample data: bakes the scene and the part, runs the 1 kHz loop with a
# simulated device and a scripted hand, and leaves everything in build/demo. On a bare Debian 12 it first installs the
# packages that are missing.
source "$(dirname "$0")/common.sh"

install_packages commands
configure release -DFORCELAYER_TESTS=OFF
build release commands
bin=$root/build/release/bin
out=$root/build/demo
data=$root/sample_data
voxel_size=${1:-5mm}
mkdir -p "$out"

say "baking the scene at $voxel_size"
"$bin/voxelize" "$data/bay.json" -o "$out/bay.vox" --voxel-size "$voxel_size" --json "$out/voxelize.json"
"$bin/voxinfo" "$out/bay.vox"

say "baking the part"
"$bin/pointshell" "$data/part.obj" --units mm -o "$out/part.pshell" --voxel-size "$voxel_size" \
  --json "$out/pointshell.json"
"$bin/voxinfo" "$out/part.pshell"

say "pressing the part against the scene for ten seconds"
"$bin/voxrun" "$out/bay.vox" "$out/part.pshell" --device sim --motion "$data/press.csv" \
  --duration 10s --json "$out/voxrun.json" --trace "$out/trace.csv"

say "drawing"
"$bin/voxview" draw "$data/bay.json" "$out/bay.vox" "$out/part.pshell" --part "$data/part.obj" --part-units mm \
  --trace "$out/trace.csv" --screenshot "$out/contact.png"
"$root/scripts/plot_run.py" "$out/trace.csv" -o "$out/run.svg"

say "pulling the pin of a gearbox out of its bore, and the cover against its bolts"
gearbox=$data/gearbox.glb
"$bin/voxelize" --list "$gearbox"
for part in Pin Cover; do
  "$bin/voxelize" "$gearbox" --without "$part" --voxel-size 1mm -o "$out/without_$part.vox" --cache "$out/cache"
  "$bin/pointshell" "$gearbox#$part" --voxel-size 1mm -o "$out/$part.pshell"
  "$bin/voxrun" "$out/without_$part.vox" "$out/$part.pshell" --pull 0,0,60mm --trace "$out/$part.csv" --json "$out/$part.json"
done

say "left in $out"
ls -l "$out"
