#!/usr/bin/env bash
# Faces of STEP files that get no triangles, in both bakes: the error, the ways out, and what the files say of
# it. One tessellation for scene and part.
set -u
source "$FORCELAYER_SOURCE_DIR/tests/support/command_test.sh"
[ -x "$bin/make_step_faces" ] || skip "needs libocct-data-exchange-dev of scripts/packages.txt"
"$bin/make_step_faces" tray.step || exit 1
feature=$FORCELAYER_SOURCE_DIR/tests/models/featuretype.step

# expect STATUS WORD COMMAND ARGUMENTS...: the status; WORD on stderr. An error is one line and leaves no file.
expect() {
  local status=$1 word=$2
  shift 2
  rm -f out.vox out.pshell
  "$bin/$1" "${@:2}" >out 2>err
  local actual=$?
  [ $actual = "$status" ] || fail "status $actual, not $status: $*: $(cat err)"
  [ -z "$word" ] || grep -qF -- "$word" err || fail "no '$word': $*: $(cat err)"
  [ "$status" = 0 ] && return
  [ "$(wc -l <err)" = 1 ] && [ ! -e out.vox ] && [ ! -e out.pshell ] || fail "not one line, or a file: $*: $(cat err)"
}
vox=(voxelize tray.step --voxel-size 2mm -o out.vox)
part=(pointshell tray.step --voxel-size 2mm --method fast -o out.pshell)

place="tray/bad at (450, 10, 40) mm, 102 mm across"
for bake in vox part; do
  declare -n call=$bake
  for more in "" "--missing-faces=0" "--sandbox"; do
    expect 3 "$place" "${call[@]}" $more
    grep -q -- "--missing-faces 1" err || fail "$bake: no way out: $(cat err)"
  done
  for wrong in -1 1.5 some; do
    expect 2 "missing-faces" "${call[@]}" --missing-faces=$wrong
  done
  for more in "" "--sandbox"; do
    expect 0 "a face is missing, and no guarantee covers it: $place" "${call[@]}" --missing-faces 1 --json $bake.json $more
    expect 0 "" "${call[@]}" --missing-faces 1 --quiet $more
    [ ! -s err ] || fail "$bake: --quiet is not: $(cat err)"
  done
done
expect 3 "$place; repair these faces in the CAD system, or list the other parts in a manifest" forcelayer pairs tray.step
expect 0 "" "${vox[@]}" --missing-faces 1 --quiet && mv out.vox scene.vox
expect 0 "" "${part[@]}" --missing-faces 1 --quiet && mv out.pshell part.pshell
for file in scene.vox part.pshell; do
  expect 0 "" voxinfo $file --json $file.json
  grep -q "1 face is missing from the mesh, and no guarantee covers it" out || fail "voxinfo $file: $(cat out)"
done
# The picture marks what scene and part lack, by their meshes or by what the baked files say.
if [ -x "$bin/voxview" ] && command -v xvfb-run >tool; then
  for more in "" "--part tray.step" "tray.step"; do
    xvfb-run -a "$bin/voxview" scene.vox part.pshell $more --size 64x64 --screenshot face.png --json face.json --quiet ||
      fail "no picture: $more"
    grep -q '"missing_faces": 1,' face.json || fail "the scene's face is not marked: $more: $(cat face.json)"
    grep -q '"part_missing_faces": 1$' face.json || fail "the part's face is not marked: $more: $(cat face.json)"
  done
fi
# The proof again, from the file: it needs the same word.
expect 3 "--missing-faces 1" pointshell verify part.pshell tray.step
expect 0 "" pointshell verify part.pshell tray.step --missing-faces 1
# A run says whose guarantee it is.
printf 't_s,x_m,y_m,z_m,qw,qx,qy,qz\n0,2,0,0,1,0,0,0\n1,2,0,0,1,0,0,0\n' >still.csv
expect 0 "scene.vox: 1 face is missing from the mesh" voxrun scene.vox part.pshell --device sim --motion still.csv \
  --duration 0.1s --as-fast-as-possible --json run.json
grep -q "part.pshell: 1 face is missing from the mesh" err || fail "voxrun on the part: $(cat err)"
# So do a check, which is clear of what is there, a plan, and a study with its page.
expect 0 "part.pshell: 1 face is missing from the mesh" voxcheck scene.vox part.pshell still.csv --clearance 1mm --json check.json
grep -q "scene.vox: 1 face is missing from the mesh" err || fail "voxcheck on the scene: $(cat err)"
expect 0 "" voxcheck scene.vox part.pshell still.csv --clearance 1mm --quiet
[ ! -s err ] || fail "voxcheck --quiet is not: $(cat err)"
grep -q '"missing_faces": 2,' check.json || fail "the report of voxcheck: $(cat check.json)"
if [ -x "$bin/voxplan" ]; then
  "$bin/voxplan" scene.vox part.pshell --time 0.1s -o plan.csv >out 2>err
  grep -q "voxplan: warning: scene.vox: 1 face is missing from the mesh" err || fail "voxplan: $(cat err)"
fi
study=(forcelayer study "tray.step#cube" --voxel-size 2mm --pull 0,0,60mm --clearance 1mm -o study)
"$bin/${study[0]}" "${study[@]:1}" >out 2>err && fail "a study of a scene that cannot be read"
expect 0 "" "${study[@]}" --missing-faces 1
grep -q "faces that could not be read</th><td>1 of scene and part; the verdict does not cover them" study/report.html || fail "the page does not say what is missing"
grep -q '^  faces that could not be read: 1 of scene and part; the answer does not cover them$' study/verdict.txt || fail "what is missing: $(cat study/verdict.txt)"

# A solid that OpenCASCADE does not read (a constructive one in the cube): the same ways out of one file.
python3 - <<'EOF' || exit 1
import re
text = open("tray.step").read()
shape = text.index("ADVANCED_BREP_SHAPE_REPRESENTATION")
text = text[:shape] + re.sub(r"\((#\d+),", r"(\1,#99999,", text[shape:], count=1)
frame = re.search(r"\((#\d+),#99999", text)[1]
end = text.rindex("ENDSEC;")
open("torn.step", "w").write(text[:end] + f"#99999=CSG_SOLID('lid',#99998);\n#99998=BLOCK('',{frame},5.,5.,5.);\n" + text[end:])
EOF
vox=(voxelize torn.step --voxel-size 2mm -o out.vox --without bad)
part=(pointshell "torn.step#cube" --voxel-size 2mm --method fast -o out.pshell)
for bake in vox part; do
  declare -n call=$bake
  expect 3 "tray/cube: OpenCASCADE could not read 1 solid: #99999 CSG_SOLID 'lid'" "${call[@]}"
  grep -q -- ", or accept the holes with --missing-faces 1" err || fail "$bake: no way out: $(cat err)"
  [ "$(grep -c -- "leave out the node of these faces with --without" err)" = $([ $bake = vox ] && echo 1 || echo 0) ] ||
    fail "$bake: leaving its only node out leaves nothing, one of several the others: $(cat err)"
  expect 0 "CSG_SOLID 'lid' is missing, and no guarantee covers it: tray/cube, somewhere in the region at (" "${call[@]}" --missing-faces 1
done
expect 0 "" "${vox[@]}" --without cube
expect 0 "" pointshell "torn.step#seam" --voxel-size 2mm --method fast -o out.pshell
vox=(voxelize tray.step --voxel-size 2mm -o out.vox)

# A cache does not forget what was not accepted.
expect 0 "no guarantee covers it" "${vox[@]}" --missing-faces 1 --cache cache
expect 0 "no guarantee covers it" "${vox[@]}" --missing-faces 1 --cache cache
cmp -s out.vox scene.vox || fail "other bytes from the cache"
expect 3 "$place" "${vox[@]}" --cache cache

# --without: before the faces are tessellated, by label or path; a name that fits nothing is an error.
for node in bad tray/bad; do
  expect 0 "" "${vox[@]}" --without $node --json without.json --cache cache
  mv out.vox $(basename $node).vox
done
expect 0 "" "${vox[@]}" --without bad --sandbox
cmp -s out.vox bad.vox || fail "--without in a sandbox gives other bytes"
expect 3 "nearest names are: tray/seam" voxelize tray.step --voxel-size 2mm -o out.vox --without sem --missing-faces 1
expect 3 "no node of this file is called 'sem'" "${vox[@]}" --without sem
expect 3 "--without leaves out all faces of this file; keep at least one node of this file, or leave out the whole file" "${vox[@]}" --without tray
printf 'v 0 0 0\nv 9 0 0\nv 0 9 0\nf 1 2 3\n' >one.obj
expect 3 "no file has a node called 'bad'; a file of this format has only one part" voxelize one.obj --units mm --voxel-size 2mm -o out.vox --without bad
expect 0 "" voxelize one.obj tray.step#seam tray.step#cube --units mm --voxel-size 2mm -o out.vox --without bad
printf '{"voxel_size": "2mm", "parts": [{"mesh": "tray.step"}, {"mesh": "one.obj", "units": "mm"}]}' >scene.json
expect 0 "" voxelize scene.json -o out.vox --without bad

# Same file, same voxel size, same triangles.
for size in 4mm 1mm; do
  expect 0 "" voxelize "$feature" --voxel-size $size -o out.vox --json scene_$size.json && mv out.vox scene_$size.vox
  expect 0 "" pointshell "$feature" --voxel-size $size --method fast -o out.pshell --json part_$size.json &&
    mv out.pshell part_$size.pshell
  expect 0 "" pointshell verify part_$size.pshell "$feature"
done
# A part at small voxels keeps a guarantee: 0.1 mm of deflection would leave none.
"$bin/make_step_assembly" clamp.step || exit 1
nut=clamp.step#clamp/rod-assembly_1/nut_1
expect 0 "" voxelize $nut --voxel-size 0.5mm -o out.vox --quiet && mv out.vox nut.vox
expect 0 "" pointshell $nut --voxel-size 0.5mm --method fast -o out.pshell --quiet && mv out.pshell nut.pshell
sed 's/,2,0,0,/,2,2,0,/' still.csv >far.csv
expect 0 "" voxrun nut.vox nut.pshell --device sim --motion far.csv --duration 0.1s --as-fast-as-possible --json nut.json
# --mesh-deviation adds to what the tessellation deviates, in both.
expect 0 "" voxelize "$feature" --voxel-size 4mm -o out.vox --mesh-deviation 0.3mm --json scene_more.json
expect 0 "" pointshell "$feature" --voxel-size 4mm --method fast -o out.pshell --mesh-deviation 0.3mm --json part_more.json
python3 - <<'PYTHON' || fail "figures of the reports"
import json
def report(name): return json.load(open(name + ".json"))
for name in ("vox", "part"):
    (face,) = report(name)["missing_faces"]
    assert face["node"] == "tray/bad", face
    assert all(abs(a - b) < 1e-4 for a, b in zip(face["center_m"], (0.45, 0.01, 0.04))), face
    assert abs(face["size_m"] - 0.1) < 0.003, face
assert report("run")["missing_faces"] == 2
for name in ("scene.vox", "part.pshell"):
    assert len(report(name)["provenance"]["missing_faces"]) == 1, name
without = report("without")
assert without["without"] == ["tray/bad"] and without["missing_faces"] == [], without
assert [p["name"] for p in without["parts"]] == ["tray/cube", "tray/seam"], without["parts"]
triangles = []
for size, s in (("4mm", 0.004), ("1mm", 0.001)):
    scene, part = report("scene_" + size), report("part_" + size)
    assert scene["triangles"] == part["triangles"], (size, scene["triangles"], part["triangles"])
    triangles.append(part["triangles"])
    # The scene's has the rounding of its vertices beside. Loose edges of the file may deviate more than asked for.
    assert 0.01 * s <= part["part_deviation_m"] <= scene["static_deviation_m"], (size, part, scene)
    assert scene["static_deviation_m"] - part["part_deviation_m"] < 0.002 * s, (size, part, scene)
assert triangles[0] < triangles[1], triangles
assert report("nut")["guaranteed_swept_separation_m"] > 0.02e-3
for name, key in (("scene", "static_deviation_m"), ("part", "part_deviation_m")):
    assert abs(report(name + "_more")[key] - report(name + "_4mm")[key] - 3e-4) < 1e-12, name
PYTHON

finish
