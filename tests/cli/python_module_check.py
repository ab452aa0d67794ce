"""The checks of python_module.sh, in its folder."""

import ast
import doctest
import inspect
import json
import os
import re
import signal
import subprocess
import threading
import time
import pathlib

import numpy

import forcelayer

BIN = pathlib.Path(os.environ["FORCELAYER_BIN_DIR"])
IDENTITY = [1.0, 0, 0, 0]


def public_names():
    """Every public thing of the package, as (name, object)."""
    yield "forcelayer", forcelayer
    for name in forcelayer.__all__:
        thing = getattr(forcelayer, name)
        yield name, thing
        if isinstance(thing, type):
            for member, value in vars(thing).items():
                if not member.startswith("_"):
                    yield f"{name}.{member}", value


def check_doctests():
    runner, parser = doctest.DocTestRunner(), doctest.DocTestParser()
    for name, thing in public_names():
        test = parser.get_doctest(inspect.getdoc(thing) or "", {"forcelayer": forcelayer}, name, None, 0)
        assert test.examples, f"{name} has no example"
        runner.run(test)
    assert runner.summarize().failed == 0
    assert runner.tries > 80


def arguments_of_stub(function):
    spec = function.args
    return [a.arg for a in spec.args + spec.kwonlyargs if a.arg != "self"]


def arguments_of_docstring(thing):
    first = (thing.__doc__ or "").split("\n")[0]
    inside = re.match(r"\w+\((.*)\) -> ", first).group(1)
    names = re.findall(r"(?:^|, )(\w+): ", re.sub(r"\[[^\[\]]*\]", "", re.sub(r"\[[^\[\]]*\]", "", inside)))
    return [n for n in names if n not in ("self", "arg0")]


def check_stubs():
    """The stubs name what is there, with the same arguments."""
    stub = ast.parse((pathlib.Path(forcelayer.__file__).parent / "__init__.pyi").read_text())
    stubbed = {}
    for node in stub.body:
        if isinstance(node, (ast.ClassDef, ast.FunctionDef)):
            stubbed[node.name] = node
            for member in getattr(node, "body", []):
                if isinstance(member, ast.FunctionDef):
                    stubbed.setdefault(f"{node.name}.{member.name}", member)
                elif isinstance(member, ast.AnnAssign):
                    stubbed[f"{node.name}.{member.target.id}"] = member
    real = dict(public_names())
    del real["forcelayer"]
    real["Error.code"] = real["Error.exit_status"] = None
    for name in ("Scene", "Part", "Simulation"):
        real[f"{name}.__init__"] = getattr(forcelayer, name).__init__
    assert set(stubbed) == set(real), set(stubbed) ^ set(real)
    for name, node in stubbed.items():
        if isinstance(node, ast.FunctionDef) and not isinstance(real[name], property):
            assert arguments_of_stub(node) == arguments_of_docstring(real[name]), name


def random_poses(run, count, seed):
    """Poses around those of the run, turned at random."""
    print(f"poses of seed {seed}")
    random = numpy.random.default_rng(seed)
    poses = run.frames["world_from_part"][random.integers(0, len(run.frames), count)].copy()
    poses[:, :3] += random.normal(0, 0.02, (count, 3))
    poses[:, 3:] = random.normal(0, 1, (count, 4))
    return poses


def points_at(part, pose):
    """The shell's points at one pose, world."""
    w, x, y, z = pose[3:] / numpy.linalg.norm(pose[3:])
    turn = numpy.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])
    return (part.points_m.astype(float) + part.center_m) @ turn.T + pose[:3]


def check_against_twin(scene, part, poses):
    """query() and clearance() against points that numpy places and sample() reads."""
    counts, answers = scene.query(part, poses), scene.clearance(part, poses)
    placed = numpy.array([points_at(part, pose) for pose in poses])
    sampled = scene.sample(placed.reshape(-1, 3)).reshape(placed.shape[:2])
    differing = 0
    for value, name in ((1, "interior"), (2, "surface"), (3, "proximity")):
        difference = numpy.abs((sampled["value"] == value).sum(axis=1) - counts[name].astype(int))
        assert difference.max() <= 2, name  # a point on a voxel's face may fall on either side
        differing += (difference > 0).sum()
        assert (counts[name] == answers[name]).all()
    assert differing < len(poses) / 20, differing
    # A point's own bound, less what the shell can lose, is no more than what is proven; and no
    # clearance is above the least interpolated distance and the error of interpolation.
    least = sampled["min_distance_m"].min(axis=1)
    known = numpy.isfinite(answers["clearance_m"])
    assert known.sum() > len(poses) / 4 and (~known).sum() > 0
    assert (least[known] - part.covering_radius_m - 1e-4 <= answers["clearance_m"][known]).all()
    assert (answers["clearance_m"][known] <= least[known] + 1e-6).all()
    # The nearest point is where some point of the part is, and its object the one that is there.
    measured = answers["measured"]
    assert measured.sum() > 20
    near = answers["nearest_point_m"][measured]
    off = numpy.linalg.norm(placed[measured] - near[:, None], axis=2).min(axis=1)
    assert off.max() < 1e-6, off.max()
    there = scene.sample(near)
    differ = (there["object"] != answers["nearest_object"][measured]).mean()
    assert differ < 0.02, differ


def check_samples(scene):
    """Distances are what the voxels' centers hold, and the gradient is their slope."""
    low = numpy.array(scene.origin_voxel)
    random = numpy.random.default_rng(5)
    voxels = low + (random.uniform(0, 1, (200000, 3)) * scene.dims_voxels).astype(int)
    centers = (voxels + 0.5) * scene.voxel_size_m
    at = scene.sample(centers)
    text = "\n".join(" ".join(map(repr, map(float, row))) for row in centers[:3000])
    told = subprocess.run([BIN / "voxinfo", "sample", scene.path], input=text, text=True,
                          capture_output=True, check=True).stdout.splitlines()
    for row, line in zip(at, told):
        value, least, most, name, *hint = line.split("\t")
        assert row["value"] == int(value) and scene.objects[row["object"]] == name
        if numpy.isfinite(row["distance_m"]):  # at a center nothing is interpolated
            middle = (float(least) + float(most) - 0.002 * scene.voxel_size_m) / 2  # the upper bound has the writer's error
            assert abs(row["distance_m"] - middle) < 1e-6, (row, line)
    near = numpy.isfinite(at["distance_m"])
    assert near.mean() > 0.02
    step = 1e-4
    for axis in range(3):
        places = numpy.repeat(centers[near][:2000], 2, axis=0) + random.uniform(-0.002, 0.002, 3)
        between = scene.sample(places)["gradient"][::2, axis]
        places[::2, axis] -= step
        places[1::2, axis] += step
        distance = scene.sample(places)["distance_m"]
        slope = (distance[1::2] - distance[::2]) / (2 * step)
        off = numpy.abs(slope - between)[numpy.isfinite(slope + between)]
        assert numpy.median(off) < 0.05, (axis, numpy.median(off))


def check_replay(scene, part, run):
    """A replay is the run: its trace, its report, and clearance() at its poses."""
    trace = numpy.genfromtxt("run.csv", delimiter=",", names=True, dtype=None, encoding=None)
    frames, report = run.frames, json.load(open("run.json"))
    for column, values in (("t_s", frames["t_s"]), ("part_y_m", frames["world_from_part"][:, 1]),
                           ("handle_qz", frames["world_from_handle"][:, 6]),
                           ("force_z_n", frames["force_n"][:, 2]),
                           ("torque_x_nm", frames["torque_nm"][:, 0]),
                           ("contacts", frames["contacts"]), ("depth_m", frames["depth_m"]),
                           ("guard_cuts", frames["guard_cuts"]),
                           ("clearance_m", frames["clearance_m"])):
        assert numpy.array_equal(trace[column], values, equal_nan=True), column
    names = numpy.array(scene.objects)[frames["nearest_object"]]
    assert (names == trace["nearest_object"]).all()
    for name, value in run.report.items():
        wanted = report[name]
        if name == "touched_objects":
            value = sorted(value, key=lambda touched: -touched["max_force_n"])
        assert value == wanted, name
    answers = scene.clearance(part, frames["world_from_part"])
    for name in ("measured", "nearest_object", "interior", "surface", "outside_map"):
        assert (answers[name] == frames[name]).all(), name
    # world_from_part has been through the part's frame and back.
    assert numpy.nanmax(numpy.abs(answers["clearance_m"] - frames["clearance_m"])) < 1e-9


def check_paths(scene, part, run):
    """check() is voxcheck: its verdict, its violations and its curve."""
    frames = run.frames[::5]
    rows = numpy.column_stack([frames["t_s"], frames["world_from_part"]])
    numpy.savetxt("path.csv", rows, "%.17g", ",", header="t_s,x_m,y_m,z_m,qw,qx,qy,qz", comments="")
    for required_m, allow, status in ((0.005, [], 0), (0.0121, [], 6), (0.0121, ["hydraulic_line"], 6)):
        told = subprocess.run([BIN / "voxcheck", "bay.vox", "part.pshell", "path.csv", "--clearance", f"{required_m}m",
                               "--quiet", "--json", "check.json", *[f"--allow={name}" for name in allow]],
                              capture_output=True, text=True)
        assert told.returncode == status, told.stderr
        report = json.load(open("check.json"))
        answer = scene.check(part, frames["t_s"], frames["world_from_part"], required_m, allow=allow)
        assert answer["verdict"] == report["verdict"] == ("clear" if status == 0 else "not clear")
        assert abs(answer["clearance_m"] - report["min_clearance"]["clearance_m"]) < 1e-9
        assert answer["clearance_m"] <= answer["min_clearance"]["clearance_m"]
        assert answer["min_clearance"]["object"] == report["min_clearance"]["object"]
        times = [(v["from_s"], v["to_s"]) for v in answer["violations"]]
        assert times == [(v["from_s"], v["to_s"]) for v in report["violations"]]
        assert {v["worst"]["object"] for v in answer["violations"]}.isdisjoint(allow)
        curve = answer["curve"]
        assert (curve["from_s"][1:] == curve["to_s"][:-1]).all() and (curve["to_s"] > curve["from_s"]).all()
        assert curve["clearance_m"].min() >= answer["clearance_m"] - 1e-12
        # A clearance proven between poses is proven at them.
        at = scene.clearance(part, frames["world_from_part"])["clearance_m"]
        assert numpy.nanmin(at) > answer["clearance_m"] - 1e-3
    # Out of a seat, on the beam that it was pressed towards.
    k = numpy.nanargmin(frames["clearance_m"])
    out = frames["world_from_part"][[k, 0]]
    pressed = (frames["world_from_handle"][k] - out[0])[:3]
    out[0, :3] += frames["clearance_m"][k] * pressed / numpy.linalg.norm(pressed)
    numpy.savetxt("out.csv", numpy.column_stack([[0, 1], out]), "%.17g", ",", header="t_s,x_m,y_m,z_m,qw,qx,qy,qz",
                  comments="")
    seat = ",".join(f"{x:.17g}" for x in out[0][:3]) + "m," + ",".join(f"{x:.17g}" for x in out[0][3:])
    subprocess.run([BIN / "voxcheck", "bay.vox", "part.pshell", "out.csv", "--clearance", "5mm", "--seat", seat,
                    "--felt-seat", "--quiet", "--json", "seated.json"], check=True)
    told = json.load(open("seated.json"))["seated"]
    seated = scene.check(part, [0, 1], out, 0.005, world_from_seat=out[0], felt_seat=True)["seated"]
    assert len(seated) == len(told) == 1, (seated, told)
    for key in ("from_s", "to_s", "travel_m", "clearance_m"):
        assert abs(seated[0][key] - told[0][key]) < 1e-9, (key, seated, told)
    assert seated[0]["nearest"]["object"] == told[0]["object"] and 0 < seated[0]["travel_m"] < 0.02, seated
    one, two = (scene.check(part, frames["t_s"], frames["world_from_part"], 0.012, threads=n) for n in (1, 2))
    assert one["curve"].tobytes() == two["curve"].tobytes() and one["violations"] == two["violations"]
    expect_error(lambda: scene.check(part, [0, 0], frames["world_from_part"][:2]), "t_s: row 1 is not later")
    expect_error(lambda: scene.check(part, [0], frames["world_from_part"][:2]), "t_s: is empty, or its length differs from the length of poses")
    expect_error(lambda: scene.check(part, [0, 1], frames["world_from_part"][:2], allow=["nothing"]), "no object 'nothing'")


def check_simulation(scene, part, run):
    """step() is run(), a moment is a branch, and a bad pose changes nothing."""
    start = run.frames["world_from_part"][1200]
    hand = numpy.repeat(start[None], 600, axis=0)
    hand[:, 1] += numpy.linspace(0, 0.24, len(hand))
    simulation = forcelayer.Simulation(scene, part)
    simulation.start(start)
    frames = simulation.run(hand)
    assert frames["contacts"].max() > 0 and frames["interior"].max() == 0
    assert simulation.report["frames"] == 600 and simulation.report["penetration_frames"] == 0
    assert simulation.report["min_clearance"]["clearance_m"] == numpy.nanmin(frames["clearance_m"])
    simulation.start(start)
    steps = [simulation.step(pose).tobytes() for pose in hand]
    assert b"".join(steps) == frames.tobytes()
    simulation.start(start)
    simulation.run(hand[:300])
    middle = simulation.moment
    assert simulation.run(hand[300:]).tobytes() == frames[300:].tobytes()
    simulation.moment = middle
    bad = hand[300:].copy()
    bad[10, 3:] = 0
    expect_error(lambda: simulation.run(bad), "world_from_handle: row 10 is not a pose")
    expect_error(lambda: simulation.step(bad[10]), "world_from_handle: row 0 is not a pose")
    expect_error(lambda: simulation.step(hand[300], numpy.full(6, numpy.nan)), "world_from_handle: row 0 is not a pose")
    expect_error(lambda: simulation.step(hand[300], [0] * 5), "handle_velocity: has the shape (5)")
    assert simulation.report["frames"] == 300
    assert simulation.run(hand[300:]).tobytes() == frames[300:].tobytes()
    other = forcelayer.Simulation(scene, part, rate_hz=500, settings={"mass_kg": 0.1})
    expect_error(lambda: setattr(other, "moment", middle), "moment: belongs to another simulation")
    assert other.parameters["mass_kg"] == 0.1 and other.reasons["mass_kg"] == "set"
    given = forcelayer.Simulation(scene, part)
    given.start(start)
    assert given.run(hand, numpy.zeros((600, 6))).tobytes() != frames.tobytes()
    expect_error(lambda: given.run(hand, numpy.zeros((3, 6))), "handle_velocity: has 3 rows for 600 poses")
    expect_error(lambda: forcelayer.Simulation(scene, part, settings={"weight": 1.0}), "weight")
    expect_error(lambda: forcelayer.Simulation(scene, part, rate_hz=float("nan")), "rate_hz")


def check_calls_meanwhile(scene, part, start):
    """One call at a time: another, from a signal or a thread, while run() is at work is refused and changes nothing."""
    simulation = forcelayer.Simulation(scene, part)
    simulation.start(start)
    hand = numpy.repeat(start[None], 20000, axis=0)
    alone = simulation.run(hand).tobytes()
    simulation.start(start)
    middle, refused = simulation.moment, []

    def call_meanwhile(*_):
        for call in (lambda: simulation.step(start), lambda: simulation.run(hand), lambda: simulation.start(start),
                     lambda: setattr(simulation, "moment", middle)):
            refused.append(expect_error(call, "simulation: is running in another call"))
    signal.signal(signal.SIGALRM, call_meanwhile)
    signal.setitimer(signal.ITIMER_REAL, 0.005)
    try:
        assert simulation.run(hand).tobytes() == alone
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
    assert len(refused) == 4, "the run was over before the signal came"
    simulation.step(start)


def expect_error(call, words, status=None):
    try:
        call()
    except forcelayer.Error as error:
        assert words in str(error), str(error)
        assert status in (None, error.exit_status), error.exit_status
        return str(error)
    raise AssertionError(f"no error: {words}")


def check_errors():
    """The text is the commands' own."""
    pathlib.Path("cut.vox").write_bytes(pathlib.Path("bay.vox").read_bytes()[:-100])
    data = bytearray(pathlib.Path("bay.vox").read_bytes())
    data[len(data) // 2] ^= 1
    pathlib.Path("flipped.vox").write_bytes(data)
    for file in ("nowhere.vox", "cut.vox", "flipped.vox", "part.pshell", "."):
        told = subprocess.run([BIN / "voxrun", file, "part.pshell", "--duration", "1ms"],
                              capture_output=True, text=True)
        line = expect_error(lambda f=file: forcelayer.Scene(f), "", told.returncode)
        assert told.stderr.strip() == f"voxrun: {line}", (told.stderr, line)
    for wrong in ([[1, 2, 3]], [1, 2], [[[1, 2, 3, 4, 5, 6, 7]]]):
        expect_error(lambda w=wrong: forcelayer.Scene("bay.vox").query(forcelayer.Part("part.pshell"), w),
                     "poses: has the shape", 2)
    expect_error(lambda: forcelayer.Scene("bay.vox").sample([[0, 0, 0], [0, numpy.inf, 0]]),
                 "points_m: row 1 is not finite", 2)
    for kind in (TypeError,):
        try:
            forcelayer.Scene("bay.vox").query("part.pshell", [[0] * 7])
        except kind:
            continue
        raise AssertionError("an invalid part was taken")


def check_wrong_objects(scene, part, run):
    """None, and objects that no __init__() has made, in the place of every argument, self too: an exception."""
    start, row = [0.2, 0.15, 0.3, 1, 0, 0, 0], [[0, 0, 0.3, 1, 0, 0, 0]]
    simulation = forcelayer.Simulation(scene, part)
    simulation.start(start)
    calls = (  # function, every argument that must not be None
        (forcelayer.Scene, {"path": "bay.vox"}),
        (forcelayer.Part, {"path": "part.pshell"}),
        (forcelayer.Scene.sample, {"self": scene, "points_m": [[0, 0, 0]], "threads": 1}),
        (forcelayer.Scene.query, {"self": scene, "part": part, "poses": row, "threads": 1}),
        (forcelayer.Scene.clearance, {"self": scene, "part": part, "poses": row, "threads": 1}),
        (forcelayer.Scene.check, {"self": scene, "part": part, "t_s": [0], "poses": row, "clearance_m": 0.001,
                                  "allow": [], "threads": 1, "felt_seat": True}),
        (forcelayer.Simulation, {"scene": scene, "part": part, "model": "default", "rate_hz": 1000, "settings": {},
                                 "without_guarantee": False}),
        (forcelayer.Simulation.start, {"self": simulation, "world_from_part": start}),
        (forcelayer.Simulation.step, {"self": simulation, "world_from_handle": start}),
        (forcelayer.Simulation.run, {"self": simulation, "world_from_handle": [start]}),
        (forcelayer.replay, {"scene": scene, "part": part, "recording": "run.flr"}))
    public = {name.rsplit(".")[-1] for name, thing in public_names() if callable(thing)}
    assert public - {"Error", "Moment", "Replay"} == {function.__name__ for function, _ in calls}, public
    classes = (forcelayer.Scene, forcelayer.Part, forcelayer.Simulation, forcelayer.Moment, forcelayer.Replay)
    unmade = [kind.__new__(kind) for kind in classes]

    def expect_type_error(what, call):
        try:
            call()
        except TypeError:
            return
        raise AssertionError(f"taken: {what}")

    for function, arguments in calls:
        if function is not forcelayer.Scene.check:  # on row 0 alone there is no path
            function(**arguments)
        for name in arguments:
            for wrong in (None, *unmade):
                expect_type_error((function, name, type(wrong)), lambda: function(**{**arguments, name: wrong}))
    for kind, whole in zip(classes, (scene, part, simulation, simulation.moment, run)):
        for name, of_class in vars(kind).items():
            if isinstance(of_class, property):
                getattr(whole, name)
                for wrong in (None, *unmade):
                    expect_type_error((kind, name), lambda: of_class.fget(wrong))
    for wrong in (None, *unmade):
        expect_type_error("moment", lambda: setattr(simulation, "moment", wrong))
    for wrong in (numpy.ma.masked_array(row, mask=True), numpy.array(row) * 1j, numpy.array(row) * (1 + 0j)):
        expect_type_error(wrong, lambda: scene.clearance(part, wrong))
    for call in (scene.query, scene.clearance, scene.sample, simulation.run):
        try:
            call(None)
        except TypeError as error:
            assert "::" not in str(error), error


def check_ranges(scene, part):
    """A number out of its range is refused by its name, with the range."""
    numbers = {"mass_kg": "1e-06 to 1000", "coupling_n_per_m": "0.001 to 1e+07", "max_force_n": "1e-06 to 1000",
               "look_ups": "1 to 10000"}
    for wrong in (1e9, 0, -1, 1e-9, numpy.nan, numpy.inf):
        expect_error(lambda w=wrong: forcelayer.Simulation(scene, part, rate_hz=w),
                     f"rate_hz: {wrong:.6g} is outside the range 1 to 100000", 2)
        for name, numbers_range in numbers.items():
            expect_error(lambda n=name, w=wrong: forcelayer.Simulation(scene, part, settings={n: w}),
                         f"{name}: {wrong:.6g} is outside the range {numbers_range}", 2)
    line = expect_error(lambda: forcelayer.Simulation(scene, part, settings={"nope": 1}), "nope: is not a parameter", 2)
    known = forcelayer.Simulation(scene, part).parameters
    assert all(name in line for name in known if name != "rate_hz"), line


def check_threads(scene, part, poses):
    """Neither the number of threads nor other Python threads change an answer; the lock is released."""
    points = numpy.random.default_rng(9).uniform(-0.2, 0.6, (30000, 3))
    one = (scene.query(part, poses, threads=1).tobytes(), scene.clearance(part, poses, threads=1).tobytes(),
           scene.sample(points, threads=1).tobytes())
    for threads in (2, 3, 8):
        assert one[0] == scene.query(part, poses, threads=threads).tobytes()
        assert one[1] == scene.clearance(part, poses, threads=threads).tobytes()
        assert one[2] == scene.sample(points, threads=threads).tobytes()
    same = []
    workers = [threading.Thread(target=lambda: same.append(
        scene.clearance(part, poses).tobytes() == one[1] and scene.sample(points).tobytes() == one[2]))
        for _ in range(4)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    assert same == [True] * 4
    assert len(scene.query(part, poses[:0])) == 0 and len(scene.sample(points[:0])) == 0
    assert scene.clearance(part, poses[3])[0].tobytes() == scene.clearance(part, poses[:4])[3].tobytes()
    assert scene.clearance(part, poses.astype(numpy.float32)).shape == (len(poses),)

    # Ctrl-C ends a long call: a hundred million poses would take minutes.
    many = numpy.broadcast_to(numpy.array(poses[0]), (2_000_000, 7)).copy()
    threading.Timer(0.3, lambda: signal.raise_signal(signal.SIGINT)).start()
    begun = time.monotonic()
    try:
        for _ in range(1000):
            scene.clearance(part, many)
        raise AssertionError("not interrupted")
    except KeyboardInterrupt:
        assert time.monotonic() - begun < 20


def check_views(part):
    """Views of the file keep it open, and are what voxinfo exports."""
    points, normals, areas, center = part.points_m, part.normals, part.areas_m2, part.center_m
    del part
    assert not points.flags.writeable and points.base is not None
    subprocess.run([BIN / "voxinfo", "export", "part.pshell", "part.ply", "--quiet"], check=True)
    data = pathlib.Path("part.ply").read_bytes()
    body = data[data.index(b"end_header\n") + 11:]
    exported = numpy.frombuffer(body, [("at", "<f8", 3), ("normal", "<f4", 3), ("area", "<f4"), ("block", "<u4")],
                                len(points))
    assert numpy.abs(exported["at"] - (points + center)).max() < 1e-9
    assert (exported["normal"] == normals).all() and (exported["area"] == areas).all()


def main():
    scene, part = forcelayer.Scene("bay.vox"), forcelayer.Part("part.pshell")
    run = forcelayer.replay(scene, part, "run.flr")
    poses = random_poses(run, 400, 31)
    check_doctests()
    check_stubs()
    check_replay(scene, part, run)
    check_against_twin(scene, part, poses)
    check_samples(scene)
    check_simulation(scene, part, run)
    check_calls_meanwhile(scene, part, run.frames["world_from_part"][0])
    check_paths(scene, part, run)
    check_errors()
    check_wrong_objects(scene, part, run)
    check_ranges(scene, part)
    check_threads(scene, part, poses)
    check_views(part)
    lean, cropped = forcelayer.Scene("lean.vox"), forcelayer.Scene("cropped.vox")
    assert not lean.stores_distances and numpy.isnan(lean.clearance(part, poses)["clearance_m"]).all()
    assert numpy.isnan(lean.sample(poses[:, :3])["distance_m"]).all()
    assert (lean.query(part, poses) == scene.query(part, poses)).all()
    answers = cropped.clearance(part, poses)
    assert answers["outside_map"].any() and numpy.isnan(answers["clearance_m"][answers["outside_map"]]).all()
    assert not cropped.sample([[-1, 0, 0.3]])["known"][0]
    expect_error(lambda: forcelayer.replay(lean, part, "run.flr"), "run.flr", 4)


main()
