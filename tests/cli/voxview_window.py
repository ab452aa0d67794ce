"""Drives voxview's window on a virtual screen: keys, mouse, closing, a run beside it.

Usage: voxview_window.py BIN_FOLDER SAMPLE_DATA      (in a scratch folder that holds bay.vox,
       part.pshell and trace.csv)

Events are sent through libX11, the screen is read from the file that `Xvfb -fbdir` keeps.
"""

import ctypes
import json
import os
import pathlib
import re
import signal
import subprocess
import sys
import time

import numpy

BIN, DATA = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
STYLE = pathlib.Path(__file__).resolve().parents[2] / "workbench/viewer/plan/style.h"
WIDTH, HEIGHT = 800, 600
PATIENCE_S = 60  # for what takes a second on a quiet machine
PORT = "47221"


class XEvent(ctypes.Structure):
    """XKeyEvent, XButtonEvent and XMotionEvent, which agree as far as is needed here."""
    _fields_ = [("type", ctypes.c_int), ("serial", ctypes.c_ulong), ("send_event", ctypes.c_int),
                ("display", ctypes.c_void_p), ("window", ctypes.c_ulong), ("root", ctypes.c_ulong),
                ("subwindow", ctypes.c_ulong), ("time", ctypes.c_ulong), ("x", ctypes.c_int),
                ("y", ctypes.c_int), ("x_root", ctypes.c_int), ("y_root", ctypes.c_int),
                ("state", ctypes.c_uint), ("detail", ctypes.c_uint), ("same_screen", ctypes.c_int),
                ("room", ctypes.c_long * 24)]


class XClientMessage(ctypes.Structure):
    _fields_ = [("type", ctypes.c_int), ("serial", ctypes.c_ulong), ("send_event", ctypes.c_int),
                ("display", ctypes.c_void_p), ("window", ctypes.c_ulong),
                ("message_type", ctypes.c_ulong), ("format", ctypes.c_int),
                ("data", ctypes.c_long * 5), ("room", ctypes.c_long * 24)]


KEY_PRESS, BUTTON_PRESS, BUTTON_RELEASE, CLIENT_MESSAGE = 2, 4, 5, 33


class Screen:
    """A virtual X server, its one window, and what is seen of it."""

    def __init__(self):
        pathlib.Path("screen").mkdir()
        read, write = os.pipe()
        self.server = subprocess.Popen(
            ["Xvfb", "-displayfd", str(write), "-screen", "0", "1024x768x24", "-fbdir", "screen"],
            pass_fds=[write], stderr=subprocess.DEVNULL)
        os.close(write)
        self.name = ":" + os.read(read, 20).decode().strip()
        x = ctypes.CDLL("libX11.so.6")
        for function, result in (("XOpenDisplay", ctypes.c_void_p),
                                 ("XDefaultRootWindow", ctypes.c_ulong),
                                 ("XInternAtom", ctypes.c_ulong),
                                 ("XStringToKeysym", ctypes.c_ulong)):
            getattr(x, function).restype = result
        self.x, self.display = x, ctypes.c_void_p(x.XOpenDisplay(self.name.encode()))
        assert self.display, "no connection to Xvfb"
        self.pointer = (WIDTH - 5, HEIGHT - 5)
        self.root = ctypes.c_ulong(x.XDefaultRootWindow(self.display))

    def window(self):
        """The window of voxview: the only child of the root."""
        root, parent = ctypes.c_ulong(), ctypes.c_ulong()
        children, count = ctypes.POINTER(ctypes.c_ulong)(), ctypes.c_uint()
        self.x.XQueryTree(self.display, self.root, ctypes.byref(root), ctypes.byref(parent),
                          ctypes.byref(children), ctypes.byref(count))
        windows = [children[n] for n in range(count.value)]
        return windows[-1] if windows else None

    def picture(self):
        """The screen's pixels, as [768][1024][3]."""
        data = pathlib.Path("screen/Xvfb_screen0").read_bytes()
        header = numpy.frombuffer(data[:100], ">u4")
        start, width, height, line = (int(header[n]) for n in (0, 4, 5, 12))
        start += 12 * int(header[19])
        pixels = numpy.frombuffer(data[start:start + line * height], numpy.uint8)
        return pixels.reshape(height, line // 4, 4)[:, :width, 2::-1].astype(int)

    def send(self, event):
        self.x.XSendEvent(self.display, ctypes.c_ulong(self.window()), 0, ctypes.c_long(0),
                          ctypes.byref(event))
        self.x.XSync(self.display, 0)

    def event(self, kind, x=0, y=0, detail=0, state=0):
        self.send(XEvent(type=kind, display=self.display, window=self.window(), root=self.root,
                         x=x, y=y, x_root=x, y_root=y, detail=detail, state=state, same_screen=1))

    def key(self, name, state=0):
        symbol = ctypes.c_ulong(self.x.XStringToKeysym(name.encode()))
        code = self.x.XKeysymToKeycode(self.display, symbol) & 0xff
        self.event(KEY_PRESS, *self.pointer, code, state)  # no release: q leaves no window for one

    def point(self, x, y):
        """Moves the pointer itself: VTK asks where it is, whatever an event says."""
        self.pointer = (x, y)
        self.x.XWarpPointer(self.display, 0, ctypes.c_ulong(self.window()), 0, 0, 0, 0, x, y)
        self.x.XSync(self.display, 0)

    def scrub(self, from_xy, to_xy):
        self.point(*from_xy)
        self.event(BUTTON_PRESS, *from_xy, 1)
        self.point(*to_xy)
        self.event(BUTTON_RELEASE, *to_xy, 1)

    def drag_until_seen(self, button, before, what):
        """Moves with a button held until that has been seen; returns the picture at the end. Moves
        that wait in the queue when the button goes down are lost, so one alone may not be seen."""
        x, end = 300, time.monotonic() + PATIENCE_S
        self.point(x, 200)
        self.event(BUTTON_PRESS, x, 200, button)
        while (self.picture() == before).all():
            assert time.monotonic() < end, f"not seen: {what} while the button is held"
            x += 5
            self.point(x, 200)
            time.sleep(0.2)
        self.event(BUTTON_RELEASE, x, 200, button)
        return self.changed(before, what)

    def set_resources(self, text):
        """Sets the resources of the screen, as xrdb does."""
        string, replace = 31, 0
        name = self.x.XInternAtom(self.display, b"RESOURCE_MANAGER", 0)
        self.x.XChangeProperty(self.display, self.root, ctypes.c_ulong(name), ctypes.c_ulong(string), 8, replace, text,
                               len(text))
        self.x.XSync(self.display, 0)

    def close_window(self):
        """Closes the window as a window manager's button does."""
        protocols = self.x.XInternAtom(self.display, b"WM_PROTOCOLS", 0)
        delete = self.x.XInternAtom(self.display, b"WM_DELETE_WINDOW", 0)
        message = XClientMessage(type=CLIENT_MESSAGE, display=self.display, window=self.window(),
                                 message_type=protocols, format=32)
        message.data[0] = delete
        self.send(message)

    def kill_client(self):
        """Cuts the client off, as xkill does."""
        self.x.XKillClient(self.display, ctypes.c_ulong(self.window()))
        self.x.XSync(self.display, 0)

    def wait(self, wanted, what):
        """Until wanted(picture) holds in two looks running; returns that picture."""
        end, last = time.monotonic() + PATIENCE_S, None
        while time.monotonic() < end:
            now = self.picture()
            if last is not None and (now == last).all() and wanted(now):
                return now
            last = now
            time.sleep(0.2)
        raise AssertionError("not seen: " + what)

    def seen_moving(self, before):
        end = time.monotonic() + PATIENCE_S
        while (self.picture() == before).all():
            assert time.monotonic() < end, "the part does not move"
            time.sleep(0.1)

    def changed(self, before, what):
        return self.wait(lambda now: (now != before).any(), what)

    def same(self, before, what):
        return self.wait(lambda now: (now == before).all(), what)


def color(name):
    numbers = re.search(rf"k{name}Color = {{([^}}]*)}}", STYLE.read_text()).group(1)
    return numpy.round(255 * numpy.array([float(n) for n in numbers.split(",")]))


def count(picture, name):
    return int((abs(picture - color(name)) <= 1).all(axis=2).sum())


def viewer(screen, *arguments, stderr=None, size=f"{WIDTH}x{HEIGHT}"):
    environment = {**os.environ, "DISPLAY": screen.name}
    return subprocess.Popen(
        [BIN / "voxview", "draw", "bay.vox", "part.pshell", "--size", size, *arguments],
        env=environment, stderr=stderr, text=True)


def run(*arguments):
    return subprocess.Popen(
        [BIN / "voxrun", "bay.vox", "part.pshell", "--device", "sim", "--motion",
         DATA / "press.csv", "--duration", "2s", "--quiet", *arguments])


def ends(process, status, what):
    got = process.wait(PATIENCE_S)
    assert got == status, f"{what}: status {got}, not {status}"


def drawn(picture):
    return (picture[:HEIGHT, :WIDTH] > 0).any(axis=2).mean() > 0.9


def check_replay(screen):
    """Keys and mouse on a run that is over."""
    process = viewer(screen, "--trace", "trace.csv", "--at", "0.5s")
    first = screen.wait(drawn, "the window")
    for key, name in (("2", "interior"), ("3", "force layer"), ("4", "proximity"), ("6", "shell"),
                      ("h", "keys")):
        screen.key(key)
        screen.changed(first, name)
        screen.key(key)
        screen.same(first, name + " as before")
    for axis in "xyz":
        before = screen.picture()
        screen.key("c")
        cut = screen.changed(before, "a cut across " + axis)
        screen.key("period")
        screen.changed(cut, "a cut that moves")
    screen.key("c")
    screen.same(first, "no cut")

    screen.key("n")
    contact = screen.wait(lambda now: count(now, "Contact") > count(first, "Contact") + 300, "the next contact")
    screen.key("g")  # this run has no guard cut: stays
    screen.key("Right")
    step = screen.changed(contact, "a frame later")
    screen.key("Left")
    screen.same(contact, "the frame before")
    screen.key("Home")
    screen.changed(step, "the first frame")
    screen.key("space")
    time.sleep(1)
    screen.key("space")
    played = screen.changed(first, "playing")
    middle = (WIDTH // 2, HEIGHT - 40)
    screen.scrub((200, HEIGHT - 40), middle)
    scrubbed = screen.changed(played, "scrubbing")
    screen.key("End")
    # Neither words, legend nor strip: the arrow of the force on the hand is gone with the force.
    last = screen.wait(lambda now: (now != scrubbed).any() and (now[290:400, :430] > 60).any(axis=2).all(),
                       "the last frame, in free space, without a black arrow")

    screen.key("x")
    side = screen.changed(last, "a view along x")
    turned = screen.drag_until_seen(1, side, "turning")
    moved = screen.drag_until_seen(2, turned, "moving")
    screen.event(BUTTON_PRESS, 300, 200, 4)
    screen.event(BUTTON_RELEASE, 300, 200, 4)
    screen.changed(moved, "zooming")
    screen.key("x")
    screen.point(*middle)  # what lies under the pointer is named
    screen.same(side, "along x again")

    screen.x.XResizeWindow(screen.display, ctypes.c_ulong(screen.window()), 900, 700)
    screen.x.XSync(screen.display, 0)
    # The strip, on its light ground, reaches as far as the window.
    screen.wait(lambda now: (now[600:660, 840:868] > 200).all(axis=2).mean() > 0.8,
                "a larger window, laid out anew")
    screen.close_window()
    ends(process, 0, "the window's button")


def check_layers(screen):
    """A layer that is switched on is whole at once, however little was seen before."""
    process = viewer(screen, "--trace", "trace.csv", "--at", "0.5s", "--show", "contacts")
    bare = screen.wait(drawn, "the window")
    screen.key("3")
    layer = screen.changed(bare, "the force layer")
    screen.key("h")
    screen.changed(layer, "keys")
    screen.key("h")
    screen.same(layer, "the force layer, drawn anew")
    screen.key("q")
    ends(process, 0, "q")


def check_objects(screen):
    """The object under the pointer is named, and no longer where there is none; the tree of objects
    hides and isolates."""
    process = viewer(screen, DATA / "bay.json", "--color", "object", "--view-from", "0,0,1")
    screen.wait(drawn, "the window")
    screen.point(WIDTH - 5, HEIGHT - 5)
    time.sleep(1)
    bare = screen.wait(drawn, "no object under the pointer")
    screen.point(WIDTH // 2, HEIGHT // 2)
    named = screen.changed(bare, "the name of the object under the pointer")
    below_words = (slice(HEIGHT // 2, HEIGHT), slice(0, WIDTH // 2))
    assert (named[below_words] == bare[below_words]).all(), "more than words has changed"
    screen.key("v")
    hidden = screen.changed(named, "the object under the pointer is hidden")
    assert (hidden[below_words] != bare[below_words]).any(), "nothing is hidden in the scene"
    screen.point(WIDTH - 5, HEIGHT - 5)
    screen.key("a")
    screen.same(bare, "all objects, and no name")
    screen.key("o")
    chosen = tree = screen.changed(bare, "the tree")
    for _ in range(2):  # one after the other: a busy machine draws between them
        screen.key("Down")
        chosen = screen.changed(chosen, "another line is chosen")
    screen.key("i")
    paper = lambda picture: (picture[:HEIGHT, :WIDTH] == 255).all(axis=2).mean()
    screen.wait(lambda now: paper(now) > paper(tree) + 0.1, "one object alone: the others are hidden")
    screen.key("i")
    screen.same(chosen, "all objects again")
    # A click on the square before a line hides what the line names, and another one shows it.
    left, top = 18, min(y for y in range(95, HEIGHT) if chosen[y, 26].max() < 60)
    for wanted in ("hidden by a click", "shown by a click"):
        before = screen.picture()
        screen.scrub((left + 7, top + 5), (left + 7, top + 5))
        clicked = screen.changed(before, wanted)
    between_words = (slice(200, 480), slice(320, 560))
    assert (clicked[between_words] == tree[between_words]).all(), "not all are shown again"
    screen.point(WIDTH - 5, HEIGHT - 5)
    screen.key("o")
    screen.same(bare, "no tree")
    screen.key("q")
    ends(process, 0, "q")


def near(picture, name, x, y, reach=6):
    """Whether a pixel of that color lies within `reach` of a place in the window."""
    return count(picture[max(0, y - reach):y + reach + 1, max(0, x - reach):x + reach + 1], name) > 0


def check_measuring(screen):
    """m marks what is under the pointer, then the way to what is under it next; at another moment the way to the part is
    another one. Turning keeps the horizon level."""
    process = viewer(screen, DATA / "bay.json", "--part", DATA / "part.obj", "--units", "mm", "--trace", "trace.csv", "--at",
                     "0.5s", "--focus", "scene", "--view-from", "0,0,1", "--show", "meshes,part")
    screen.wait(drawn, "the window")
    first, second = (520, 300), (420, 380)
    screen.point(*first)
    bare = screen.wait(drawn, "the pointer")
    screen.key("m")
    one = screen.wait(lambda now: near(now, "Measure", *first), "a mark where the pointer was")
    assert count(one, "Measure") < 300, "more than a mark"
    screen.point(*second)
    screen.key("m")
    middle = [(a + b) // 2 for a, b in zip(first, second)]
    two = screen.wait(lambda now: all(near(now, "Measure", *place) for place in (first, second, middle)),
                      "the way between the places")
    screen.key("m", 1)  # with shift
    screen.wait(lambda now: count(now, "Measure") == 0, "measured no more")
    # The part, where it is seen most.
    orange = numpy.argwhere((abs(bare[120:470, 200:600] - color("Part")) < 60).all(axis=2))
    y, x = (int(n) for n in numpy.median(orange, axis=0) + (120, 200))
    process.send_signal(signal.SIGSTOP)  # all four wait in the queue, as on a busy machine
    screen.point(x, y)
    screen.key("m")
    screen.point(*second)
    screen.key("m")
    process.send_signal(signal.SIGCONT)
    before = screen.wait(lambda now: near(now, "Measure", x, y), "a place of the part")
    screen.key("n")  # the next contact
    moved = screen.changed(before, "another moment")
    assert count(moved, "Measure") > 20 and not near(moved, "Measure", x, y, 2), "the place stays where the part was"
    screen.key("q")
    ends(process, 0, "q")


def check_buttons(screen):
    """The buttons of the strip play, pause, and change the speed."""
    process = viewer(screen, "--trace", "trace.csv", "--at", "0.5s")
    slower, play, faster = ((WIDTH - 104 - 30 * n + 13, HEIGHT - 106) for n in (2, 1, 0))
    screen.wait(drawn, "the window")
    screen.point(*play)
    time.sleep(1)
    first = screen.wait(drawn, "no object under the pointer")
    for button, what in ((slower, "half the speed"), (faster, "the speed before")):
        before = screen.picture()
        screen.scrub(button, button)
        screen.changed(before, what)
    screen.same(first, "as it was")
    screen.scrub(faster, faster)
    fast = screen.changed(first, "twice the speed")
    screen.scrub(play, play)
    screen.seen_moving(fast)
    screen.scrub(play, play)
    paused = screen.wait(drawn, "paused")
    time.sleep(0.5)
    assert (screen.picture() == paused).all(), "it plays on"
    strip = (slice(HEIGHT - 118, HEIGHT - 80), slice(150, WIDTH - 170))
    assert (paused[strip] != first[strip]).any(), "the mark of the time has not moved"
    screen.key("q")
    ends(process, 0, "q")


def check_scale(screen):
    """Words and strip are twice as large where the screen says that its pixels are small, or the user does."""
    def shown(scale=""):
        process = viewer(screen, "--trace", "trace.csv", "--at", "0.5s", size="1000x740" + scale)
        picture = screen.wait(lambda now: (now[:740, :1000] > 0).any(axis=2).mean() > 0.9, "the window")
        screen.key("q")
        ends(process, 0, "q")
        return picture

    def strip_height(picture):  # its frame is a dark line from side to side
        rows = (picture[:740, 320:920] < 150).all(axis=2).mean(axis=1)
        return 740 - int(numpy.argmax(rows > 0.9))

    usual = shown()
    assert abs(strip_height(usual) - 118) <= 2, strip_height(usual)
    doubled = shown("@2")
    assert abs(strip_height(doubled) - 236) <= 3, strip_height(doubled)
    screen.set_resources(b"*color: 1\nXft.dpi:\t192\n")
    assert (shown() == doubled).all(), "Xft.dpi is not heeded"
    assert (shown("@1") == usual).all(), "the scale of --size is not heeded"
    screen.set_resources(b"")


def unharmed(sender, what):
    """The run went through all frames and felt in each what it feels alone. It ends with 5 where a
    busy machine held its loop up in the last frames, viewer or not."""
    got = sender.wait(PATIENCE_S)
    assert got in (0, 5), f"{what}: status {got}"
    alone, watched = (json.loads(pathlib.Path(name).read_text())
                      for name in ("reference.json", "watched.json"))
    for fact in ("frames", "outcome_hash"):
        assert alone[fact] == watched[fact], (what, fact, alone[fact], watched[fact])


def check_live(screen):
    """A run beside the window: ending either harms the other in nothing."""
    reference = run("--as-fast-as-possible", "--json", "reference.json")
    ends(reference, 0, "a run alone")
    for kill, check in ((lambda viewer: viewer.send_signal(signal.SIGKILL),
                         lambda viewer: ends(viewer, -signal.SIGKILL, "SIGKILL")),
                        (lambda viewer: screen.kill_client(),
                         lambda viewer: ends_without_display(viewer, "xkill"))):
        process = viewer(screen, "--listen", PORT, stderr=subprocess.PIPE)
        waiting = screen.wait(drawn, "the window")
        sender = run("--udp", PORT, "--json", "watched.json")
        screen.seen_moving(waiting)
        kill(process)
        check(process)
        unharmed(sender, "the run whose viewer was killed")

    process = viewer(screen, "--listen", PORT)
    waiting = screen.wait(drawn, "the window")
    sender = run("--udp", PORT)
    time.sleep(1)
    sender.send_signal(signal.SIGKILL)
    ends(sender, -signal.SIGKILL, "the run")
    silent = screen.changed(waiting, "what came before the run was killed")
    screen.key("f")
    assert process.poll() is None, "the viewer did not outlive the run"
    sender = run("--udp", PORT)  # and follows the next one
    screen.changed(silent, "the next run")
    sender.wait(PATIENCE_S)
    screen.key("q")
    ends(process, 0, "q")


def ends_without_display(process, what):
    words = process.communicate(timeout=PATIENCE_S)[1]
    assert process.returncode == 5, f"{what}: status {process.returncode}: {words}"
    assert words.count("\n") == 1 and "the display closed the connection" in words, words


def check_ends(screen):
    process = viewer(screen)
    screen.wait(drawn, "the window")
    process.terminate()
    ends(process, -signal.SIGTERM, "SIGTERM")
    process = viewer(screen, stderr=subprocess.PIPE)
    screen.wait(drawn, "the window")
    screen.server.terminate()
    ends_without_display(process, "a screen that went away")
    screen.server.wait(PATIENCE_S)
    nowhere = subprocess.run([BIN / "voxview", "bay.vox"], capture_output=True, text=True,
                             env={**os.environ, "DISPLAY": screen.name})
    assert nowhere.returncode == 5 and nowhere.stderr.count("\n") == 1, nowhere
    assert "cannot be opened" in nowhere.stderr, nowhere.stderr


def main():
    screen = Screen()
    try:
        check_replay(screen)
        check_layers(screen)
        check_objects(screen)
        check_measuring(screen)
        check_buttons(screen)
        check_scale(screen)
        check_live(screen)
        check_ends(screen)
    finally:
        screen.server.terminate()


main()
