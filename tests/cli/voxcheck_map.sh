#!/usr/bin/env bash
# voxcheck --report map:FILE: the clearance at each vertex and its color, for whom it counts, and the errors.
source "$FORCELAYER_SOURCE_DIR/tests/support/command_test.sh"

# A plate, a block 20 mm beside the path, a far one, and a cube that goes up from 2 mm above the plate. Millimeters.
box() { # NAME X0 Y0 Z0 X1 Y1 Z1, after $1 vertices
  local first=$1
  shift
  printf 'o %s\n' "$1"
  for z in "$4" "$7"; do for y in "$3" "$6"; do for x in "$2" "$5"; do printf 'v %s %s %s\n' "$x" "$y" "$z"; done; done; done
  for face in "1 3 4" "1 4 2" "5 6 8" "5 8 7" "1 2 6" "1 6 5" "3 7 8" "3 8 4" "1 5 7" "1 7 3" "2 4 8" "2 8 6"; do
    printf f
    for corner in $face; do printf ' %d' $((first + corner)); done
    printf '\n'
  done
}
box 0 plate -100 -100 -10 100 100 0 >plate.obj
box 0 block 30 -10 50 50 10 70 >block.obj
box 0 far 500 0 0 510 10 10 >far.obj
box 0 cube -10 -10 0 10 10 20 >cube.obj
printf 't_s,x_m,y_m,z_m\n0,0,0,0.002\n1,0,0,0.1\n' >path.csv
scene=(plate.obj block.obj far.obj)
"$bin/voxelize" "${scene[@]}" --units mm --voxel-size 2mm --quiet -o scene.vox || fail "the scene"
"$bin/pointshell" cube.obj --units mm --voxel-size 2mm --quiet -o cube.pshell || fail "the part"
exact=(--part cube.obj --units mm --part-units mm)
for mesh in "${scene[@]}"; do exact+=(--exact "$mesh"); done

# check STATUS ARGUMENTS...
check() {
  local wanted=$1 status=0
  shift
  "$bin/voxcheck" scene.vox cube.pshell path.csv "$@" --fail-on nothing --quiet 2>err.txt || status=$?
  [ "$status" -eq "$wanted" ] || fail "status $status instead of $wanted: $*: $(cat err.txt)"
}

check 0 "${exact[@]}" --clearance 6mm --json report.json
check 0 "${exact[@]}" --clearance 6mm --json with.json --report map:map.glb
check 0 "${exact[@]}" --clearance 6mm --report map:map.glb # replaces its own file
check 0 "${exact[@]}" --clearance 6mm --allow block --report map:allowed.glb
printf 'part,object,clearance\n*,block,ignore\n*,plate,touch\n*,*,3mm\n' >rules.csv
check 0 "${exact[@]}" --clearance 6mm --rules rules.csv --report map:rules.glb
"$bin/voxcheck" scene.vox cube.pshell path.csv "${exact[@]}" --time 0s --fail-on nothing --report map:late.glb >out.txt 2>&1 ||
  fail "a map without time: $(cat out.txt)"
grep -q 'time ended before the clearance map was finished' out.txt || fail "no warning: $(cat out.txt)"
PYTHONPATH=$FORCELAYER_SOURCE_DIR/tests/support python3 - <<'END' || fail "the map"
import json
from read_glb import Glb
report, again = json.load(open("report.json")), json.load(open("with.json"))
for key in report:
    assert key in ("seconds", "started") or report[key] == again[key], key

def attributes(glb, name):
    [primitive] = glb.json["meshes"][glb.json["nodes"][glb.node(name)]["mesh"]]["primitives"]
    return {key: glb.rows(number) for key, number in primitive["attributes"].items()}

glb = Glb("map.glb")
legend = glb.json["asset"]["extras"]["clearance_map"]
reach, within = legend["reach_m"], legend["within_m"] + legend["deviations_and_rounding_m"]
assert abs(reach - 0.024) < 1e-12 and legend["required_m"] == 0.006 and within < 0.002, legend
assert [len(legend["colors"]), legend["colors"][0]["clearance_m"], legend["beyond"]] == [10, 0, "#bebebe"]
assert abs(legend["colors"][9]["clearance_m"] - reach) < 1e-12

def linear(step):  # the legend's color at a step of its scale, in the linear steps of 255 of a vertex
    before, after = (bytes.fromhex(legend["colors"][min(9, int(step) + k)]["srgb"][1:]) for k in (0, 1))
    srgb = [(a + (b - a) * (step - int(step))) / 255 for a, b in zip(before, after)]
    return [255 * (v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4) for v in srgb]

# The cube's place, centroid in its middle, from 12 mm up to 110 mm.
def from_cube(x, y, z):  # of a place of the scene: the least distance over the path
    return min(sum(max(abs(v) - 0.01, 0) ** 2 for v in (x, y, z - at)) ** 0.5
               for at in [0.012 + 0.0005 * n for n in range(197)])
def from_scene(x, y, z):
    block = lambda up: sum(max(low - v, v - high, 0) ** 2
                           for v, low, high in ((x, 0.03, 0.05), (y, -0.01, 0.01), (z + up, 0.05, 0.07))) ** 0.5
    return min([z + 0.012] + [block(0.012 + 0.0005 * n) for n in range(197)])
def compare(name, truth):
    here = attributes(glb, name)
    assert len(here["POSITION"]) == len(here["COLOR_0"]) == len(here["_CLEARANCE_M"])
    for place, (clearance,), color in zip(here["POSITION"], here["_CLEARANCE_M"], here["COLOR_0"]):
        least = min(truth(*place), reach)
        assert least - within - 1e-4 <= clearance <= least + 1e-9, (name, place, clearance, least)
        if clearance < 0.999 * reach:
            assert color[3] == 255 and all(abs(a - b) <= 2 for a, b in zip(color, linear(clearance / reach * 9))), color
    return len(here["POSITION"])
for name, truth, more in ("plate", from_cube, 40), ("block", from_cube, 8), ("cube", from_scene, 40):
    assert compare(name, truth) > more, name
far = attributes(glb, "far")
assert len(far["POSITION"]) == 8 and all(abs(c - reach) < 1e-8 for (c,) in far["_CLEARANCE_M"])
assert len(set(far["COLOR_0"])) == 1
# The part is drawn where the path begins, also by viewers that do not play the motion.
assert all(abs(a - b) < 1e-7 for a, b in zip(glb.json["nodes"][glb.node("cube")]["translation"], (0, 0, 0.012)))

allowed = Glb("allowed.glb")
assert "_CLEARANCE_M" not in attributes(allowed, "block") and "_CLEARANCE_M" in attributes(allowed, "plate")
def top(of):  # the cube's upper corners: 22 mm above the plate, two of them 20 mm beside the block
    here = attributes(of, "cube")
    return min(c for place, (c,) in zip(here["POSITION"], here["_CLEARANCE_M"]) if place[2] > 0.00999)
# Straight up, it is exact. Places are 32-bit floats: seven digits.
assert within < 1e-7 and 0.02 - 1e-7 < top(glb) <= 0.02 and 0.022 - 1e-7 < top(allowed) <= 0.022, (within, top(glb), top(allowed))
rules = Glb("rules.glb")
assert "_CLEARANCE_M" not in attributes(rules, "block") and "_CLEARANCE_M" in attributes(rules, "plate")
assert abs(rules.json["asset"]["extras"]["clearance_map"]["reach_m"] - 0.012) < 1e-12
late = Glb("late.glb")
assert "extras" not in late.json["asset"] and "_CLEARANCE_M" not in attributes(late, "cube")
END

# The commands read the file as any other assembly.
"$bin/voxelize" --list map.glb >list.txt || fail "cannot read it"
grep -q plate list.txt || fail "no plate: $(cat list.txt)"

# No map without meshes, and none in place of a file of others.
check 2 --report map:other.glb
grep -q -- '--report map: needs the meshes' err.txt && [ ! -e other.glb ] || fail "without meshes: $(cat err.txt)"
check 2 "${exact[@]}" --report map:plate.obj
grep -q 'is an input of this command' err.txt || fail "an input: $(cat err.txt)"
check 2 "${exact[@]}" --report map:one.glb --report animation:one.glb
grep -q 'is also the output of' err.txt || fail "the same file twice: $(cat err.txt)"
finish
