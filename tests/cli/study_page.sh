#!/usr/bin/env bash
# The 3D view of a study's page, in headless Chromium: the worst moment is that of the verdict, objects hide by name, positions
# are those of the curve, and without WebGL the rest of the page stays. The page refers to nothing elsewhere.
source "$FORCELAYER_SOURCE_DIR/tests/support/command_test.sh"
cp "$data/gearbox.glb" .
study() {  # PART FOLDER
  "$bin/forcelayer" study "gearbox.glb#$1" --voxel-size 1mm --pull 0,0,60mm --clearance 1mm --no-pictures -o "$2" --quiet 2>err.txt
  [ -s "$2/report.html" ] || fail "no page: $(cat err.txt)"
}
study Pin pin
study Cover cover
if grep -q 'built without three.js' pin/report.html; then skip "needs libjs-three of scripts/packages.txt"; fi
"$bin/forcelayer" study 'gearbox.glb#Pin' --voxel-size 1mm --pull 0,0,60mm --files-alone --no-pictures -o files --quiet 2>err.txt
grep -q 'no 3D view, because the study reads no meshes' files/report.html || fail "a study without meshes: $(cat err.txt)"
[ "$(stat -c %s pin/report.html)" -lt 5000000 ] || fail "the page is too large"
grep -qE '(src|href)="?https?:|url\(|@import' pin/report.html && fail "the page refers to something elsewhere"
for file in three.min.js examples/js/controls/OrbitControls.js examples/js/loaders/GLTFLoader.js; do
  python3 -c 'import sys; sys.exit(open(sys.argv[2]).read() not in open(sys.argv[1]).read())' pin/report.html \
    "/usr/share/javascript/three/$file" || fail "$file is not in the page as it is"
done
grep -q 'Permission is hereby granted, free of charge' pin/report.html || fail "no license of three.js"

chromium=$(command -v chromium || command -v chromium-browser || command -v google-chrome || true)
if [ -z "$chromium" ]; then
  [ $failures = 0 ] || finish
  skip "the page was opened in no browser: chromium is not installed (optional)"
fi
# page FRAGMENT OPTIONS...: the elements of the page after its scripts have run, in page.html.
page() {
  local address=$1
  shift
  timeout 120 "$chromium" --headless=new --no-sandbox --disable-dev-shm-usage --user-data-dir="$work/profile" "$@" \
    --virtual-time-budget=20000 --dump-dom "file://$work/$address" >page.html 2>err.txt || fail "chromium: $(tail -3 err.txt)"
}
gl=(--use-gl=angle --use-angle=swiftshader --enable-unsafe-swiftshader)
now() { sed -nE 's/.*<output id="now">([^<]*)<.*/\1/p' page.html; }

for part in pin cover; do
  page "$part/report.html#worst" "${gl[@]}"
  said=$(now) python3 - $part <<'END' || fail "the worst moment of $part: '$(now)'"
import json, os, sys
verdict, said = json.load(open(sys.argv[1] + "/verdict.json")), os.environ["said"]
worst = verdict["told_moment"]
for violation in verdict["violations"]:
    if (violation["t_s"], violation["object"]) == (worst["t_s"], worst["object"]):
        worst = violation
assert said.startswith(f"after {1e3 * worst['along_path_m']:.1f} of {1e3 * verdict['path_m']:.1f} mm: {worst['object']}, "), said
deep = worst.get("depth_m")
value_m = worst["exact_m"] if deep is None else deep
assert abs(float(said.split(", ")[-1].split(" mm ")[0]) - 1e3 * value_m) <= 1e-3, said
END
done

# A reader moves the slider between two moments, hides an object, and presses a button: the clearance that the curve proves
# there, a gray name, and the moment of the verdict.
cat >reader.html <<'END'
<script>
setTimeout(() => {
  const get = (id) => document.getElementById(id), said = [];
  get('along').value = 58 / 60;
  get('along').dispatchEvent(new Event('input'));
  said.push(get('now').textContent);
  [...document.querySelectorAll('#objects label')].find((label) => label.title === 'Gearbox/Housing').firstChild.click();
  said.push([...document.querySelectorAll('#objects .hidden')].map((label) => label.textContent).join());
  document.querySelector('#moments button').click();
  said.push(get('now').textContent);
  document.body.dataset.said = said.join('|');
}, 5000);
</script>
END
cat pin/report.html reader.html >read.html
page read.html "${gl[@]}"
read_by=$(sed -nE 's/.* data-said="([^"]*)".*/\1/p' page.html)
page "pin/report.html#at=58&hide=Gearbox/Housing" "${gl[@]}"
linked="$(now)|$(sed -nE 's/.*<label title="([^"]*)" class="hidden">.*/\1/p' page.html)"
read_by=$read_by linked=$linked python3 - <<'END' || fail "a reader saw '$read_by', and through a link '$linked'"
import csv, json, os, re
after, hidden, worst = os.environ["read_by"].split("|")
assert os.environ["linked"] == after + "|" + hidden and hidden == "Gearbox/Housing"
[row] = [row for row in csv.DictReader(open("pin/curve.csv")) if float(row["from_m"]) < 0.058 < float(row["to_m"])]
[value] = re.fullmatch(r"after 58\.0 of 60\.0 mm: at least ([0-9.]+) mm \(proven\)", after).groups()
assert 0 <= 1e3 * float(row["clearance_m"]) - float(value) <= 1e-3, (row, value)
least = json.load(open("pin/verdict.json"))["told_moment"]
assert worst.startswith(f"after {1e3 * least['along_path_m']:.1f} of 60.0 mm: {least['object']}, "), worst
END
grep -q '<g id="here">' page.html || fail "no mark on the curve"

# A section: through the marked point of the worst moment, where a link or the slider says, and none for other words.
cut_at() { sed -nE 's/.*<output id="cut-at">([^<]*)<.*/\1/p' page.html; }
page 'pin/report.html#worst&section=x' "${gl[@]}"
at=$(cut_at) python3 - <<'END' || fail "the section at the worst moment: '$(cut_at)'"
import json, os
worst = json.load(open("pin/verdict.json"))["told_moment"]
assert os.environ["at"] == f"x = {1e3 * worst['point_m'][0]:.2f} mm", worst
END
page 'pin/report.html#section=y:34.5' "${gl[@]}"
[ "$(cut_at)" = 'y = 34.50 mm' ] || fail "a section by a link: '$(cut_at)'"
page 'pin/report.html#section=q:3' "${gl[@]}"
[ -n "$(now)" ] && [ -z "$(cut_at)" ] || fail "no section: '$(cut_at)'"
cat >cutter.html <<'END'
<script>
setTimeout(() => {
  const get = (id) => document.getElementById(id);
  get('section').value = 'z';
  get('section').dispatchEvent(new Event('change'));
  get('cut').value = 0;
  get('cut').dispatchEvent(new Event('input'));
}, 5000);
</script>
END
cat pin/report.html cutter.html >cut.html
page cut.html "${gl[@]}"
[ "$(cut_at)" = 'z = 0.00 mm' ] || fail "a section by the slider: '$(cut_at)'"

# The clearance map: chosen by a link, with its legend. A page without it has no choice.
legend() { sed -nE 's/.*<p id="legend">.*<span>([^<]*)<\/span>.*/\1/p' page.html; }
[ -z "$(legend)" ] || fail "a legend that nobody asked for: $(legend)"
page 'pin/report.html#worst&map' "${gl[@]}"
legend | grep -q '^4 mm\. Gray: more, or ignored\.' || fail "the legend of the map: '$(legend)'"
grep -q '<label id="map-choice">' page.html || fail "no choice of colors"

# A scene that is too large for a page: the farthest object is left out by name, and the view still opens.
python3 - <<'END'
def obj(name, vertices, faces):
    with open(name, "w") as file:
        file.writelines("v %g %g %g\n" % v for v in vertices)
        file.writelines("f %d %d %d\n" % tuple(i + 1 for i in f) for f in faces)
def sheet(name, n, x, z):  # n by n squares of 200 mm together
    at = lambda i, j: i * (n + 1) + j
    obj(name, [(x + 200 * i / n, 200 * j / n, z + (i * j) % 2) for i in range(n + 1) for j in range(n + 1)],
        [f for i in range(n) for j in range(n)
         for f in ((at(i, j), at(i + 1, j), at(i + 1, j + 1)), (at(i, j), at(i + 1, j + 1), at(i, j + 1)))])
box = [(x, y, z) for x in (80, 120) for y in (80, 120) for z in (20, 40)]
obj("box.obj", box, [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)])
sheet("near.obj", 10, 0, 0)
sheet("far.obj", 300, 400, 0)
parts = [{"name": name, "mesh": name + ".obj", "units": "mm"} for name in ("box", "near", "far")]
__import__("json").dump({"parts": parts}, open("large.json", "w"))
END
"$bin/forcelayer" study large.json#box --voxel-size 5mm --pull 0,0,100mm --clearance 1mm --no-pictures -o large --quiet 2>err.txt ||
  fail "the large scene: $(cat err.txt)"
grep -q 'leaves out the objects farthest from the path: far\.' large/report.html || fail "nothing is left out"
[ "$(stat -c %s large/report.html)" -lt 5000000 ] || fail "the large page is too large"
page large/report.html#worst "${gl[@]}"
grep -q '<label id="map-choice" hidden' page.html || fail "a map in the large view"
grep -q '>near</span></label>' page.html && ! grep -q '>far</span></label>' page.html && [ -n "$(now)" ] || fail "the large view: $(now)"

"$bin/forcelayer" study large.json#far --voxel-size 5mm --pull 0,0,100mm --clearance 1mm --no-pictures -o huge --quiet 2>err.txt
grep -q 'no 3D view, because the part has too many triangles' huge/report.html || fail "a huge part: $(cat err.txt)"

# Without WebGL the verdict stays, and a sentence stands in place of the view.
page pin/report.html --disable-gpu --disable-3d-apis
grep -q '<p id="no-view">The 3D view needs' page.html && grep -q '<div id="view" hidden' page.html &&
  grep -q 'Comes out, straight along +z' page.html || fail "without WebGL: $(grep -c . page.html) lines"
finish
