#!/usr/bin/env bash
# voxcheck on boxes whose clearance is known by hand: what is inside of what, walls beside a seat, meshes of another bake.
source "$FORCELAYER_SOURCE_DIR/tests/support/voxcheck_test.sh"

python3 - <<'END'
import json
FACES = (-8, -6, -5, -7), (-4, -3, -1, -2), (-8, -7, -3, -4), (-6, -2, -1, -5), (-8, -4, -2, -6), (-7, -5, -1, -3)
def boxes(name, *low_high):  # mm
    with open(name + ".obj", "w") as file:
        for pair in low_high:
            for n in range(8):
                file.write("v %r %r %r\n" % tuple(pair[n >> axis & 1][axis] for axis in range(3)))
            file.writelines("f %d %d %d %d\n" % face for face in FACES)
def box(name, low, high):
    boxes(name, (low, high))
def scene(name, **parts):
    with open(name + ".json", "w") as file:
        json.dump({"parts": [{"name": key, "mesh": mesh + ".obj", "units": "mm", "translation": [0, 0, f"{up}mm"]}
                             for key, (mesh, up) in parts.items()]}, file)
def path(name, *rows):
    with open(name + ".csv", "w") as file:
        file.write("t_s,x_mm,y_mm,z_mm\n" + "".join("%g,%g,%g,%g\n" % row for row in rows))
box("floor", (-50, -50, -10), (50, 50, 0))
box("wall", (60, -50, -10), (70, 50, 60))
box("part", (-5, -5, -5), (5, 5, 5))
box("older", (-3, -3, -1), (3, 3, 1))
boxes("socket", ((-10, -10, -20), (-5.5, 10, 0)), ((5.5, -10, -20), (10, 10, 0)))
box("ceiling", (-50, -50, 9), (50, 50, 19))
box("deeper", (-5, -5, -9), (5, 5, 5))
scene("room", floor=("floor", 0), wall=("wall", 0))
scene("below", socket=("socket", 0), ceiling=("ceiling", 0))
scene("raised", floor=("floor", 2.5), wall=("wall", 0))
scene("sunk", floor=("floor", -5), wall=("wall", 0))
scene("aside", floor=("floor", 0), wall=("wall", 40))
scene("swapped", floor=("wall", 0), wall=("floor", 0))
scene("reordered", wall=("wall", 0), floor=("floor", 0))
for name, key, value in ("scaled", "scale", 1.5), ("turned", "rotation", [0, 0, 0, 1]):
    changed = json.load(open("room.json"))
    changed["parts"][1][key] = value
    json.dump(changed, open(name + ".json", "w"))
# The same box and as many triangles: one quad is cut along its other diagonal; the middle of the top is 1 mm deeper.
for name in "floor", "part":
    *lines, last = open(name + ".obj").read().splitlines()
    a, *others = last.split()[1:]
    open("cut_" + name + ".obj", "w").write("\n".join([*lines, " ".join(["f", *others, a])]) + "\n")
for name, down in ("dented", 1), ("deepened", 2):
    box(name, (-50, -50, -10), (50, 50, 0))
    lines = open(name + ".obj").read().splitlines()
    lines.remove("f -4 -3 -1 -2")  # the top
    with open(name + ".obj", "w") as file:
        file.write("\n".join(lines) + "\nv 0 0 %d\n" % -down)
        file.writelines("f %d %d 9\n" % pair for pair in ((5, 6), (6, 8), (8, 7), (7, 5)))
scene("cut", floor=("cut_floor", 0), wall=("wall", 0))
for name in "dented", "deepened":
    scene(name + "_room", floor=(name, 0), wall=("wall", 0))
with open("tip.obj", "w") as file:
    for vertex in (.1, .1, 1.9), (9, 0, 30), (-4, 8, 30), (-4, -8, 30):
        file.write("v %g %g %g\n" % vertex)
    file.writelines("f %d %d %d\n" % face for face in ((1, 3, 2), (1, 4, 3), (1, 2, 4), (2, 3, 4)))
boxes("chamber", ((-50, -50, -50), (50, 50, -40)), ((-50, -50, 40), (50, 50, 50)), ((-50, -50, -40), (-40, 50, 40)),
      ((40, -50, -40), (50, 50, 40)), ((-40, -50, -40), (40, -40, 40)), ((-40, 40, -40), (40, 50, 40)))
scene("chamber", chamber=("chamber", 0))
path("still", (0, 0, 0, 0))
path("over", (0, -30, 0, 30), (1, -30, 0, 8), (2, 48, 0, 8), (3, 48, 0, 30))  # 3 mm above the floor, 7 before the wall
# A cube on a floor, 2.5 mm beside a wall: up, on a way that goes sideways by that much.
box("stand", (-30, -30, -10), (30, 30, 0))
box("beside", (7.5, -30, 0), (17.5, 30, 40))
box("cube", (-5, -5, 0), (5, 5, 10))
scene("corner", Floor=("stand", 0), Wall=("beside", 0))
for name, x in ("into", 2.7), ("close", 2.45), ("clear", 1):
    path(name, (0, 0, 0, 0), (0.1, x, 0, 3), (0.9, x, 0, 27), (1, x, 0, 45))
path("high", (0, 0, 0, 1), (1, 0, 0, 45))
path("rise", (0, 0, 0, 0), (1, 0, 0, 50))
path("pressed", (0, 0, 0, -0.4), (1, 0, 0, 45))  # out of a press fit
# A rib in a groove of the floor, 0.2 mm below: each voxel is nearer to the floor.
boxes("grooved", ((-30, -30, -10), (20, 30, 0)), ((21, -30, -10), (60, 30, 0)))
box("rib", (20.2, -30, -10), (20.8, 30, -0.2))
scene("ribbed", Floor=("grooved", 0), Rib=("rib", 0))
# A block before a thick wall, a clip of sheet over a tab of sheet.
box("thick", (-100, -100, -100), (0, 100, 100))
box("block", (.5, -30, -30), (60.5, 30, 30))
box("tab", (-.45, -30, -60), (.45, 30, 0))
boxes("clip", ((-1.55, -10, -20), (-.65, 10, 1.1)), ((.65, -10, -20), (1.55, 10, 1.1)), ((-.65, -10, .2), (.65, 10, 1.1)))
path("press", (0, 0, 0, 0), (1, -1.5, 0, 0), (2, 60, 0, 0))
path("sideways", (0, 0, 0, 0), (1, 40, 0, 0))
path("upwards", (0, 0, 0, 0), (1, 0, 0, 40))
for name, down in ("slide", 0), ("sink", -0.001):
    with open(name + ".csv", "w") as file:
        file.write("t_s,x_mm,y_mm,z_mm,rx_deg,ry_deg,rz_deg\n0,0,0,0,0,0,0\n1,10,3,%g,0,0,70\n2,10,3,30,0,0,70\n" % down)
path("along", (0, 0, 0, 0), (1, 20, 0, 0))
# A block that turns in place swings its edges as far as 5 mm times the root of 2: by 3.7 micrometers not as far as a wall, or farther.
for name, gap in ("passed", 0.0037), ("grazed", -0.0037):
    box(name, (50 ** 0.5 + gap, -20, -20), (20, 20, 20))
with open("swing.csv", "w") as file:
    file.write("t_s,x_mm,y_mm,z_mm,rx_deg,ry_deg,rz_deg\n0,0,0,0,0,0,10\n1,0,0,0,0,0,95\n")
# Solids, and what lies wholly inside of them.
box("solid", (-50, -50, -50), (50, 50, 50))
box("core", (-20, -20, -20), (20, 20, 20))
box("sheet", (-5, -5, -0.4), (5, 5, 0.4))
box("bead", (-3, -3, -3), (3, 3, 3))
scene("nested", outer=("solid", 0), inner=("core", 0))
scene("beads", bead=("bead", 0), other=("bead", 100))
path("inside", (0, 0, 0, 0), (1, 10, 0, 0))
path("moment", (0, 0, 0, 0))
path("through", (0, -100, 0, 0), (1, 100, 0, 0))
path("skin", (0, 0, 0, 49), (1, 10, 0, 49))
path("between", (0, 35, 0, 0), (1, 36, 0, 0))
path("down", (0, .3, .2, 18.1), (1, .3, .2, 7.4), (2, .3, .2, 18.1))
path("jog", (0, 0, 0, 20), (1, 0.008, 0, 40), (2, 0, 0, 80))  # off a line of 60 mm by more than 6 um
path("line", (0, 0, 0, 20), (1, 0.004, 0, 40), (2, 0, 0, 80))
path("side", (0, 0, 0, 30), (1, 0, 0, 12), (2, 15, 0, 12), (3, 15, 0, 30))
END
fine=(--voxel-size 1mm --quiet)
for name in room below corner nested beads; do "$bin/voxelize" $name.json "${fine[@]}" -o $name.vox || fail "bake $name"; done
"$bin/voxelize" solid.obj --units mm "${fine[@]}" -o solid.vox || fail "bake solid"
for name in part cube sheet core; do
  "$bin/pointshell" $name.obj --units mm "${fine[@]}" -o $name.pshell || fail "bake $name"
done

# An object that lies inside the part is no distance away, though no point of the shell is near it.
check 6 beads.vox core.pshell inside.csv --clearance 1mm --json bead.json
says '^Collides, straight along \+x: bead lies inside the part \(after 0 of 10 mm\)\.$'
says '^  0\.0 to 10\.0 mm along the path: bead lies inside the part, after 0\.0 mm, at '
errs '^voxcheck: inside\.csv: collides: bead lies inside the part \('
python3 -c 'import json; [v] = json.load(open("bead.json"))["violations"]; assert v["object_inside"] and v["object"] == "bead", v' ||
  fail "the report: $(cat bead.json)"
check 0 beads.vox core.pshell inside.csv --clearance 1mm --allow bead
says '^Keeps the clearance, .*: stays [0-9.]+ mm away or more \(nothing is nearer; 1 mm required\)\.$'

# Where the part leaves its seat, the files begin anew: it is still too near to the ceiling that it met before.
check 6 below.vox part.pshell rise.csv --clearance 1mm --seat 0,0,0m
says '^Does not come out, straight along \+z: goes into ceiling \(too near from [23](\.[0-9])? mm on, worst after [0-9.]+ of 50 mm\)\.$'
says '^  [23]\.[0-9] to [0-9.]+ mm along the path: is between 0 mm and [0-9.]+ mm away from ceiling, '

# A cropped side is reported as such, not as an object; an object that is allowed is not the nearest.
"$bin/voxelize" room.json "${fine[@]}" --roi -40mm,-40mm,-20mm,20mm,40mm,80mm -o cropped.vox || fail "bake cropped"
check 6 cropped.vox part.pshell side.csv --clearance 1mm
says '^Undecided, .*: comes within 0 mm of a cropped side of the scene; nothing is known beyond that side \(after 33 of 51 mm; 1 mm required\)\.$'
check 0 room.vox part.pshell jog.csv --clearance 1mm
says '^Keeps the clearance, along a path that turns and ends toward \+z: '
check 0 room.vox part.pshell over.csv --clearance 1mm
says '^Keeps the clearance, along a path that begins toward -z, turns and ends toward \+z: '
check 0 room.vox part.pshell line.csv --clearance 1mm
says '^Keeps the clearance, straight along \+z: '
check 0 room.vox part.pshell over.csv --clearance 1mm --allow floor --allow wall --json all.json
says '^Keeps the clearance, .*: stays [0-9.]+ mm away or more \(nothing is nearer; 1 mm required\)\.$'
python3 -c 'import json; assert json.load(open("all.json"))["min_clearance"]["at_least"]' || fail "all are allowed, and one is near"

# Where the system starts no more threads, fewer give the same answer.
if ! grep -q '^CMAKE_CXX_FLAGS:.*-fsanitize' "$FORCELAYER_BUILD_DIR/CMakeCache.txt"; then
  check 0 room.vox part.pshell over.csv --clearance 1mm --threads 1 --report csv:one.csv
  (ulimit -v 900000; "$bin/voxcheck" room.vox part.pshell over.csv --clearance 1mm --threads 256 --report csv:many.csv --quiet) ||
    fail "256 threads in 900 MB: status $?"
  cmp one.csv many.csv || fail "fewer threads, another answer"
fi

# In its seat too the curve is of all objects.
check 0 corner.vox cube.pshell clear.csv --clearance 0.8mm --seat 0,0,0m --felt-seat --report csv:curve.csv
[ "$(sed -n 2p curve.csv | cut -d, -f3)" = 0 ] || fail "it stands on the floor: $(head -n 3 curve.csv)"

if [ -x "$bin/voxcheck-exact" ]; then
  # Meshes of another bake have no verdict, be they nearer, farther, or other only where the part never comes.
  exact=(room.vox part.pshell over.csv --part-units mm)
  check 0 "${exact[@]}" --clearance 2mm --exact room.json --part part.obj
  check 6 "${exact[@]}" --clearance 5mm --exact room.json --part part.obj
  says '^Does not keep the clearance, .*: comes as near as 3 mm \(measured to floor, after [0-9.]+ of [0-9.]+ mm; 5 mm required\)\.$'
  for wrong in raised:floor sunk:floor aside:wall scaled:wall swapped:floor turned:wall cut:floor; do
    check 4 "${exact[@]}" --clearance 2mm --exact "${wrong%:*}.json" --part part.obj
    errs "room\.vox: --exact: was not baked from these meshes: '${wrong#*:}' has another shape, size or position; "
  done
  check 4 "${exact[@]}" --clearance 2mm --exact reordered.json --part part.obj
  errs "object 1 of the file is 'floor', not 'wall'"
  for wrong in deeper older cut_part; do
    check 4 "${exact[@]}" --clearance 2mm --exact room.json --part $wrong.obj
    errs 'part\.pshell: --exact: was not baked from these meshes: the part has another shape, size or position; '
  done
  "$bin/voxelize" dented_room.json "${fine[@]}" -o dented.vox || fail "bake dented"
  dented=(dented.vox part.pshell over.csv --part-units mm --clearance 2mm --part part.obj)
  check 0 "${dented[@]}" --exact dented_room.json
  check 4 "${dented[@]}" --exact deepened_room.json
  errs "dented\.vox: --exact: was not baked from these meshes: 'floor' has another shape, size or position; "
  check 4 room.vox part.pshell over.csv --clearance 5mm --exact room.json --part part.obj --part-units in
  errs 'give the same inputs, --without and units as for the bake, or bake again$'

  # However large the voxels, a path that passes by a few micrometers passes.
  "$bin/pointshell" part.obj --units mm --voxel-size 5mm --quiet -o large.pshell
  for name in passed grazed; do
    "$bin/voxelize" $name.obj --units mm --voxel-size 5mm --quiet -o $name.vox
    swing=($name.vox large.pshell swing.csv --clearance 0mm --exact $name.obj --part part.obj --units mm --json $name.json)
    if [ $name = passed ]; then
      check 0 "${swing[@]}"
      says '^Passes without a collision, turning in place: stays 0\.00[34][0-9]* mm away or more \(measured to passed, '
    else
      check 6 "${swing[@]}"
      says '^Collides, turning in place: meets grazed[, (]'
    fi
  done
  python3 - <<'END' || fail "3.7 micrometers: $(cat passed.json grazed.json)"
import json
exact = json.load(open("passed.json"))["min_clearance"]["exact_m"]
assert 3.7e-6 - 1e-8 < exact < 3.9e-6, exact  # the least distance is found to 0.1 micrometers
[v] = json.load(open("grazed.json"))["violations"]
assert v["exact_m"] == 0 and not v["graze"] and v.get("depth_m", 0) < 3.7e-6 + 1e-8, v
END

  # Voxel centers are up to half a voxel diagonal off the surface: what the exact clearance is at most counts it.
  "$bin/voxelize" floor.obj --units mm --voxel-size 2mm --quiet -o under.vox
  "$bin/pointshell" tip.obj --units mm --voxel-size 2mm --method voxel-centers --quiet -o centers.pshell
  check 6 under.vox centers.pshell down.csv --clearance 20mm --json centers.json
  python3 -c 'import json; v = json.load(open("centers.json"))["min_clearance"]; assert v["clearance_m"] <= 0.0093 <= v["at_most_m"] < 0.0115, v' ||
    fail "the tip is 9.3 mm up: $(cat centers.json)"
  check 0 under.vox centers.pshell down.csv --clearance 1mm --exact floor.obj --part tip.obj --units mm
  says '^Keeps the clearance, .* stays 9\.3 mm away or more \(measured to floor, '

  # A part that is all inside of a solid is far from its surface, and not clear.
  solid=(--clearance 1mm --exact solid.obj --part part.obj --units mm)
  for path in inside moment; do
    check 6 solid.vox part.pshell $path.csv "${solid[@]}" --json $path.json
    says '^Collides.*: all of the part is inside of solid, at least (4[0-9](\.[0-9]+)?|50) mm deep \('
    errs "^voxcheck: $path.csv: collides: all of the part is inside of solid, at least (4|50)"
  done
  check 6 solid.vox part.pshell through.csv "${solid[@]}" --json through.json
  "$bin/pointshell" sheet.obj --units mm "${fine[@]}" -o sheet.pshell
  check 6 solid.vox sheet.pshell skin.csv --clearance 0.3mm --exact solid.obj --part sheet.obj --units mm
  says '^Collides.*: all of the part is inside of solid, at least 1\.[34]'
  # Nor where another object may be met anywhere; only there it is.
  nested=(nested.vox part.pshell --clearance 1mm --exact nested.json --part part.obj --part-units mm)
  check 6 "${nested[@]}" inside.csv --allow outer
  says '^Collides.*: all of the part is inside of inner'
  check 0 "${nested[@]}" between.csv --allow outer
  says '^Keeps the clearance, .* stays 10 mm away or more \(measured to inner, '
  check 6 "${nested[@]}" between.csv --allow inner
  says '^Collides.*: all of the part is inside of outer'
  # The same box as a room that is full of air.
  "$bin/voxelize" solid.obj --units mm "${fine[@]}" --free-seed 0,0,0m -o hollow.vox || fail "bake hollow"
  check 0 hollow.vox part.pshell inside.csv "${solid[@]}"
  says '^Keeps the clearance, .* stays 35 mm away or more \(measured to solid, '
  python3 - <<'END' || fail "the reports: $(cat inside.json through.json)"
import json
[v] = json.load(open("inside.json"))["violations"]
assert v["inside"] and v["exact_m"] == 0 and 0.045 <= v["depth_m"] <= v["max_depth_m"] < 0.056, v
[v] = json.load(open("through.json"))["violations"]  # 1 mm before the one side to 1 mm behind the other
assert v["inside"] and abs(v["from_s"] - 0.22) < 1e-3 and abs(v["to_s"] - 0.78) < 1e-3, v
END

  # A wall that is as far away as required, where the part is installed, is not of its seat: whatever the voxels.
  for size in 1 2 4; do
    "$bin/voxelize" corner.json --voxel-size ${size}mm --quiet -o corner$size.vox
    "$bin/pointshell" cube.obj --units mm --voxel-size ${size}mm --quiet -o cube$size.pshell
    seat=(--seat 0,0,0m --exact corner.json --part cube.obj --part-units mm --json corner$size.json)
    check 6 corner$size.vox cube$size.pshell into.csv "${seat[@]}" --clearance 0.8mm
    says '^Does not come out, .*: gets [0-9.]+ mm away from its seat after [0-9.]+ mm, but meets Wall, at least 0\.(2|19[0-9]*|20[0-9]*) mm deep \(contact from 3\.7 mm on, worst after [0-9.]+ of [0-9.]+ mm\)\.$'
    python3 - $size <<'END' || fail "contact from: $(cat corner$size.json)"
import json, math, sys
[violation] = json.load(open(f"corner{sys.argv[1]}.json"))["violations"]
assert abs(violation["contact_from_m"] - 2.5e-3 / 2.7 * math.hypot(2.7, 3)) < 2e-5, violation
END
    check 6 corner$size.vox cube$size.pshell close.csv "${seat[@]}" --clearance 0.8mm
    says '^Does not keep the clearance, .*: gets [0-9.]+ mm away from its seat after [0-9.]+ mm, but comes as near as 0\.05 mm \(measured to Wall, after '
    check 0 corner$size.vox cube$size.pshell clear.csv "${seat[@]}" --clearance 0.8mm
    # One that is nearer is.
    check 0 corner$size.vox cube$size.pshell clear.csv "${seat[@]}" --clearance 2.6mm
    says '^Comes out, .*: leaves Floor within the first 2\.7 mm and passes Wall with a gap of 1\.5 mm for the first '
    ! grep -q 'the path ends' out.txt || fail "it ends above the wall: $(cat out.txt)"
    # Beside the wall it is not outside yet.
    path beside "0 0 0 0" "1 0 0 25"
    meshes=(--seat 0,0,0m --exact corner.json --part cube.obj --part-units mm)
    check 0 corner$size.vox cube$size.pshell beside.csv "${meshes[@]}" --clearance 0.8mm
    says '^Leaves its seat, straight along .*; the path ends within the box around the other objects, and the way on from there was not checked\.$'
    path lifted "0 0 0 0" "1 0 0 0.5"
    check 0 corner$size.vox cube$size.pshell lifted.csv "${meshes[@]}" --clearance 0.8mm
    says '^Is still in its seat, straight along \+z: slides along Floor for the whole path of 0\.5 mm, '
    says '^  the path ends in the seat: whether the part comes out was not checked$'
    python3 - $size <<'END' || fail "the seat: $(cat corner$size.json)"
import json, sys
floor, wall = json.load(open(f"corner{sys.argv[1]}.json"))["seat_depths"]
assert floor["gap_m"] == 0 and abs(wall["gap_m"] - 0.0025) < 1e-8 and wall["installed_m"] == 0, (floor, wall)
END
  done
  # And it is out at the same place of its path.
  python3 - <<'END' || fail "out at: $(cat corner[124].json)"
import json
reports = [json.load(open(f"corner{size}.json")) for size in (1, 2, 4)]
out_m = [report["seated"][0]["to_m"] for report in reports]
assert max(out_m) - min(out_m) < 5e-5, out_m
assert all(2.6e-3 <= report["min_clearance"]["exact_m"] < 2.65e-3 for report in reports)
END
  # A press fit, deeper than a part may be pushed in: so deep it is installed, and it may come out.
  check 7 corner1.vox cube1.pshell pressed.csv --clearance 0.8mm --seat 0,0,-0.4mm --exact corner.json \
    --part cube.obj --part-units mm --json pressed.json --report junit:pressed.xml --report gitlab:pressed.quality --report github
  for report in pressed.xml pressed.quality out.txt; do
    grep -qF 'where the part is installed, it overlaps Floor by at least 0.4 mm' $report || fail "$report does not say so: $(cat $report)"
  done
  says '^  where the part is installed, it overlaps Floor by at least 0\.4 mm; the force that this takes is not computed$'
  says '^Comes out, .*, if force overcomes its overlap with Floor \(at least 0\.4 mm when installed\): '
  grep -q 'failures="1"' pressed.xml && grep -q '"severity": "major"' pressed.quality && grep -q '^::error ' out.txt && grep -q '"exit_status": 7' pressed.json ||
    fail "a yes that needs force: $(cat pressed.xml pressed.quality out.txt)"
  says '^  in its seat, the part never goes deeper than installed$'
  python3 - <<'END' || fail "the press fit: $(cat pressed.json)"
import json
[floor] = json.load(open("pressed.json"))["seat_depths"]
assert abs(floor["installed_m"] - 0.0004) < 1e-6 and floor["deepest_m"] <= floor["installed_m"] + 1e-6, floor
END
  # A part in a closed cavity, which voxels fill: deep in there they name no object.
  "$bin/voxelize" chamber.json --voxel-size 0.5mm --quiet -o chamber.vox
  "$bin/pointshell" part.obj --units mm --voxel-size 0.5mm --quiet -o inner.pshell
  check 0 chamber.vox inner.pshell still.csv --clearance 1mm --seat 0,0,0m --exact chamber.json --part part.obj --part-units mm
  says '^Is still in its seat: .* stays 35 mm away or more \(measured to chamber, after 0 of 0 mm; 1 mm required\)\.$'
  check 0 chamber.vox inner.pshell still.csv --clearance 1mm --exact chamber.json --part part.obj --part-units mm
  says '^Keeps the clearance: stays 35 mm away or more \(measured to chamber, after 0 of 0 mm; 1 mm required\); the path does not move the part\.$'
  # The triangles of another object may lie anywhere: the overlap is certain. Those of the floor hide it.
  for deviates in Wall Floor; do
    python3 - $deviates <<'END'
import json, sys
scene = json.load(open("corner.json"))
for part in scene["parts"]:
    if part["name"] == sys.argv[1]: part["mesh_deviation"] = "0.5mm"
json.dump(scene, open("deviates.json", "w"))
END
    "$bin/voxelize" deviates.json --voxel-size 1mm --quiet -o deviates.vox
    [ $deviates = Wall ] && status=7 || status=0
    check $status deviates.vox cube1.pshell pressed.csv --clearance 0.8mm --seat 0,0,-0.4mm --exact deviates.json --part cube.obj --part-units mm
    [ $deviates = Floor ] ||
      says '^Comes out, .*, if force overcomes its overlap with Floor \(at least 0\.4 mm when installed\): '
    [ $deviates = Wall ] ||
      says '^Comes out, straight along .*; an installed overlap with Floor of up to 0\.90[01]* mm is not ruled out, because triangles stand for curved surfaces\.$'
  done
  # By the meshes nothing is too near where it is installed, whatever the voxels: there is no seat to leave.
  for size in 1 4; do
    check 0 corner$size.vox cube$size.pshell high.csv --clearance 0.8mm --seat 0,0,1mm --exact corner.json --part cube.obj --part-units mm
    says '^Comes out, straight along \+z: stays 1 mm away or more \(measured to Floor, after 0 of 44 mm; 0\.8 mm required\)\.$'
  done
  # An object that does not count hides another one from the files, which is reported, and not from the meshes.
  "$bin/voxelize" ribbed.json --voxel-size 4mm --quiet -o ribbed.vox
  check 0 ribbed.vox cube4.pshell along.csv --clearance 1mm --allow Floor
  says '^  not checked: hidden objects less than 12 mm behind an object of the seat or of --allow; the meshes show them$'
  meshes=(--exact ribbed.json --part cube.obj --part-units mm)
  for rule in "--seat 0,0,0m --felt-seat" "--allow Floor"; do
    check 6 ribbed.vox cube4.pshell along.csv --clearance 1mm $rule "${meshes[@]}"
    says '^Does not keep the clearance, straight along \+x: .*comes as near as 0\.2 mm \(measured to Rib, after '
    says '^  1[4-6]\.[0-9] to 20\.0 mm along the path: comes within 0\.2 mm of Rib'
  done

  # In its seat a part does not go into metal, be it as little as the files tell: whatever the voxels. 0.5 mm before a wall, it is
  # pressed 1 mm into it. Sheets of 0.9 mm pass through each other, at most 0.45 mm deep. A block slides on the floor, turning.
  for size in 1 5; do
    bake=(--units mm --voxel-size ${size}mm --quiet)
    for name in thick tab stand; do "$bin/voxelize" $name.obj "${bake[@]}" -o $name.vox; done
    for name in block clip cube; do "$bin/pointshell" $name.obj "${bake[@]}" -o $name.pshell; done
    press=(thick.vox block.pshell press.csv --clearance 2mm --seat 0,0,0m --exact thick.obj --part block.obj --units mm)
    check 6 "${press[@]}" --json press.json
    says '^Does not come out, .*: goes (1|0\.999[0-9]*) mm deep into thick, which the installed part does not overlap \(too deep from 0\.5 mm on, worst after 1\.5 of 63 mm\)\.$'
    says '^  in its seat, the part goes at least (1|0\.999[0-9]*) mm deeper into thick than installed; no extra depth is allowed beyond rounding$'
    python3 -c 'import json; [v] = json.load(open("press.json"))["violations"]; assert abs(v["from_s"] - 1 / 3) < 0.1 and not v["graze"], v' ||
      fail "it meets the wall at a third of a second: $(cat press.json)"
    check 6 "${press[@]}" --seat-depth 0.99999mm
    check 0 "${press[@]}" --seat-depth 1mm
    check 6 tab.vox clip.pshell sideways.csv --clearance 2mm --seat 0,0,0m --exact tab.obj --part clip.obj --units mm
    says '^Does not come out, .* goes 0\.4[45][0-9]* mm deep into tab'
    check 0 tab.vox clip.pshell upwards.csv --clearance 2mm --seat 0,0,0m --exact tab.obj --part clip.obj --units mm
    slide=(stand.vox cube.pshell --clearance 0.3mm --seat 0,0,0m --exact stand.obj --part cube.obj --units mm)
    check 0 "${slide[@]}" slide.csv
    check 6 "${slide[@]}" sink.csv
    says '^Does not come out, .* goes 0\.001[0-9]* mm deep into stand'
  done

  # A box with a triangle missing, as part and as object: the closed one of both settles the seat; where neither is closed, the
  # answer says where they are open.
  for name in part floor; do
    grep -v '^f' $name.obj >open_$name.obj
    sed -n 's/^f \([-0-9]*\) \([-0-9]*\) \([-0-9]*\) \([-0-9]*\)$/f \1 \2 \3\nf \1 \3 \4/p' $name.obj | sed 1d >>open_$name.obj
  done
  path up "0 0 0 5" "1 0 0 45"
  path sunk "0 0 0 5" "1 0 0 2" "2 0 0 45"
  for name in open_floor floor; do "$bin/voxelize" $name.obj --units mm "${fine[@]}" -o $name.vox; done
  "$bin/pointshell" open_part.obj --units mm "${fine[@]}" -o open_part.pshell
  for pair in floor:open_part open_floor:part; do
    seat=(--clearance 1mm --seat 0,0,5mm --exact ${pair%:*}.obj --part ${pair#*:}.obj --units mm)
    check 0 ${pair%:*}.vox ${pair#*:}.pshell up.csv "${seat[@]}"
    says '^Comes out, straight along \+z: leaves (open_)?floor within the first 1 mm, '
    check 6 ${pair%:*}.vox ${pair#*:}.pshell sunk.csv "${seat[@]}"
    says '^Does not come out, .* goes (3|2\.999[0-9]*) mm deep into (open_)?floor, which the installed part does not overlap'
  done
  check 6 open_floor.vox open_part.pshell up.csv --clearance 1mm --seat 0,0,5mm --exact open_floor.obj --part open_part.obj --units mm
  says '^Undecided, .* but while the part touches open_floor, overlap cannot be measured, because both meshes are open: the part has 34\.14[0-9]* mm of open edges, at x 0\.00, y 0\.00, z 0\.00 mm, and open_floor has 341\.4[0-9]* mm of open edges, at x 0\.00, y 0\.00, z -10\.00 mm \(1 mm of clearance required\)\.$'
  errs '; close all open edges of one of the two meshes and bake again, or accept the seat with --felt-seat$'
fi
finish
