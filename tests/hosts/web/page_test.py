#!/usr/bin/python3
"""The page of `posefusion export --html` in Chromium: it shows the map, answers mouse and keys, and asks for nothing.

usage: page_test.py PROGRAM [unittest options]
"""
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

import numpy as np

sys.dont_write_bytecode = True
sys.path.append(str(Path(__file__).resolve().parents[1] / "python"))
from browser import Browser, chromium
from png_file import read_png
from small_map import WALL, write_wall

PROGRAM = Path(sys.argv[1]).resolve()
SKIPPED = 77
SCALE = 0.25  # of the screenshots that are compared: fewer pixels to decode
WINDOW = 800, 560  # drawn by the processor: few pixels
COMPLETE = "document.documentElement.dataset.state === 'complete'"


def posefusion(*arguments):
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(f"posefusion {arguments}: {done.stderr}")
    return done


class PageTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.scratch.name)
        posefusion("synth", "--out", cls.folder / "room", "--frames", 20, "--width", 160, "--height", 120, "--static")
        posefusion(
            "run", cls.folder / "room", "--out", cls.folder / "run", "--no-people", "--all-surfels", "--no-report"
        )
        posefusion("export", cls.folder / "run", "--html", cls.folder / "map.html")
        cls.browser = Browser(*WINDOW).__enter__()

    @classmethod
    def tearDownClass(cls):
        cls.browser.__exit__()
        cls.scratch.cleanup()

    def setUp(self):
        self.browser.messages.clear()
        self.browser.requests.clear()

    def tearDown(self):
        self.assertEqual(self.browser.messages, [], "errors or warnings in the console")

    def show(self, name="map.html", browser=None):
        browser = browser or self.browser
        browser.open((self.folder / name).as_uri())
        browser.wait_for(COMPLETE)
        self.settle(browser)

    def settle(self, browser=None):
        """Until everything is drawn and nothing moves."""
        (browser or self.browser).wait_for("document.documentElement.dataset.rests === 'true'")

    def pixels(self):
        """What is seen of the map: the controls around it are left out."""
        file = self.folder / "screen.png"
        self.browser.screenshot(file, SCALE)
        picture = read_png(file).astype(int)
        height, width = picture.shape[:2]
        return picture[height // 6 : -height // 6, width // 4 : -width // 4]

    def share_changed(self, before, after):
        return np.mean(np.abs(before - after).max(axis=2) > 12)

    def text(self, selector):
        return self.browser.evaluate(f"document.querySelector('{selector}').textContent")

    def test_shows_the_map_and_asks_for_nothing(self):
        self.show()
        colors = len(np.unique(self.pixels().reshape(-1, 3) // 16, axis=0))
        self.assertGreater(colors, 40, "a room has many colours")
        self.assertEqual(self.text("#name"), "room")
        self.assertIn("surfels", self.text("#summary"))
        self.assertIn("Camera path", self.text("#facts"))
        outside = [url for url in self.browser.requests if not url.startswith(("data:", "blob:"))]
        self.assertEqual(outside, [(self.folder / "map.html").as_uri()])

    def test_the_slider_moves_the_camera(self):
        self.show()
        start = self.pixels()
        self.assertIn("frame 0", self.text("#time-text"))
        self.browser.evaluate(
            """(slider => { slider.value = slider.max; slider.dispatchEvent(new Event('input')); })
               (document.getElementById('time'))"""
        )
        self.settle()
        self.assertIn("frame 19", self.text("#time-text"))
        self.assertGreater(self.share_changed(start, self.pixels()), 0.0005)
        self.browser.press(",")
        self.assertIn("frame 18", self.text("#time-text"))

    def test_plays_to_the_end(self):
        self.show()
        self.browser.press(" ")
        self.browser.wait_for("document.getElementById('time-text').textContent.includes('frame 19')")
        self.browser.wait_for("document.getElementById('play').getAttribute('aria-pressed') === 'false'")

    def test_the_map_grows_with_time(self):
        self.show()
        whole = self.pixels()
        self.browser.evaluate("document.getElementById('grow').click()")
        self.settle()
        self.assertGreater(self.share_changed(whole, self.pixels()), 0.002, "what the first frame did not see is gone")

    def test_people_walk_with_the_slider(self):
        run = self.folder / "with people"
        shutil.copytree(self.folder / "run", run)
        lines = (run / "trajectory.txt").read_text().splitlines()
        stamps = [float(line.split()[0]) for line in lines if not line.startswith("#")]
        body = lambda x: [[x, -0.5, 2, 0.9], [x, -0.3, 2, 0.9], [x - 0.2, -0.3, 2, 0.9], *[None] * 15]
        frames = [
            {"frame": i, "timestamp": stamp, "joints": body(0.05 * i)} for i, stamp in enumerate(stamps) if i >= 10
        ]
        people = {"format": "posefusion people", "version": 1, "joints": [], "people": [{"id": 1, "frames": frames}]}
        (run / "people.json").write_text(json.dumps(people))
        posefusion("export", run, "--html", self.folder / "people.html")
        self.show("people.html")
        there = lambda: self.browser.evaluate("document.documentElement.dataset.people")
        self.assertEqual(there(), "0")
        self.browser.evaluate(
            """(slider => { slider.value = slider.max; slider.dispatchEvent(new Event('input')); })
               (document.getElementById('time'))"""
        )
        self.settle()
        self.assertEqual(there(), "1")
        seen = self.pixels()
        self.browser.evaluate("document.getElementById('show-people').click()")
        self.settle()
        self.assertGreater(self.share_changed(seen, self.pixels()), 0.0005)

    def test_keyframes_have_their_images(self):
        self.show()
        self.assertFalse(self.browser.evaluate("document.getElementById('keyframe').hidden"))
        self.browser.wait_for("document.getElementById('keyframe-image').naturalWidth === 160")
        self.assertIn("Keyframe 1", self.text("#keyframe-caption"))

    def test_without_its_recording_it_has_no_images(self):
        room, elsewhere = self.folder / "room", self.folder / "elsewhere"
        room.rename(elsewhere)
        try:
            done = posefusion("export", self.folder / "run", "--html", self.folder / "bare.html")
        finally:
            elsewhere.rename(room)
        self.assertIn("the page shows no images", done.stderr)
        self.assertIn("--recording PATH", done.stderr)
        self.show("bare.html")
        self.assertTrue(self.browser.evaluate("document.getElementById('keyframe').hidden"))
        self.assertFalse(self.browser.evaluate("document.getElementById('timeline').hidden"))

    def test_turns_moves_and_comes_back(self):
        self.show()
        home = self.pixels()
        self.browser.drag((400, 280), (500, 310))
        self.settle()
        turned = self.pixels()
        self.assertGreater(self.share_changed(home, turned), 0.05)
        for key in ("ArrowLeft", "ArrowUp", "+", "t", "c"):
            before = self.pixels()
            self.browser.press(key)
            self.settle()
            self.assertGreater(self.share_changed(before, self.pixels()), 0.02, key)
        self.browser.press("r")
        self.settle()
        self.assertLess(self.share_changed(home, self.pixels()), 0.01)

    def test_colours_have_a_meaning(self):
        self.show()
        before = self.pixels()
        for key, words in {
            "2": "up",
            "3": "m above",
            "4": "observations",
            "5": "frame 0",
            "6": "frame 19",
            "1": "camera",
        }.items():
            self.browser.press(key)
            self.settle()
            after = self.pixels()
            self.assertGreater(self.share_changed(before, after), 0.1, key)
            self.assertIn(words, self.text("#legend"))
            before = after

    def test_measures(self):
        write_wall(self.folder / "wall.ply", 150)
        posefusion("export", self.folder / "wall.ply", "--html", self.folder / "wall.html")
        self.show("wall.html")
        self.assertTrue(self.browser.evaluate("document.getElementById('timeline').hidden"), "no run, no time")
        self.browser.evaluate("document.getElementById('panel-toggle').click()")  # it covers a part of the wall
        file = self.folder / "screen.png"
        self.browser.screenshot(file, SCALE)
        picture = read_png(file).astype(int)
        red = (picture[:, :, 0] - picture[:, :, 2]) > 80
        row = picture.shape[0] // 2
        columns = np.flatnonzero(red[row])
        self.assertGreater(len(columns), 20, "the wall is seen")
        self.browser.press("m")
        for column in (columns[0] + 1, columns[-1] - 1):
            self.browser.click(int(column / SCALE), int(row / SCALE))
        metres = float(self.text("#distances b").split()[0])
        self.assertAlmostEqual(metres, WALL, delta=0.05 * WALL)
        self.assertIn(f"{metres:.3f} m", self.text("#labels"))
        self.browser.press("Escape")
        self.browser.evaluate("document.getElementById('measure-clear').click()")
        self.assertEqual(self.text("#labels"), "")

    def test_a_million_surfels_can_be_turned_without_a_graphics_card(self):
        write_wall(self.folder / "large.ply", 1000)
        posefusion("export", self.folder / "large.ply", "--html", self.folder / "large.html")
        self.show("large.html")
        number = lambda name: int(self.browser.evaluate(f"document.documentElement.dataset.{name}"))
        self.assertEqual(number("drawn"), 1_000_000)
        home = self.pixels()
        pictures, begin = number("pictures"), time.monotonic()
        while time.monotonic() - begin < 3:
            self.browser.drag((400, 280), (440, 290), steps=20)
        per_second = (number("pictures") - pictures) / (time.monotonic() - begin)
        self.assertGreater(per_second, 2, "pictures while it moves: a dozen where nothing else runs")
        self.assertLess(min(self.seconds_to_answer() for _ in range(3)), 0.6, "while all of it is being drawn")
        self.settle()
        self.assertEqual(number("drawn"), 1_000_000, "all of it when it is at rest")
        self.assertGreater(self.share_changed(home, self.pixels()), 0.01)
        self.browser.press("r")
        self.settle()
        self.assertLess(self.share_changed(home, self.pixels()), 0.01, "as if it had been drawn at once")

    def seconds_to_answer(self):
        """From a key to the next picture, when the view has been still for a moment."""
        time.sleep(0.5)
        return self.browser.evaluate(
            """new Promise(answer => {
                 const {dataset} = document.documentElement, before = dataset.pictures, begin = performance.now();
                 const look = () => dataset.pictures === before ? setTimeout(look, 2)
                   : answer((performance.now() - begin) / 1000);
                 document.body.dispatchEvent(new KeyboardEvent('keydown', {key: 'ArrowLeft', bubbles: true}));
                 look();
               })"""
        )

    def test_without_webgl_it_says_what_to_do(self):
        with Browser(options=["--disable-3d-apis"]) as browser:
            browser.open((self.folder / "map.html").as_uri())
            browser.wait_for("document.documentElement.dataset.state === 'failed'")
            self.assertIn("WebGL 2", browser.evaluate("document.getElementById('notice').innerText"))

    def test_a_damaged_page_says_so(self):
        page = (self.folder / "map.html").read_text()
        at = page.index('id="piece-0">') + 200
        (self.folder / "damaged.html").write_text(page[:at] + page[at + 400 :])
        self.browser.open((self.folder / "damaged.html").as_uri())
        self.browser.wait_for("document.documentElement.dataset.state === 'failed'")
        self.assertIn("cannot be shown", self.text("#notice"))
        self.assertEqual(len(self.browser.messages), 1)
        self.browser.messages.clear()

    def test_fits_a_phone(self):
        self.browser.resize(390, 844, ratio=2, touch=True)
        self.show()
        outside = self.browser.evaluate(
            """[...document.querySelectorAll('body *')].filter(e => !e.closest('[hidden], dialog, svg, #labels'))
               .filter(e => e.getBoundingClientRect().right > innerWidth + 1).map(e => e.id || e.tagName)"""
        )
        self.browser.resize(*WINDOW)
        self.assertEqual(outside, [])

    def test_everything_that_can_be_used_has_a_name(self):
        self.show()
        nodes = self.browser.call("Accessibility.getFullAXTree")["nodes"]
        roles = ("button", "slider", "checkbox", "switch", "radio", "application", "image", "DisclosureTriangle")
        usable = [n for n in nodes if not n["ignored"] and n["role"]["value"] in roles]
        nameless = [n["role"]["value"] for n in usable if not n.get("name", {}).get("value")]
        self.assertGreater(len(usable), 15)
        self.assertEqual(nameless, [])


if __name__ == "__main__":
    if chromium() is None:
        print("page_test: Chromium is not installed (Debian's package is chromium); the page is not tested")
        sys.exit(SKIPPED)
    os.environ.setdefault("LP_NUM_THREADS", "1")
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]])
