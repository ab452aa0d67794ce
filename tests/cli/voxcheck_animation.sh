#!/usr/bin/env bash
# voxcheck --report animation:FILE: names, shapes and poses of the file are those of the assembly and of the path.
source "$FORCELAYER_SOURCE_DIR/tests/support/command_test.sh"
cp "$data/gearbox.glb" .
"$bin/voxelize" gearbox.glb --without Pin --voxel-size 1mm -o scene.vox --quiet || fail "the scene"
"$bin/pointshell" gearbox.glb#Pin --voxel-size 1mm -o pin.pshell --quiet || fail "the part"
exact=(--exact gearbox.glb --without Pin --part 'gearbox.glb#Pin')

# check STATUS PATH ARGUMENTS...
check() {
  local wanted=$1 status=0
  shift
  "$bin/voxcheck" scene.vox pin.pshell "$@" --fail-on nothing --quiet 2>err.txt || status=$?
  [ "$status" -eq "$wanted" ] || fail "status $status instead of $wanted: $*: $(cat err.txt)"
}

# Out and around, from a time that is not 0. The same motion in steps of a millisecond needs no more poses.
cat >path.csv <<'END'
t_s,x_m,y_m,z_m,qw,qx,qy,qz
5,0,0,0,1,0,0,0
6,0,0,0.06,1,0,0,0
8,0.02,0,0.06,0.5,0,0.8660254037844386,0
END
"$bin/voxinfo" path path.csv --resample 1ms --part pin.pshell -o dense.csv --quiet || fail "steps of a millisecond"
check 0 path.csv "${exact[@]}" --json report.json
check 0 path.csv "${exact[@]}" --json with.json --report animation:motion.glb
check 0 dense.csv "${exact[@]}" --report animation:dense.glb
check 0 dense.csv "${exact[@]}" --report animation:dense.glb  # replaces its own file
PYTHONPATH=$FORCELAYER_SOURCE_DIR/tests/support python3 - <<'END' || fail "the animation"
import json
from read_glb import Glb, lerp
report, again = json.load(open("report.json")), json.load(open("with.json"))
for key in report:
    assert key in ("seconds", "started") or report[key] == again[key], key
glb, gearbox, dense = Glb("motion.glb"), Glb("gearbox.glb"), Glb("dense.glb")
bolts = ["Gearbox/Lid/Bolt" + number for number in ("[1]", "[2]", "[3]", "[4]")]
assert glb.names()[0] == "Pin" and set(bolts) < set(glb.names()), glb.names()
assert len(glb.json["animations"][0]["channels"]) == 2 and glb.json["nodes"][0]["name"] == "world"

# glTF is y up, and the node "world" turns it; poses and vertices are z up.
assert all(abs(a - b) < 1e-6 for a, b in zip(glb.json["nodes"][0]["rotation"], (-0.5**0.5, 0, 0, 0.5**0.5)))
def same(some, others):
    for rows, there in (some, others), (others, some):
        assert all(min(max(abs(a - b) for a, b in zip(row, other)) for other in there) < 1e-7 for row in rows)
def z_up(name, dx=0, dy=0, dz=0):
    return [(x + dx, -z - dz, y + dy) for x, y, z in gearbox.triangles(name)[0]]
pin = z_up("Pin", 0.094, 0, -0.035)
same(glb.triangles("Gearbox/Housing")[0], z_up("Housing"))
same(glb.placed("Pin", 0), pin)
same(glb.placed("Pin", 0.5), [(x, y, z + 0.03) for x, y, z in pin])
turned = lambda c, s, dx, dz: [(c * x + s * z + dx, y, c * z - s * x + dz) for x, y, z in pin]
same(glb.placed("Pin", 3), turned(-0.5, 0.75**0.5, 0.02, 0.06))
# Halfway through the turn: half the angle, and the middle of the straight line of the centroid.
middle, rotation = glb.pose("Pin", 2)
assert max(abs(a - b) for a, b in zip(middle, lerp(glb.pose("Pin", 1)[0], glb.pose("Pin", 3)[0], 0.5))) < 1e-7
assert max(abs(a - b) for a, b in zip(rotation, (0, 0.5, 0, 0.75**0.5))) < 1e-6, rotation

# Fewer poses than rows, and the same motion.
times = dense.rows(dense.json["animations"][0]["samplers"][0]["input"])
assert len(times) == 3 and times[-1] == (3.0,), times
same(dense.placed("Pin", 2.25), glb.placed("Pin", 2.25))
END

# The commands read the file as any other assembly, in the same frame.
"$bin/voxelize" --list motion.glb >list.txt || fail "cannot read it"
grep -q Housing list.txt || fail "no housing: $(cat list.txt)"

# A format that has no rule which axis is up: z is, as in the world of the commands.
cat >box.obj <<'END'
v 0 0 0
v 9 0 0
v 0 9 0
v 0 0 9
f 1 3 2
f 1 2 4
f 2 3 4
f 1 4 3
END
"$bin/voxelize" box.obj --units mm --voxel-size 1mm --quiet -o box.vox || fail "the box"
"$bin/pointshell" box.obj --units mm --voxel-size 1mm --quiet -o box.pshell || fail "the moving box"
printf 't_s,x_m,y_m,z_m\n0,0,0,0.05\n1,0,0,0.07\n' >above.csv
"$bin/voxcheck" box.vox box.pshell above.csv --exact box.obj --part box.obj --units mm --part-units mm --quiet --report animation:box.glb ||
  fail "a box above a box"
PYTHONPATH=$FORCELAYER_SOURCE_DIR/tests/support python3 - <<'END' || fail "which axis is up"
from read_glb import Glb
rotation = Glb("box.glb").json["nodes"][0]["rotation"]
assert all(abs(a - b) < 1e-6 for a, b in zip(rotation, (-0.5**0.5, 0, 0, 0.5**0.5))), rotation
END

# No animation without meshes, and none in place of a file of others.
check 2 path.csv --report animation:other.glb
grep -q -- '--report animation: needs the meshes' err.txt && [ ! -e other.glb ] || fail "without meshes: $(cat err.txt)"
check 2 path.csv "${exact[@]}" --report animation:gearbox.glb
grep -q 'is an input of this command' err.txt || fail "an input: $(cat err.txt)"
cp gearbox.glb mine.glb
check 2 path.csv "${exact[@]}" --report animation:mine.glb
grep -q 'not an animation that Forcelayer wrote' err.txt && cmp -s gearbox.glb mine.glb || fail "replaced: $(cat err.txt)"
finish
