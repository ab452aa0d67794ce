#!/usr/bin/env bash
# --rules of voxcheck and study: each object keeps the distance of the first row that names it and the part.
source "$FORCELAYER_SOURCE_DIR/tests/support/command_test.sh"
[ -x "$bin/voxcheck-exact" ] || { echo "no meshes in this build"; exit 0; }
cp "$data/gearbox.glb" .
"$bin/voxelize" gearbox.glb --without Lid --voxel-size 1mm -o opened.vox --quiet
"$bin/pointshell" gearbox.glb#Cover --voxel-size 1mm -o cover.pshell --quiet
# The cover goes sideways 3 mm above the housing, through the pin.
printf 't_s,x_m,y_m,z_m\n0,0,0,0.06\n1,0,0,0.003\n2,0.01,0,0.003\n3,0.01,0,0.06\n' >sideways.csv
exact=(--exact gearbox.glb --without Lid --part gearbox.glb#Cover)

# check STATUS ARGUMENTS...
check() {
  local wanted=$1 status=0
  shift
  "$bin/voxcheck" opened.vox cover.pshell sideways.csv "$@" >out.txt 2>err.txt || status=$?
  [ "$status" = "$wanted" ] || fail "status $status, not $wanted: $*: $(cat out.txt err.txt)"
}
rules() { printf 'part,object,clearance\n' >rules.csv && printf '%s\n' "$@" >>rules.csv; }
# same FIRST SECOND: both reports have the same answer.
same() {
  python3 - "$@" <<'PYTHON' || fail "$1 and $2 differ"
import json, sys
first, second = (json.load(open(name)) for name in sys.argv[1:])
keys = ["verdict", "kind", "required_clearance_m", "min_clearance", "violations", "seat", "seated", "exact"]
assert all(first[key] == second[key] for key in keys), [(first[k], second[k]) for k in keys if first[k] != second[k]]
PYTHON
}

# One distance, and others ignored: as --clearance and --allow.
rules 'Cover,Clip/*,ignore' 'Pin,Cover,ignore' 'Cover,Housing,3.2mm'
check 6 "${exact[@]}" --clearance 1mm --rules rules.csv --json by_rules.json
check 6 "${exact[@]}" --clearance 3.2mm --allow 'Clip/*' --allow Pin --json plain.json
same by_rules.json plain.json
rules '"{Pin,Clip/*}",*,ignore' '*,*,2.8mm' 'Cover,Housing,3.2mm'  # the last row comes too late
check 0 "${exact[@]}" --rules rules.csv --json by_rules.json
grep -q "warning: rules.csv: line 4: the row decides about no pair" err.txt || fail "no warning: $(cat err.txt)"
check 0 "${exact[@]}" --clearance 2.8mm --allow 'Clip/*' --allow Pin --json plain.json
same by_rules.json plain.json
# All that no row names keeps --clearance: then the rules change nothing.
rules 'Pin,Housing,5mm'
check 6 "${exact[@]}" --clearance 2.8mm --rules rules.csv --json by_rules.json
check 6 "${exact[@]}" --clearance 2.8mm --json plain.json
same by_rules.json plain.json

# Several distances: the answer is yes where each object's own is. The answers about single objects are those of --allow.
cat >objects.txt <<'END'
Gearbox/Housing
Gearbox/Pin
Gearbox/Clip/Half[1]
Gearbox/Clip/Half[2]
END
python3 - "$bin/voxcheck" "${exact[@]}" <<'PYTHON' || fail "several distances"
import json, random, subprocess, sys
objects = open("objects.txt").read().split()
def check(*arguments):
    command = [sys.argv[1], "opened.vox", "cover.pshell", "sideways.csv", *sys.argv[2:], *arguments, "--quiet", "--json", "r.json"]
    status = subprocess.run(command, capture_output=True).returncode
    assert status in (0, 6), (status, command)
    return json.load(open("r.json"))
alone = {}
for object in objects:
    for clearance in ("0mm", "2.8mm", "3.2mm"):
        others = [word for other in objects if other != object for word in ("--allow", other)]
        alone[object, clearance] = check("--clearance", clearance, *others)
assert len({report["kind"] for report in alone.values()}) >= 3
chance = random.Random(7)
answers = set()
for seed in range(8):
    asked = {object: chance.choice(["ignore", "0mm", "2.8mm", "3.2mm"]) for object in objects}
    if seed % 2: asked["Gearbox/Pin"] = "ignore"  # which blocks the path
    rows = [f"Cover,{object},{clearance}" for object, clearance in asked.items()]
    chance.shuffle(rows)
    open("rules.csv", "w").write("part,object,clearance\n" + "\n".join(rows) + "\n")
    report = check("--rules", "rules.csv", "--clearance", "9mm")
    counted = {object: clearance for object, clearance in asked.items() if clearance != "ignore"}
    expected = all(alone[item]["verdict"] == "clear" for item in counted.items())
    assert (report["verdict"] == "clear") == expected, (seed, asked, report["sentence"])
    answers.add(expected)
    # Each object is in one entry, with its distance; those that are ignored are in one without.
    listed = {name: rule["required_clearance_m"] for rule in report["rules"] for name in rule["objects"]}
    lengths = {"ignore": None, "0mm": 0, "2.8mm": 0.0028, "3.2mm": 0.0032}
    assert listed == {object: lengths[clearance] for object, clearance in asked.items()}, (listed, asked)
    for rule in report["rules"]:
        if rule["required_clearance_m"] is None: continue
        own = all(alone[object, counted[object]]["verdict"] == "clear" for object in rule["objects"])
        assert (rule["verdict"] == "clear") == own, (seed, rule)
assert answers == {True, False}
PYTHON

# Rules that cannot be used.
check 2 --rules rules.csv
grep -q '^voxcheck: --rules: needs the meshes; add --exact SCENE_MESHES --part PART_MESHES$' err.txt || fail "$(cat err.txt)"
check 1 "${exact[@]}" --rules none.csv
rules 'Cover,Half,1mm'
check 2 "${exact[@]}" --rules rules.csv
grep -q "^voxcheck: rules.csv: line 2: several siblings have the name 'Half'" err.txt || fail "$(cat err.txt)"
rules 'Cover,Nobody,1mm'
check 6 "${exact[@]}" --rules rules.csv
grep -q "warning: rules.csv: line 2: no part has the name 'Nobody'" err.txt || fail "$(cat err.txt)"

# A study: the clearance alone is too much beside the housing, and a rule allows less there.
study() {  # STATUS ARGUMENTS...
  local wanted=$1 status=0
  shift
  "$bin/forcelayer" study gearbox.glb#Cover --without Lid --voxel-size 1mm --no-pictures "$@" >out.txt 2>err.txt || status=$?
  [ "$status" = "$wanted" ] || fail "status $status, not $wanted: study $*: $(cat out.txt err.txt)"
}
printf 't_s,x_m,y_m,z_m\n0,0,0,0.06\n1,0,0,0.003\n2,0,0,0.06\n' >down.csv
study 6 --path down.csv --seat none --clearance 3.2mm -o strict
rules '"{Pin,Clip/*}",Cover,ignore' 'Cover,Housing,2mm'
study 0 --path down.csv --seat none --clearance 3.2mm --rules rules.csv -o ruled
grep -q '>by the rules<' ruled/report.html || fail "the page has no rules"
grep -q -- '--rules rules.csv' out.txt || fail "voxcheck had no rules: $(cat out.txt)"
# A search keeps the largest distance, and ignores what is ignored.
if [ -x "$bin/voxplan" ]; then
  study 0 --clearance 0.5mm --rules rules.csv -o searched
  grep -q -- '^\$ voxplan .* --clearance 0.002.*m .*--allow Gearbox/Pin' out.txt || fail "the search has no rules: $(cat out.txt)"
fi
study 2 --files-alone --rules rules.csv -o none
[ ! -e none ] || fail "something was baked for rules without meshes"
finish
