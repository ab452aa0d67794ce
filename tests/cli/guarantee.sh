#!/usr/bin/env bash
# From meshes to a quoted distance: both kinds of shell drive voxrun, and the separation that it prints
# follows from the two files.
set -euo pipefail
bin=$FORCELAYER_BIN_DIR
data=$FORCELAYER_SOURCE_DIR/sample_data
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cd "$scratch"

"$bin/voxelize" "$data/bay.json" -o bay.vox --quiet --mesh-deviation 0.05mm
"$bin/voxinfo" bay.vox --json bay.json >facts
bake() { "$bin/pointshell" "$data/part.obj" --units mm -o "$1.pshell" --voxel-size 5mm --quiet "${@:2}"; }
bake full --mesh-deviation 0.1mm
bake fast --method fast
bake fine --covering-radius 2mm
bake centers --method voxel-centers

# All kinds of maps keep the distance that they promise, whatever the force.
"$bin/voxelize" "$data/bay.json" -o lean.vox --quiet --mesh-deviation 0.05mm --kind lean
"$bin/voxelize" "$data/bay.json" -o chebyshev.vox --quiet --mesh-deviation 0.05mm --kind paper
for kind in bay:distance {bay,lean,chebyshev}:level {bay,lean,chebyshev}:tangent-plane; do
  scene=${kind%:*}
  "$bin/voxrun" $scene.vox fast.pshell --force ${kind#*:} --device sim --motion "$data/press.csv" --duration 2s \
    --as-fast-as-possible --json $kind.run.json >$scene.txt 2>&1 || { cat $scene.txt; exit 1; }
done

# With a standoff the guarantee is the guard's, by distances alone. Another force has none.
"$bin/voxelize" "$data/bay.json" -o near.vox --quiet --voxel-size 5mm --standoff 6.5mm
"$bin/voxrun" near.vox fine.pshell --device sim --motion "$data/press.csv" --duration 2s --as-fast-as-possible \
  --json near.json >near.txt 2>&1 || { cat near.txt; exit 1; }
grep -q "standoff 6.50[0-9] mm" near.txt || { cat near.txt; exit 1; }
python3 - <<'PYTHON'
import json
run = json.load(open("near.json"))
assert 0.0005 < run["guaranteed_swept_separation_m"] < run["guaranteed_separation_m"] < 0.005, run
assert run["force_layer_frames"] > 100 and run["penetration_frames"] == run["barred_frames"] == 0, run
assert run["guaranteed_separation_m"] <= run["min_clearance"]["clearance_m"] < 0.0065, run
PYTHON
status=0
"$bin/voxrun" near.vox fine.pshell --device sim --force tangent-plane --duration 1s >near.txt 2>&1 || status=$?
[ $status != 0 ] && grep -q "leave out --model and --force" near.txt || { cat near.txt; exit 1; }

for shell in full fast fine centers; do
  "$bin/pointshell" verify $shell.pshell "$data/part.obj" --units mm --quiet
  "$bin/voxinfo" $shell.pshell --json $shell.json >facts
  "$bin/voxrun" lean.vox $shell.pshell --device sim --motion "$data/press.csv" --duration 2s \
    --as-fast-as-possible --json $shell.run.json >$shell.txt 2>&1 || { cat $shell.txt; exit 1; }
  "$bin/voxrun" bay.vox $shell.pshell --device sim --motion "$data/press.csv" --duration 2s --as-fast-as-possible \
    --json $shell.full.json >$shell.full.txt 2>&1 || { cat $shell.full.txt; exit 1; }
  grep -q "least proven clearance [0-9.]* mm to [^ ]* at [0-9.]* s, at " $shell.full.txt || { cat $shell.full.txt; exit 1; }
  python3 - $shell <<'PYTHON'
import glob, json, math, re, sys
shell = sys.argv[1]
part, scene, run, full = (json.load(open(name)) for name in
                          (shell + ".json", "bay.json", shell + ".run.json", shell + ".full.json"))
s, k = scene["voxel_size_m"], scene["layers"]
spent = (part["covering_radius_m"] + scene["static_deviation_m"] + part["part_deviation_m"]
         + run["pose_error_m"])
rested = (k - 1) * s - spent
swept = math.sqrt((k - 1) ** 2 - 1 / 16) * s - s * s / (32 * part["bounding_radius_m"]) - spent
assert abs(run["guaranteed_separation_m"] - rested) < 1e-12, (shell, run, rested)
assert abs(run["guaranteed_swept_separation_m"] - swept) < 1e-12, (shell, run, swept)
# With stored distances the guard holds points 1.667 voxels off, and most of that is left for the surface.
# Voxel centers leave corners bare.
assert full["guaranteed_separation_m"] > (0.5 if shell == "centers" else 1.1) * s - full["pose_error_m"] - spent + part["covering_radius_m"], (shell, full)
assert 0 < full["guaranteed_separation_m"] - full["guaranteed_swept_separation_m"] < 0.05 * s, (shell, full)
assert full["barred_frames"] == 0 and full["unproven_frames"] == 0, shell
least = full["min_clearance"]
assert not least["at_least"] and full["guaranteed_separation_m"] < least["clearance_m"] < 3 * s, (shell, least)
printed = re.search(r"guaranteed separation: ([0-9.]+) mm", open(shell + ".txt").read())
assert printed and 0.98 * rested < 1e-3 * float(printed[1]) <= rested, (shell, printed, rested)
assert run["frames"] == 2000 and run["force_layer_frames"] > 100, (shell, run["frames"])
assert run["penetration_frames"] == 0, shell
asked = 0.002 if shell == "fine" else math.sqrt(0.75) * s
assert asked <= part["covering_radius_m"] < asked * 1.0001, shell
assert len(glob.glob("*:*.run.json")) == 7
for kind in glob.glob("*:*.run.json") if shell == "fast" else ():
    other = json.load(open(kind))
    by_distance = kind.startswith("bay:distance")
    proven = full["guaranteed_separation_m"] if by_distance else rested
    assert abs(other["guaranteed_separation_m"] - proven) < 1e-12, (kind, other, proven)
    assert other["force_layer_frames"] > 100 and other["penetration_frames"] == 0, (kind, other)
PYTHON
done
echo "all passed"
