#!/usr/bin/env bash
# STEP assemblies from the command line and from a manifest, in a build with OpenCASCADE: the same voxels, and a
# tessellation that is tied to the voxel size and comes off the guarantee.
set -u
source "$FORCELAYER_SOURCE_DIR/tests/support/command_test.sh"
feature=$FORCELAYER_SOURCE_DIR/tests/models/featuretype.step

printf 'ISO-10303-21;' >nothing.step
"$bin/voxelize" nothing.step --voxel-size 1mm -o nothing.vox 2>err
[ $? = 3 ] && [ "$(wc -l <err)" = 1 ] && [ ! -e nothing.vox ] || fail "a damaged STEP file: $(cat err)"
if grep -q "built without STEP" err; then
  printf '{"voxel_size": "1mm", "parts": [{"mesh": "nothing.step"}]}' >nothing.json
  "$bin/voxelize" nothing.json -o nothing.vox 2>err
  [ $? = 3 ] && grep -q "built without STEP" err || fail "STEP in a manifest: $(cat err)"
  [ $failures = 0 ] || exit 1
  skip "needs libocct-data-exchange-dev of scripts/packages.txt"
fi
"$bin/make_step_assembly" clamp.step || exit 1
clamp=$PWD/clamp.step

# OpenCASCADE is loaded by need: a program without its library bakes the rest, and says what is missing.
mkdir -p alone/bin && cp "$bin/voxelize" alone/bin/
alone/bin/voxelize "$clamp" --voxel-size 4mm -o alone.vox 2>err
[ $? = 3 ] && [ "$(wc -l <err)" = 1 ] && grep -q "the reader of STEP and IGES cannot be loaded" err && [ ! -e alone.vox ] ||
  fail "without the library: $(cat err)"
printf 'v 0 0 0\nv 9 0 0\nv 0 9 0\nf 1 2 3\n' >triangle.obj
alone/bin/voxelize triangle.obj --units mm --voxel-size 4mm --quiet -o alone.vox || fail "a mesh without the library"

bake() {  # bake OUTPUT INPUT ARGUMENTS...
  local output=$1
  shift
  "$bin/voxelize" "$@" -o "$output.vox" --quiet --allow-outside --json "$output.json" 2>err || fail "voxelize $*: $(cat err)"
}
rows() { "$bin/voxinfo" export "$1.vox" "$1.csv" >/dev/null && cat "$1.csv"; }

# A listing without a voxel size: triangles follow the shape, not its size. The same assembly 1000 times as large has
# no more than a few times as many.
sed 's/SI_UNIT(.MILLI.,.METRE.)/SI_UNIT($,.METRE.)/' clamp.step >large.step
for file in clamp large; do
  "$bin/voxelize" --list $file.step --json listed_$file.json --quiet 2>err || fail "list of $file: $(cat err)"
done
python3 - <<'PYTHON' || fail "triangles of a listing"
import json
clamp, large = (json.load(open(f"listed_{name}.json"))["files"][0]["whole"] for name in ("clamp", "large"))
assert abs(large["high_m"][0] / clamp["high_m"][0] - 1000) < 1, (large, clamp)
assert clamp["triangles"] <= large["triangles"] < 10 * clamp["triangles"], (large, clamp)
PYTHON

# From the command line: the assembly's 18 parts, its own unit, finer triangles for smaller voxels.
for size in 4mm 1mm 0.5mm; do
  bake clamp_$size "$clamp" --voxel-size $size
done
bake feature_4mm "$feature" --voxel-size 4mm
printf 'solid s\nfacet\nouter loop\nvertex 0 0 0\nvertex 9 0 0\nvertex 0 9 0\nendloop\nendfacet\nendsolid s\n' >one.stl
# From a manifest, with a place, a declared deviation, and beside a mesh.
cat >scene.json <<JSON
{"voxel_size": "4mm", "parts": [
  {"name": "clamp", "mesh": "$clamp", "translation": ["28mm", 0, "-12mm"]},
  {"name": "feature", "mesh": "$feature", "translation": ["1m", 0, 0], "mesh_deviation": "0.3mm"},
  {"name": "mesh", "mesh": "one.stl", "units": "mm", "translation": [0, "2m", 0]}]}
JSON
bake placed scene.json
# One sub-tree, as the command line and the manifest name it.
bake rod "$clamp#rod-assembly_1" --voxel-size 4mm
printf '{"voxel_size": "4mm", "parts": [{"mesh": "%s"}]}' "$clamp#rod-assembly_1" >rod_manifest.json
bake rod_scene rod_manifest.json
cmp -s <(rows rod) <(rows rod_scene) || fail "a sub-tree in a manifest has other voxels"
# The same from a cache, which must not keep a coarser tessellation.
for size in 4mm 1mm 4mm 1mm; do
  bake cached "$clamp" --voxel-size $size --cache cache
  cmp -s cached.vox clamp_$size.vox || fail "other bytes from the cache at $size"
done

rows clamp_4mm >clamp.rows
rows placed >scene.rows
python3 - <<'PYTHON' || fail "figures of the reports"
import json
def report(name): return json.load(open(name + ".json"))
sizes = ["4mm", "1mm", "0.5mm"]
reports = [report("clamp_" + size) for size in sizes]
assert all(len(r["parts"]) == 18 for r in reports), [len(r["parts"]) for r in reports]
triangles = [r["triangles"] for r in reports]
assert triangles[0] < triangles[1] < triangles[2], triangles
for r in reports:
    # No less than the deflection asked for, a hundredth of a voxel, and the snap; the curves of this model allow it.
    share = r["static_deviation_m"] / r["voxel_size_m"]
    assert 0.01 < share < 0.012, share
    closed = [p for p in r["parts"] if p["boundary_edges"] == 0 and p["interior_voxels"] > 0]
    assert r["voxel_size_m"] > 1e-3 or len(closed) == 18, [p["name"] for p in r["parts"] if p not in closed]
feature, scene = report("feature_4mm"), report("placed")
# The worst part's: what its faces deviate and what the manifest declares on top.
assert abs(scene["static_deviation_m"] - feature["static_deviation_m"] - 3e-4) < 1e-9, scene["static_deviation_m"]
assert scene["triangles"] == reports[0]["triangles"] + feature["triangles"] + 1
def voxels(path):
    return {tuple(int(x) for x in line.split(",")) for line in open(path) if line[0] in "-0123456789"}
moved = {(i + 7, j, k - 3, value) for i, j, k, value in voxels("clamp.rows")}
there = {v for v in voxels("scene.rows") if v[0] < 200 and v[1] < 400}
assert moved and moved == there, (len(moved), len(there))
PYTHON

# Parts in files of their own: the same voxels, also in the sandbox; what is missing or lies elsewhere is one line.
mkdir -p external/home
(cd external/home && "$bin/make_step_assembly" clamp.step MM external) || exit 1
part=external/home/clamp.step
for more in "" --sandbox; do
  "$bin/voxelize" $part --voxel-size 4mm -o parts.vox --quiet $more 2>err || fail "external references $more: $(cat err)"
  cmp -s <(rows parts) clamp.rows || fail "external references give other voxels $more"
done
refuse() {  # refuse STATUS TEXT OPTIONS...: by both commands, with nothing written
  local status=$1 text=$2
  shift 2
  for command in "voxelize --voxel-size 4mm -o no.vox" "pointshell --voxel-size 4mm -o no.pshell"; do
    "$bin/"$command $part --quiet "$@" 2>err
    [ $? = "$status" ] && [ "$(wc -l <err)" = 1 ] && grep -qF -- "$text" err || fail "$command $*, not '$text': $(cat err)"
    [ ! -e no.vox ] && [ ! -e no.pshell ] || fail "$command $*: a file was written"
  done
}
mv external/home/rod.stp external/rod.stp
refuse 1 "clamp/rod-assembly_1/rod_1: the shape of this node is in the file 'rod.stp', which is missing"
sed -i "s|'rod.stp'|'../rod.stp'|" $part
for more in --quiet --sandbox; do
  refuse 3 "clamp/rod-assembly_1/rod_1: the shape of this node is in the file '../rod.stp', which lies outside the folder" $more
  "$bin/voxelize" $part --voxel-size 4mm -o parts.vox --quiet --allow-outside $more 2>err || fail "--allow-outside $more: $(cat err)"
  cmp -s <(rows parts) clamp.rows || fail "--allow-outside gives other voxels $more"
done
# A file read from another place is a warning, on the terminal and in the reports.
mv external/rod.stp external/home
"$bin/voxelize" $part --voxel-size 4mm -o parts.vox --json parts.json >out 2>err || fail "by name: $(cat err)"
"$bin/pointshell" $part --voxel-size 4mm -o parts.pshell --method fast --json shell.json >out 2>>err || fail "by name: $(cat err)"
[ "$(grep -c "warning: .*this node names the file '../rod.stp', but external/home/rod.stp was read" err)" = 2 ] || fail "warnings: $(cat err)"
"$bin/voxelize" $part --voxel-size 4mm --plan --json plan.json >out 2>err || fail "plan: $(cat err)"
python3 - <<'PYTHON' || fail "warnings of the reports"
import json
for name in ("parts", "shell", "plan"):
    warnings = json.load(open(name + ".json"))["warnings"]
    assert len([w for w in warnings if "but external/home/rod.stp was read" in w]) == 1, (name, warnings)
PYTHON

# A surface of 8 m with 2304 patches takes OpenCASCADE gigabytes: that is announced before, the wait after 20 s, and --quiet is quiet.
python3 - >wavy.step <<'PYTHON'
import math
n = 50
name = lambda i, j: f"#{20000 + n * i + j}"
sweep = lambda i, waves: math.sin(2 * math.pi * waves * i / (n - 1))
rows = ",".join("(" + ",".join(name(i, j) for j in range(n)) + ")" for i in range(n))
knots = "(4," + "1," * (n - 4) + "4)"
values = "(" + ",".join(f"{k}." for k in range(n - 2)) + ")"
surface = f"#9006=B_SPLINE_SURFACE_WITH_KNOTS('',3,3,({rows}),.UNSPECIFIED.,.F.,.F.,.F.,{knots},{knots},{values},{values},.UNSPECIFIED.);"
points = "".join(f"{name(i, j)}=CARTESIAN_POINT('',({160 * i}.,{160 * j}.,{100 * sweep(i, 12) * sweep(j, 9):.6f}));\n"
                 for i in range(n) for j in range(n))
head = """ISO-10303-21;
HEADER;
FILE_DESCRIPTION((''),'2;1');
FILE_NAME('','',(''),(''),'','','');
FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));
ENDSEC;
DATA;
#1=APPLICATION_CONTEXT('');
#2=PRODUCT_CONTEXT('',#1,'mechanical');
#3=PRODUCT('wavy','wavy','',(#2));
#4=PRODUCT_DEFINITION_FORMATION('','',#3);
#5=PRODUCT_DEFINITION_CONTEXT('part definition',#1,'design');
#6=PRODUCT_DEFINITION('','',#4,#5);
#7=PRODUCT_DEFINITION_SHAPE('','',#6);
#8=(LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.));
#9=(NAMED_UNIT(*) PLANE_ANGLE_UNIT() SI_UNIT($,.RADIAN.));
#10=(GEOMETRIC_REPRESENTATION_CONTEXT(3) GLOBAL_UNIT_ASSIGNED_CONTEXT((#8,#9)) REPRESENTATION_CONTEXT('',''));
#11=SHAPE_REPRESENTATION('',(#12),#10);
#12=GEOMETRIC_SET('',(#9006));
#13=SHAPE_DEFINITION_REPRESENTATION(#7,#11);
"""
print(head + points + surface + "\nENDSEC;\nEND-ISO-10303-21;")
PYTHON
for more in "" --quiet; do
  timeout 23 "$bin/voxelize" wavy.step --voxel-size 5mm -o no.vox $more 2>err_$more >out &
done
wait
grep -q "is still being read after 20 s: the deflection is 0.05 mm (a hundredth of a voxel); larger voxels make reading faster" err_ || fail "a slow file: $(cat err_)"
grep -q "wavy.step becomes about 3.1 million triangles, which take about 0.57 minutes and up to 6.3 GB" err_ || fail "no forecast: $(cat err_)"
[ "$(grep -n "becomes about" err_ | cut -d: -f1)" -lt "$(grep -n "is still being read after" err_ | cut -d: -f1)" ] || fail "the forecast came late"
! grep -q "becomes about\|is still being read" err_--quiet || fail "--quiet is not: $(cat err_--quiet)"

# A file of more than 100 MB is forecast before it is parsed.
"$bin/make_box_file" large.step || exit 1
head -c 130000000 /dev/zero | tr '\0' ' ' >>large.step
"$bin/voxelize" large.step --voxel-size 4mm -o no.vox 2>err >out
grep -q "large.step: parsing its 130 MB takes about 0.69 minutes and 1.3 GB of memory; Ctrl-C stops it" err || fail "no forecast of a large file: $(cat err)"
"$bin/voxelize" large.step --voxel-size 4mm -o no.vox --quiet 2>err >out
! grep -q "parsing its" err || fail "--quiet is not: $(cat err)"
rm -f large.step no.vox

# OpenCASCADE crashes on a surface model without shells: one line, and nothing written.
"$bin/make_box_file" sound.step || exit 1
python3 - <<'PYTHON'
text = open("sound.step").read()
end = text.rindex("ENDSEC;")
open("damaged.step", "w").write(text[:end] + "#9001=SHELL_BASED_SURFACE_MODEL('sheets',());\n" + text[end:])
PYTHON
for command in "voxelize -o no.vox" "pointshell -o no.pshell"; do
  # A sanitizer would report the crash itself, and end the process with a status.
  ASAN_OPTIONS=handle_segv=0 "$bin/"$command damaged.step --voxel-size 4mm --quiet --json no.json 2>err
  [ $? = 3 ] && [ "$(wc -l <err)" = 1 ] && grep -q '^[a-z]*: damaged.step: the reader of this file crashed (Segmentation fault)' err || fail "$command of a file that crashes its reader: $(cat err)"
  [ ! -e no.vox ] && [ ! -e no.pshell ] || fail "$command of a file that crashes its reader: a file was written"
  python3 -c 'import json; r = json.load(open("no.json")); assert r["schema_version"] and r["exit_status"] == 3 and "damaged.step" in r["error"]["line"], r' ||
    fail "$command of a file that crashes its reader: no report"
done

finish
