"""The body of voxrun_plugin.sh: runs voxrun on the fault plugin, injects each fault, and reads what
the device's motors did. Limits are wide (a machine that does other things too, sanitizers): what is
exact, the tick in which the force goes to zero, is tested in tests/unit/runtime_servo.cpp."""

import concurrent.futures
import csv
import functools
import json
import os
import re
import shutil
import signal
import subprocess
import tempfile
import threading
import time

BIN = os.environ["FORCELAYER_BIN_DIR"]
SLACK_S = 0.4  # beside the stale limit, for everything to be noticed and to pass
STALE_S = 0.05
AT_ONCE = 2  # runs at a time: each is three processes that wake a thousand times a second


def command(name, arguments, extra=(), library=f"{BIN}/fault_plugin.so"):
    for left in ("csv", "csv.part", "json", "now"):  # by a try before this one
        if os.path.exists(f"{name}.{left}"):
            os.remove(f"{name}.{left}")
    return [f"{BIN}/voxrun", "floor.vox", "ball.pshell", "--device",
            f"plugin:library={library},args=log={name}.csv {arguments}",
            "--world-from-device", "0.1m,0.1m,0.06m", "--json", f"{name}.json", "--quiet",
            "--set", f"stale_s={STALE_S}", *extra]


STARTED = []
MINE = threading.local()  # processes of the check that runs on this thread


def run(arguments, **more):
    said = tempfile.TemporaryFile("a+")  # what is written there goes to its end, wherever we read
    process = subprocess.Popen(arguments, stderr=said, stdout=subprocess.DEVNULL, **more)
    process.said = said
    STARTED.append(process)
    MINE.processes.append(process)
    return process


def said(process):
    """On stderr, so far."""
    process.said.seek(0)
    return process.said.read()


# A busy machine's effects on a loop, which is late by more than the stale limit (as tests/support/in_time.sh).
LATE = "the loop was late", "set the motors to zero by itself", "no fresh reading"


class HeldUp(AssertionError):
    """The run was over before the fault came, or the motors stood at zero: their own watchdog's, for want of writes."""


def in_time(check):
    """Runs a check; one whose loop was late is made again."""
    for tries_left in reversed(range(8)):
        MINE.processes = []
        try:
            return check()
        except AssertionError as failed:
            late = isinstance(failed, HeldUp) or any(
                text in said(process) for process in MINE.processes for text in LATE)
            if not late or not tries_left:
                raise
            for process in MINE.processes:
                if process.poll() is None:
                    process.kill()
                process.wait()
            time.sleep(2)  # its device writes its log to the end


def wait_until(true, process, what):
    deadline = time.monotonic() + 20
    while not true():
        assert process.poll() is None and time.monotonic() < deadline, (process.args, what, said(process))
        time.sleep(0.02)


def start(name, arguments, extra=(), mode="pull", **variables):
    environment = dict(os.environ, FORCELAYER_PLUGIN_MODE=mode, **variables)
    return run(command(name, arguments, extra), env=environment)


def pushing(name, process):
    """Waits until the hand stays in a contact, felt: the device's log grows while it runs."""
    def stays():
        try:
            last = open(f"{name}.csv.part").read().splitlines()[-2].split(",")
        except (FileNotFoundError, IndexError):
            return False
        return last[3] == "1" and float(last[1]) > 0.5
    wait_until(stays, process, "no contact")


def waiting(process):
    wait_until(lambda: "output waits" in said(process), process, "it does not wait")


def finish(process, status):
    process.wait(60)
    error = said(process)
    assert process.returncode == status, (process.args, process.returncode, error)
    return error


def motors(name):
    """(time, force, fault injected) of each millisecond at the device."""
    deadline = time.monotonic() + 20
    while not os.path.exists(f"{name}.csv"):
        assert time.monotonic() < deadline, f"{name}: the device wrote no log"
        time.sleep(0.02)
    rows = []
    for line in open(f"{name}.csv"):
        t, force, fault, _ = line.split(",")
        rows.append((float(t), float(force), int(fault)))
    return rows


def check_motors(name, fault_s=None, limit_s=SLACK_S):
    """They pushed before the fault, and are at zero soon after it, for good."""
    rows = motors(name)
    if fault_s is None:
        fault_s = next((t for t, _, fault in rows if fault), None)
        if fault_s is None:
            raise HeldUp(name, "ended before its fault")
    before = [force for t, force, _ in rows if t < fault_s]
    after = [force for t, force, _ in rows if t > fault_s + limit_s]
    if max(before[-50:], default=0) <= 0.5:
        raise HeldUp(name, before[-50:])
    assert before[0] == 0 and max(abs(f) for f in before) <= 8.001, name
    assert after and all(force == 0 for force in after), (name, max(after, default=None))
    late = [force for t, force, _ in rows if t > fault_s]
    assert max(late, default=0) <= max(before) * 1.05 + 0.1, (name, "the force rose")
    return rows


def events(name):
    return [e["event"] for e in json.load(open(f"{name}.json"))["events"]]


FAULTS = {
    "unplug": "does not answer (the plugin lost its device); check plug and power",
    "freeze": "no fresh reading",
    "nan": "not finite",
    "absurd": "units",
    "uncalibrated": "not calibrated",
    "crash": "does not answer (the plugin crashed: the process was ended by signal",
    "hang": "no fresh reading from the device (the plugin hung and was killed); check the plugin and its SDK",
    "wild": "does not answer (the plugin damaged the memory that it shares with the loop)",
    "wild-index": "does not answer (the plugin damaged the memory that it shares with the loop)",
}


def tripped(name, process, text):
    """How it ended: with `text` and in order. Its events."""
    error = finish(process, 5)
    last = error.strip().splitlines()[-1]
    assert text in last and "output set to zero" in last, (name, error)
    assert json.load(open(f"{name}.json"))["ended_tripped"], name
    happened = events(name)
    assert happened[-1].startswith("output set to zero"), (name, happened)
    return happened


def device_fault(fault):
    happened = tripped(fault, start(fault, f"fault={fault} at=0.3"), FAULTS[fault])
    waited = happened[0].startswith("output waits")  # where the loop began in the hand's contact
    assert happened[waited] == "output armed" and len(happened) == 2 + waited, (fault, happened)
    check_motors(fault, limit_s=STALE_S + SLACK_S)


def a_plugin_that_keeps_its_core():
    """On the loop's only core: the loop runs before it. Motors are not looked at: their device waits there too."""
    process = run(["taskset", "-c", str(min(os.sched_getaffinity(0))), *command("spin", "fault=spin at=0.3")],
                  env=dict(os.environ, FORCELAYER_PLUGIN_MODE="pull"))
    tripped("spin", process, "no fresh reading from the device (the plugin hung and was killed)")


def fault_while_waiting(fault):
    """Begun in a contact, the output waits to be armed: what is wrong then is said as well."""
    name = f"waiting-{fault}"
    process = start(name, f"below fault={fault} when={name}.now")
    waiting(process)
    open(f"{name}.now", "w").close()
    happened = tripped(name, process, FAULTS[fault])
    assert happened[0].startswith("output waits") and len(happened) == 2, happened
    assert all(force == 0 for _, force, _ in motors(name)), name


def push_mode():
    process = start("push", "fault=unplug at=0.3", mode="push")
    assert "does not answer" in finish(process, 5)
    check_motors("push", limit_s=STALE_S + SLACK_S)


def memory_that_cannot_be_cut():
    finish(start("shrink", "fault=shrink at=0.3", ["--duration", "6s"]), 0)
    assert any(fault for _, _, fault in motors("shrink")), "it did not try"
    assert json.load(open("shrink.json"))["output_trips"] == 0


def forces_that_are_written_over():
    """The motors get none beyond their ratings, whatever stands in the shared memory, and no others between: the output trips."""
    error = finish(start("wild-force", "fault=wild-force at=0.3", ["--duration", "6s"]), 5)
    assert "set the motors to zero by itself" in error, error
    felt = [(abs(force), fault) for _, force, fault in motors("wild-force")]
    assert max(force for force, _ in felt) <= 8.001, max(felt)
    assert max(force for force, fault in felt if not fault) > 0.5
    after = [force for force, fault in felt if fault]
    assert 0 in after and not any(after[after.index(0):]), "nothing was written over, or the force came back"


def a_library_without_a_slash():
    """It is the file that was checked, not one of that name in the system's folders."""
    shutil.copy(f"{BIN}/fault_plugin.so", "plain.so")
    os.makedirs("elsewhere", exist_ok=True)
    shutil.copy("floor.vox", "elsewhere/plain.so")  # no library
    arguments = command("plain", "facts=plain.txt", ["--duration", "100ms"], "plain.so")
    folder = os.path.join(os.getcwd(), "elsewhere")
    finish(run(arguments, env=dict(os.environ, LD_LIBRARY_PATH=folder)), 0)


def what_its_process_gets():
    read_end, write_end = os.pipe()
    home = os.path.expanduser(f"~/.forcelayer-plugin-{os.getpid()}")  # where it has no business
    seen = subprocess.run([f"{BIN}/voxrun", "doctor", "--clock", "0"], stdout=subprocess.PIPE, text=True).stdout
    has = re.search(r"confinement of plugins: (.*)", seen)[1]
    mine = os.path.expanduser(f"~/.forcelayer-file-{os.getpid()}")  # of the user
    with open(mine, "w") as file:
        file.write("mine")
    before = os.stat(mine)
    confined = "seccomp" in has and "Landlock" in has  # else the loop would not outlive what is tried
    tries = f" file={mine}" if confined else ""
    finish(run(command("facts", f"facts=facts.txt home={home}{tries}", ["--duration", "100ms"]), pass_fds=(write_end,),
               env=dict(os.environ, SECRET="x", LC_TIME="C", FORCELAYER_PLUGIN_LICENSE="y")), 0)
    os.close(read_end)
    os.close(write_end)
    facts = open("facts.txt").read().splitlines()
    assert "NoNewPrivs:\t1" in facts, facts
    assert [fact for fact in facts if fact.startswith("fd")] == ["fd 0", "fd 1", "fd 2", "fd 3"], facts
    got = {fact[4:] for fact in facts if fact.startswith("env")}
    assert {"PATH", "LC_TIME", "FORCELAYER_PLUGIN_LICENSE"} <= got, got
    assert not {"SECRET", "FORCELAYER_BIN_DIR", "LD_PRELOAD"} & got, got
    may = [fact for fact in facts if fact.startswith("may")]
    if "Landlock" in has:
        assert "may write" not in may and not os.path.exists(home), may
    if "seccomp" in has:
        assert not [fact for fact in may if fact != "may write"], may
    after = os.stat(mine)
    os.remove(mine)
    if confined:
        done = [fact for fact in facts if fact.startswith(("call", "file")) and "No such file" not in fact]
        assert not done, done
        kept = ("st_mode", "st_uid", "st_nlink", "st_size", "st_mtime_ns", "st_ctime_ns")
        assert all(getattr(before, name) == getattr(after, name) for name in kept), (before, after)
    # One that is trusted keeps the user's rights.
    finish(run(command("trusted", "facts=trusted.txt home=" + home + ",trust", ["--duration", "100ms"])), 0)
    trusted = open("trusted.txt").read()
    assert "may start programs" in trusted and "NoNewPrivs:\t1" in trusted, trusted
    if os.access(os.path.dirname(home), os.W_OK):
        os.remove(home)


def a_slow_start():
    """The hand comes down by 5 mm while memory is locked: the part is taken where it then is, but for
    what it moves until the first frame, 2 mm in 0.4 s."""
    finish(start("slow", "way=6", ["--duration", "0.5s", "--trace", "slow-run.csv"],
                 LD_PRELOAD=f"{BIN}/fault_shim.so", FAULT_LOCK_MS="1000"), 0)
    first = next(csv.DictReader(open("slow-run.csv")))
    assert abs(float(first["part_z_m"]) - float(first["handle_z_m"])) < 0.002, first
    assert "output armed" in events("slow"), events("slow")


def a_user_who_may_lock_little_memory():
    """8 MiB, as Debian's users may: threads that come later need memory too, and there is no plugin without them."""
    os.makedirs("other", exist_ok=True)
    os.chmod(".", 0o755)
    for name in ("voxrun", "voxrun-plugin", "fault_plugin.so"):  # others may not look into the folder of the build
        shutil.copy(f"{BIN}/{name}", "other")
    os.chmod("other", 0o777)
    for name in ("floor.vox", "ball.pshell"):
        shutil.copy(name, "other")
    as_another = ["setpriv", "--reuid=65534", "--clear-groups"] if os.geteuid() == 0 else []
    arguments = command("little", "", ["--duration", "200ms"], "./fault_plugin.so")
    arguments[0] = "./voxrun"
    finish(run(["bash", "-c", 'ulimit -l 8192; exec "$@"', "bash", *as_another, *arguments], cwd="other"), 0)


def a_late_reading_is_a_blip():
    finish(start("blip", "fault=blip at=0.3", ["--duration", "6s"]), 0)
    report = json.load(open("blip.json"))
    assert report["output_trips"] == 0 and report["max_device_force_n"] > 0.5, report
    assert any(fault for _, _, fault in motors("blip")), "there was none"


def signals():
    for number in (signal.SIGTERM, signal.SIGINT):
        name = f"signal{int(number)}"
        process = start(name, "")
        pushing(name, process)
        sent_s = time.monotonic()
        process.send_signal(number)
        finish(process, 128 + number)
        check_motors(name, sent_s)
        assert json.load(open(f"{name}.json"))["output_trips"] == 0


def plugin_processes(name):
    """Those that run beside a voxrun of this check, by their arguments."""
    found = []
    for process in filter(str.isdigit, os.listdir("/proc")):
        try:
            if f"log={name}.csv" in open(f"/proc/{process}/cmdline").read() and \
                    os.readlink(f"/proc/{process}/exe").endswith("voxrun-plugin"):
                found.append(process)
        except OSError:
            continue
    return found


def signals_before_the_run():
    """While open() hangs, or no reading comes: voxrun ends at once, and the plugin's process with it."""
    for arguments, number in (("open-hangs", signal.SIGINT), ("open-hangs", signal.SIGTERM), ("silent", signal.SIGINT)):
        name = f"early-{arguments}-{int(number)}"
        process = start(name, arguments)
        wait_until(lambda: plugin_processes(name), process, "no process of the plugin")
        time.sleep(0.5)
        sent_s = time.monotonic()
        process.send_signal(number)
        error = finish(process, 128 + number)
        assert time.monotonic() - sent_s < 1.5, (name, time.monotonic() - sent_s)
        assert error.strip() == f"voxrun: ended by signal {int(number)} ({signal.strsignal(number)}) before the run began", error
        deadline = time.monotonic() + (10 if arguments == "silent" else 0)  # its device, a process too, ends by itself
        while time.monotonic() < deadline and plugin_processes(name):
            time.sleep(0.1)
        assert not plugin_processes(name) and not os.path.exists(f"{name}.json"), name
    # A voxrun that is killed meanwhile leaves no plugin behind.
    process = start("early-kill", "open-hangs")
    wait_until(lambda: plugin_processes("early-kill"), process, "no process of the plugin")
    time.sleep(0.3)
    process.kill()
    finish(process, -signal.SIGKILL)
    deadline = time.monotonic() + 10
    while plugin_processes("early-kill"):
        assert time.monotonic() < deadline, "it is still there"
        time.sleep(0.1)


def a_host_that_stands_still():
    """SIGSTOP: the loop can do nothing; the device's side must see it. After SIGCONT, too, the loop
    does not go on as if nothing had been."""
    process = start("stop", "")
    pushing("stop", process)
    stopped_s = time.monotonic()
    process.send_signal(signal.SIGSTOP)
    time.sleep(STALE_S + SLACK_S + 0.5)
    woken_s = time.monotonic()
    process.send_signal(signal.SIGCONT)
    error = finish(process, 5)
    assert "the loop was late" in error, error
    rows = check_motors("stop", stopped_s, STALE_S + SLACK_S)
    still = [f for t, f, _ in rows if stopped_s + STALE_S + SLACK_S < t < woken_s]
    assert len(still) > 10 and all(f == 0 for f in still), still


def a_host_that_dies():
    process = start("kill", "")
    pushing("kill", process)
    killed_s = time.monotonic()
    process.kill()
    finish(process, -signal.SIGKILL)
    check_motors("kill", killed_s)


def files_that_are_cut_and_written_to():
    """While the hand pushes: the motors feel nothing of it, and the run goes on to its end."""
    arguments = command("cut", "", ["--duration", "6s"])
    arguments[1:3] = "cut.vox", "cut.pshell"
    shutil.copy("floor.vox", "cut.vox")
    shutil.copy("ball.pshell", "cut.pshell")
    process = run(arguments)
    pushing("cut", process)
    changed_s = time.monotonic()
    os.truncate("cut.vox", 0)
    with open("cut.pshell", "r+b") as part:
        part.write(b"\x7f" * os.path.getsize("cut.pshell"))
    finish(process, 0)
    assert json.load(open("cut.json"))["output_trips"] == 0
    after = [force for t, force, _ in motors("cut") if t > changed_s]
    assert len(after) > 1000, len(after)
    assert min(after[:1000]) > 0.5, min(after[:1000])


def a_trip_that_waits():
    """--after-trip wait: zero until the clutch; the run ends with status 5 all the same."""
    process = start("wait", "fault=freeze at=0.3", ["--after-trip", "wait", "--duration", "6s"])
    error = finish(process, 5)
    check_motors("wait", limit_s=STALE_S + SLACK_S)
    assert json.load(open("wait.json"))["frames"] == 6000, error


def refusals():
    for arguments, status, text in (
            ("no-si", 5, "SI units"),
            ("left-handed", 5, "right-handed"),
            ("old-abi", 5, "version"),
            ("no-watchdog", 5, "add without-watchdog to --device"),
            ("late-watchdog", 5, "above 100 ms"),
            ("huge-force", 5, "a rating that no hand-held device has: max_force_n "),
            ("slow-motors", 5, "at least 50 Hz"),
            ("no-axes", 5, "senses no axis"),
            ("seventh-axis", 5, "more than the six axes"),
            ("silent", 5, "gives no readings; check plug and power"),
            ("no-pose", 5, "reports no pose"),
            ("fault=unplug below", 5, "gives no readings (the plugin lost its device)"),
            ("fault=mm", 5, "millimeters")):
        name = "refused-" + arguments.replace("=", "-").replace(" ", "-")
        error = finish(start(name, arguments), status)
        assert text in error and len(error.splitlines()) <= 1 + error.count("warning"), error
        assert all(force == 0 for _, force, _ in motors(name)), name
    assert "does not open its device: the plugin gives no reason" in finish(start("mute", "open-mute"), 5)
    finish(start("allowed", "no-watchdog,without-watchdog", ["--duration", "100ms"]), 0)
    for plugin, text in (("none.so", "no such file"), ("floor.vox", "cannot be loaded")):
        process = run(command("x", "", library=plugin))
        assert text in finish(process, 5), plugin
    process = start("usage", "", ["--as-fast-as-possible", "--duration", "1s"])
    assert "clock of its own" in finish(process, 2)
    process = start("usage", "", ["--after-trip", "rearm"])
    assert "simulated hands" in finish(process, 2)


def the_example():
    finish(run(
        [f"{BIN}/voxrun", "floor.vox", "ball.pshell", "--device", f"plugin:library={BIN}/spring_plugin.so",
         "--world-from-device", "0.1m,0.1m,0.055m", "--duration", "4s",
         "--set", "stale_s=0.05", "--json", "example.json", "--quiet"]), 0)
    report = json.load(open("example.json"))
    assert report["max_device_force_n"] > 0.3 and report["output_trips"] == 0, report


CHECKS = (*(functools.partial(device_fault, fault) for fault in FAULTS),
          *(functools.partial(fault_while_waiting, fault) for fault in FAULTS),
          push_mode, a_plugin_that_keeps_its_core, a_slow_start,
          a_user_who_may_lock_little_memory,
          a_late_reading_is_a_blip, memory_that_cannot_be_cut, forces_that_are_written_over,
          a_library_without_a_slash,
          what_its_process_gets, signals, signals_before_the_run, a_host_that_stands_still, a_host_that_dies,
          files_that_are_cut_and_written_to, a_trip_that_waits, refusals, the_example)
try:
    with concurrent.futures.ThreadPoolExecutor(AT_ONCE) as pool:
        for check in [pool.submit(in_time, check) for check in CHECKS]:
            check.result()
finally:
    for process in STARTED:
        if process.poll() is None:
            process.kill()
