#!/usr/bin/python3
"""`posefusion run --web`: the page of a run while it is going, in Chromium, and to whom it is shown.

usage: live_test.py PROGRAM [unittest options]
"""
import contextlib
import http.client
import json
import os
import re
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time
import unittest
from pathlib import Path
from urllib.parse import urlsplit

sys.dont_write_bytecode = True
from browser import Browser, chromium

PROGRAM = Path(sys.argv[1]).resolve()
PATIENCE = 25  # seconds; a live source waits no longer than 30 for a frame
FRAMES = 40
STATE = "document.documentElement.dataset.state"
SURFELS = "Number(document.documentElement.dataset.surfels ?? 0)"


class Run:
    """A run of frames that the test gives it one by one. Use it in a `with` statement."""

    def __init__(self, recording, out, *options):
        command = [PROGRAM, "run", "raw:-", "--out", out, "--no-people", "--no-report", "--all-surfels", *options]
        self.process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE
        )
        self.lines = []
        self.reader = threading.Thread(target=self.read)
        self.reader.start()
        self.recording = recording
        entries = (recording / "associations.txt").read_text().splitlines()
        self.entries = iter([line.split() for line in entries if line and not line.startswith("#")])
        camera = (recording / "camera.yaml").read_bytes()
        self.process.stdin.write(b"posefusion-raw 1\n" + struct.pack("<I", len(camera)) + camera)
        self.process.stdin.flush()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.kill()
        with contextlib.suppress(BrokenPipeError):
            self.process.stdin.close()
        self.process.wait()
        self.reader.join()
        self.process.stderr.close()

    def read(self):
        for line in self.process.stderr:
            self.lines.append(line.decode())

    def feed(self, frames):
        """Slowly, so that few are left out; on a busy machine some are."""
        for _ in range(frames):
            color_time, color, depth_time, depth = next(self.entries)
            stamps = [round(float(stamp) * 1e6) * 1000 for stamp in (color_time, depth_time)]
            images = [(self.recording / file).read_bytes() for file in (color, depth)]
            head = struct.pack("<QQI", *stamps, len(images[0]))
            self.process.stdin.write(struct.pack("<I", len(head) + sum(map(len, images))) + head + b"".join(images))
            self.process.stdin.flush()
            time.sleep(0.1)

    def address(self):
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            found = re.search(r"shown at (http://\S+)", "".join(self.lines))
            if found:
                return urlsplit(found.group(1))
            time.sleep(0.05)
        raise RuntimeError(f"no address within {PATIENCE} s: {self.lines}")

    def end(self):
        """Its exit code when there are no more frames."""
        self.process.stdin.close()
        return self.process.wait(PATIENCE)


def ask(address, path, **headers):
    """The status and body of an answer."""
    connection = http.client.HTTPConnection("127.0.0.1", address.port, timeout=PATIENCE)
    connection.request("GET", path, headers=headers)
    answer = connection.getresponse()
    body = answer.read()
    connection.close()
    return answer.status, body


class LiveTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.scratch.name)
        cls.recording = cls.folder / "room"
        size = ["--frames", str(FRAMES), "--width", "160", "--height", "120", "--static"]
        subprocess.run([PROGRAM, "synth", "--out", cls.recording, *size], check=True, capture_output=True)

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    def run_of(self, *options):
        return Run(self.recording, self.folder / self.id().split(".")[-1], "--web", "0", *options)

    def state_with(self, address, condition):
        """The first state told that fulfils it."""
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            status, body = ask(address, address.path + "live/state")
            self.assertEqual(status, 200)
            state = json.loads(body)
            if condition(state):
                return state
            time.sleep(0.1)
        self.fail(f"not within {PATIENCE} s; the last state was {str(state)[:300]}")

    def settled(self, address):
        """The state when it has a map, no more frames come and all is published; on a busy machine that comes late."""
        state = self.state_with(address, lambda state: state["cells"])
        same = 0
        while same < 3:
            time.sleep(2)
            before, state = state, self.state_with(address, lambda state: True)
            same = same + 1 if state == before else 0
        return state

    @unittest.skipIf(chromium() is None, "Chromium is not installed")
    def test_the_page_grows_with_the_run(self):
        with self.run_of() as run, Browser(800, 560) as browser:
            address = run.address()
            self.assertEqual(address.hostname, "127.0.0.1")
            run.feed(8)
            browser.open(address.geturl())
            browser.wait_for(f"{STATE} === 'live' && {SURFELS} > 0")
            first = browser.evaluate(SURFELS)
            newest = lambda: browser.evaluate("Number(document.getElementById('time').max)")
            text = lambda name: browser.evaluate(f"document.getElementById('{name}').textContent")
            browser.wait_for("Number(document.getElementById('time').max) >= 3")
            browser.wait_for("document.getElementById('keyframe-image').naturalWidth === 160")

            before = newest()
            run.feed(16)
            browser.wait_for(f"Number(document.getElementById('time').max) >= {before} + 5")
            browser.wait_for(f"{SURFELS} > {first}")
            self.assertRegex(text("summary"), r"live, frame \d+$")
            follows = """document.getElementById('time').max === document.getElementById('time').value &&
                document.getElementById('time-text').textContent.includes(
                    `frame ${document.getElementById('time').max}`)"""
            self.assertTrue(browser.evaluate(follows), "who looks at the newest frame goes on doing so")
            browser.evaluate(
                """(slider => { slider.value = 3; slider.dispatchEvent(new Event('input')); })
                   (document.getElementById('time'))"""
            )
            self.assertIn("frame 3", text("time-text"))
            for key in ("5", "6"):
                browser.press(key)
                self.assertRegex(text("legend"), r"frame \d+frame \d+")
            seen = int(text("legend").rpartition(" ")[2])

            before = newest()
            run.feed(FRAMES - 24)
            browser.wait_for(f"Number(document.getElementById('time').max) >= {before} + 5")
            self.assertIn("frame 3", text("time-text"), "who has chosen a time keeps it")
            browser.wait_for(f"Number(document.getElementById('legend').textContent.split(' ').pop()) > {seen}")
            self.assertEqual(run.end(), 0)
            browser.wait_for(f"{STATE} === 'complete'")
            self.assertIn("has finished", browser.evaluate("document.getElementById('hint').textContent"))
            browser.wait_for("document.documentElement.dataset.rests === 'true'")
            surfels = browser.evaluate(SURFELS)
            header = (self.folder / self.id().split(".")[-1] / "map.ply").read_bytes()[:2000].decode("latin-1")
            self.assertEqual(surfels, int(re.search(r"element vertex (\d+)", header).group(1)), "all of the result")
            self.assertEqual(browser.evaluate("document.documentElement.dataset.drawn"), str(surfels))
            browser.press("Home")
            self.assertEqual(browser.messages, [], "errors or warnings in the console")
            outside = [u for u in browser.requests if not u.startswith((address.geturl(), "data:", "blob:"))]
            self.assertEqual(outside, [])

    def test_parts_have_versions(self):
        with self.run_of() as run:
            address = run.address()
            run.feed(10)
            first = self.settled(address)
            self.assertEqual(first["status"], "running")
            self.assertEqual(first["frames_to_do"], 0, "nobody knows")
            for identity, _, surfels in first["cells"]:
                status, body = ask(address, f"/live/map/{identity}")
                self.assertEqual((status, body[:2]), (200, b"\x1f\x8b"))
                self.assertGreater(surfels, 0)
            self.assertEqual(sum(surfels for *_, surfels in first["cells"]), first["map"]["surfels"])
            path = json.loads(ask(address, "/live/path/0")[1])
            self.assertEqual(path["poses"]["frame"], list(range(first["frames"])))
            again = self.settled(address)
            self.assertEqual(again["cells"], first["cells"], "nothing new, no other version")
            run.feed(5)
            later = self.state_with(address, lambda state: state["frames"] > first["frames"])
            self.assertNotEqual(later["path"], first["path"])
            self.assertNotEqual(later["cells"], first["cells"])
            self.assertEqual(ask(address, "/live/map/9999"), (204, b""), "what has gone is nothing, not an error")
            for nowhere in ("/map/0", "/lives", "/live", "/../live/state", "/etc/passwd"):
                self.assertEqual(ask(address, nowhere)[0], 404, nowhere)
            self.assertEqual(ask(address, "/live/state", Host="evil.example")[0], 403)

    def test_others_need_the_secret(self):
        with self.run_of("--bind", "0.0.0.0") as run:
            address = run.address()
            self.assertRegex(address.path, r"^/[0-9a-f]{32}/$")
            run.feed(3)
            self.assertEqual(ask(address, address.path + "live/state")[0], 200)
            for path in ("/", "/live/state", "/live/map/0", "/live/path/0"):
                self.assertEqual(ask(address, path)[0], 404, path)

    def test_nobody_is_waited_for(self):
        with self.run_of() as run:
            address = run.address()
            run.feed(3)
            self.assertEqual(ask(address, "/live/state")[0], 200)  # somebody looked in, and went
            begin = time.monotonic()
            self.assertEqual(run.end(), 0)
            self.assertLess(time.monotonic() - begin, 20)

    def test_an_interrupted_run_says_so(self):
        with self.run_of() as run:
            address = run.address()
            run.feed(5)
            self.settled(address)
            run.process.send_signal(signal.SIGINT)

            def feed():  # a live source is waited for, and whether to go on is asked between two frames
                with contextlib.suppress(BrokenPipeError):
                    run.feed(8)

            feeding = threading.Thread(target=feed)
            feeding.start()
            self.state_with(address, lambda state: state["status"] == "interrupted")
            feeding.join()
            self.assertEqual(run.process.wait(PATIENCE), 130)

    def test_what_does_not_work_is_one_clear_line(self):
        with socket.socket() as taken:
            taken.bind(("127.0.0.1", 0))
            taken.listen()
            port = str(taken.getsockname()[1])
            for options, code, words in (
                (["--web", port], 1, ["port is in use", "--web 0"]),
                (["--web", "70000"], 2, ["70000", "65535"]),
                (["--web=kitchen"], 2, ["kitchen", "65535"]),
                (["--web", "0", "--bind", "192.0.2.1"], 1, ["address of this machine"]),
                (["--bind", "0.0.0.0"], 2, ["--bind", "--web"]),
            ):
                command = [PROGRAM, "run", self.recording, "--out", self.folder / "none", "--no-people", *options]
                done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE)
                self.assertEqual(done.returncode, code, done.stderr)
                errors = [line for line in done.stderr.splitlines() if line.startswith("posefusion: ")]
                self.assertEqual(len(errors), 1, done.stderr)
                for word in words:
                    self.assertIn(word, done.stderr)

    def test_looking_on_changes_nothing(self):
        results = []
        for options in ((), ("--web", "0")):
            out = self.folder / f"same {len(options)}"
            command = [PROGRAM, "run", self.recording, "--out", out, "--no-people", "--no-report", *options]
            process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
            for line in process.stderr:
                found = re.search(r"shown at (http://\S+)", line)
                if found:
                    address = urlsplit(found.group(1))
                    while json.loads(ask(address, "/live/state")[1])["status"] == "running":
                        time.sleep(0.05)
            self.assertEqual(process.wait(PATIENCE), 0)
            process.stderr.close()
            results.append([(out / name).read_bytes() for name in ("trajectory.txt", "map.ply")])
        self.assertTrue(results[0] == results[1], "the results differ")


if __name__ == "__main__":
    os.environ.setdefault("LP_NUM_THREADS", "1")
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]])
