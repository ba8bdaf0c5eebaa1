#!/usr/bin/env python3
"""The viewer in a real window, with a real keyboard and mouse: test_view_window.py PROGRAM SOURCE_FOLDER
[unittest's arguments].

Xvfb provides the screen, xdotool operates mouse and keyboard; without them the tests that need a screen are skipped.
"""

import os
import shutil
import subprocess
import sys
import time
import unittest

from cli_case import Case, png_size

MISSING = [name for name in ("Xvfb", "xdotool") if shutil.which(name) is None]
TIMEOUT = 60  # s; a busy machine without a graphics card draws slowly


class Screen:
    def __init__(self):
        read, write = os.pipe()
        self.process = subprocess.Popen(["Xvfb", "-displayfd", str(write), "-screen", "0", "1280x800x24"],
                                        pass_fds=[write], stderr=subprocess.DEVNULL)
        os.close(write)
        with os.fdopen(read) as pipe:
            self.name = ":" + pipe.readline().strip()

    def close(self):
        self.process.terminate()
        self.process.wait()


class NoScreen(Case):
    def test_is_said(self):
        for name in "DISPLAY", "WAYLAND_DISPLAY":
            self.environment.pop(name, None)
        for display in (None, ":4321"):
            if display:
                self.environment["DISPLAY"] = display
            done = self.souple("view", "curtain", code=2)
            self.assert_one_line(done.stderr)
            self.assertIn("souple render", done.stderr)

    def test_bad_input_comes_before_any_window(self):
        for arguments in (["no_such_scene"], ["curtain", "--size", "0x3"], ["/"]):
            done = self.souple("view", *arguments, code=2)
            self.assert_one_line(done.stderr)
            self.assertNotIn("window can be opened", done.stderr)


@unittest.skipIf(MISSING, "install the packages of " + ", ".join(MISSING) + " to test a real window")
class Window(Case):
    def setUp(self):
        super().setUp()
        self.screen = Screen()
        self.addCleanup(self.screen.close)
        self.environment.update(DISPLAY=self.screen.name, LC_ALL="C.UTF-8")
        self.environment.pop("WAYLAND_DISPLAY", None)

    def hand(self, *arguments):
        return subprocess.run(["xdotool", *map(str, arguments)], env=self.environment, capture_output=True, text=True,
                              timeout=TIMEOUT).stdout.strip()

    def wait_to_see(self, what, condition):
        end = time.monotonic() + TIMEOUT
        while time.monotonic() < end:
            found = condition()
            if found:
                return found
            time.sleep(0.1)
        self.fail(f"waited in vain for {what}")

    def window_called(self, title):
        return self.wait_to_see(f"a window called {title}", lambda: self.hand("search", "--name", f"^{title}$"))

    def focus(self, window):
        """Repeats until it has focus: without a window manager, a window that is not mapped yet takes no focus."""

        def has_it():
            self.hand("windowfocus", window)
            return self.hand("getwindowfocus") == window

        self.wait_to_see("the keyboard", has_it)

    def picture(self, number, window):
        path = self.folder / f"souple-curtain-{number:04}.png"
        asked = [0.0]

        def is_there():
            if time.monotonic() - asked[0] > 5:
                self.focus(window)
                self.hand("key", "s")
                asked[0] = time.monotonic()
            return path.exists()

        self.wait_to_see(path.name, is_there)
        return png_size(path)

    def test_a_session(self):
        viewer = self.start("view", "curtain", "--size", "640x400", "--debug")
        window = self.window_called("Souple: curtain")
        width, height = self.picture(1, window)
        self.assertTrue(300 < width < 640 and 200 < height < 400, (width, height))

        # Grabs the curtain, orbits, pans, zooms; none of it ends the program.
        self.hand("mousemove", "--window", window, 460, 160, "mousedown", 1)
        for x in range(460, 560, 20):
            self.hand("mousemove", "--window", window, x, 140)
        self.hand("mouseup", 1, "mousemove", "--window", window, 600, 40, "mousedown", 3)
        self.hand("mousemove", "--window", window, 580, 60, "mouseup", 3, "click", 4, "click", 5)
        for key in ("space", "period", "comma", "r", "2", "w", "c", "f", "h"):
            self.hand("key", key)
        self.wait_to_see("the panels to be hidden", lambda: self.next_picture(window) == (640, 400))

        self.hand("windowsize", window, 320, 240)
        self.wait_to_see("the smaller picture", lambda: self.next_picture(window) == (320, 240))
        for size in ((1, 1), (200, 1), (400, 300)):
            self.hand("windowsize", window, *size)
            time.sleep(0.3)
        self.hand("windowunmap", window)
        time.sleep(0.5)
        self.hand("windowmap", window)
        self.wait_to_see("the picture after that", lambda: self.next_picture(window) == (400, 300))

        self.hand("key", "p")
        window = self.window_called("Souple: crown_splash")
        self.assertIsNone(viewer.poll())
        self.hand("key", "Escape")
        time.sleep(0.3)
        self.hand("key", "Escape")
        output, errors = viewer.communicate(timeout=TIMEOUT)
        self.assertEqual(viewer.returncode, 0, errors)
        self.assertEqual(errors, "")
        self.assertIn("souple-curtain-0001.png", output)

    def next_picture(self, window):
        return self.picture(1 + len(list(self.folder.glob("*.png"))), window)

    def test_an_interrupt_finishes_the_film(self):
        viewer = self.start("view", "balloon", "--size", "400x200")
        self.focus(self.window_called("Souple: balloon"))
        if shutil.which("ffmpeg"):
            self.hand("key", "v")
            self.wait_to_see("the film to begin", lambda: list(self.folder.glob("souple-balloon-0001*")))
            time.sleep(1)
        self.assertEqual(self.stop(viewer)[1], "")
        films = ["souple-balloon-0001.mp4"] if shutil.which("ffmpeg") else []
        self.assertEqual([path.name for path in self.folder.iterdir()], films)

    def test_ends_after_so_many_pictures(self):
        viewer = self.start("view", "curtain", "--size", "200x150", "--frames", "3", "--paused", "--debug")
        _, errors = viewer.communicate(timeout=TIMEOUT)
        self.assertEqual((viewer.returncode, errors), (0, ""))


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
