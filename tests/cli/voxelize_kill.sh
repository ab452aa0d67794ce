#!/usr/bin/env bash
# Bakes killed at any moment: the output is the old file or the new one, and the cache still serves.
set -u
bin=$FORCELAYER_BIN_DIR
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1

cat >kill.py <<'PYTHON'
import glob, hashlib, json, math, os, random, signal, subprocess, sys, time

voxelize = os.path.join(sys.argv[1], "voxelize")
kills = int(sys.argv[2])
seed = int(os.environ.get("FORCELAYER_TEST_SEED", "1"))
dice = random.Random(seed)

def sphere(name, radius, rings):
    with open(name, "w") as f:
        for i in range(rings + 1):
            for j in range(2 * rings):
                a, b = math.pi * i / rings, math.pi * j / rings
                f.write("v %g %g %g\n" % (radius * math.sin(a) * math.cos(b),
                                          radius * math.sin(a) * math.sin(b), radius * math.cos(a)))
        for i in range(rings):
            for j in range(2 * rings):
                k, l = i * 2 * rings, (j + 1) % (2 * rings)
                f.write("f %d %d %d %d\n" % (k + j + 1, k + 2 * rings + j + 1,
                                             k + 2 * rings + l + 1, k + l + 1))

def scene(moved):
    parts = [{"mesh": "s%d.obj" % (i % 3), "units": "mm",
              "translation": ["%dmm" % (70 * i), "%dmm" % (moved if i == 2 else 0), 0]}
             for i in range(6)]
    json.dump({"voxel_size": "1mm", "parts": parts}, open("scene.json", "w"))

def digest(path):
    return hashlib.sha256(open(path, "rb").read()).hexdigest() if os.path.exists(path) else None

def bake(output, *more):
    return subprocess.Popen([voxelize, "scene.json", "-o", output, "--quiet", *more])

for i in range(3):
    sphere("s%d.obj" % i, 25 + 3 * i, 40)
good = []
for moved in (0, 11):
    scene(moved)
    start = time.monotonic()
    assert bake("good.vox").wait() == 0
    length_s = time.monotonic() - start
    good.append(digest("good.vox"))
assert good[0] != good[1]

killed = finished = 0
old = None
for n in range(kills):
    scene(11 * (n % 2))
    if n % 10 == 9:  # from an empty cache
        subprocess.run(["rm", "-rf", "cache"])
    process = bake("scene.vox", "--cache", "cache")
    time.sleep(dice.uniform(0, 2 * length_s))  # with the cache it takes longer
    process.send_signal(signal.SIGKILL)
    status = process.wait()
    killed += status == -9
    finished += status == 0
    assert status in (0, -9), status
    now = digest("scene.vox")
    assert now in (old, good[n % 2]), "neither the old file nor the new one after kill %d" % n
    if status == 0:
        assert now == good[n % 2], "a finished bake left the old file"
    old = now
    if n % 10 == 5:  # the cache serves whatever was killed
        assert bake("check.vox", "--cache", "cache").wait() == 0
        assert digest("check.vox") == good[n % 2], "other bytes from the cache after kill %d" % n
assert killed > kills // 10, "hardly any bake was killed: %d of %d" % (killed, kills)

# Ctrl-C, and its kin, leave nothing half-written either, and no temporary file.
for path in glob.glob(".*.tmp") + glob.glob("cache/tmp/*"):
    os.remove(path)
os.makedirs("cache", exist_ok=True)  # the last bake may have been killed before it made it
before = set(os.listdir("."))
for n in range(12):
    number = (signal.SIGINT, signal.SIGTERM)[n % 2]
    process = bake("scene.vox", "--cache", "cache" if n % 3 else "cold%d" % n)
    time.sleep(dice.uniform(0.02, length_s))
    process.send_signal(number)
    status = process.wait()
    assert status in (0, 128 + number, -number), status
    assert digest("scene.vox") in good
    left = [f for f in os.listdir(".") if f not in before and not f.startswith("cold")]
    left += glob.glob("c*/tmp/*")
    assert not left, left
print("killed %d, finished %d of %d" % (killed, finished, kills))
PYTHON
# Under sanitizers a bake takes ten times as long, and every moment is tried without them.
kills=100
[ -z "${FORCELAYER_SANITIZED:-}" ] || kills=30
python3 kill.py "$bin" "${FORCELAYER_KILLS:-$kills}"
