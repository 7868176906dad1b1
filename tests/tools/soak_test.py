"""tools/soak with a stand-in for the program: the long recording it makes, the curve it shows."""
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.dont_write_bytecode = True
from support import TOOLS, load, write_program

soak = load("soak")

# Holds more and more memory while it tells its progress.
POSEFUSION = """#!{python}
import json, pathlib, sys, time
recording, out = pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[sys.argv.index("--out") + 1])
if "--fail" in sys.argv:
    sys.exit("error: no")
count = len([l for l in (recording / "rgb.txt").read_text().splitlines() if l[0] != "#"])
held = []
for i in range(count):
    held.append(bytearray(b"x" * 2**20))
    print(f"frame {{i + 1}}/{{count}}   10 fps", end="\\r", flush=True)
    time.sleep(0.1)
out.mkdir(parents=True)
frames = [{{"surfels": 10 * i, "stable_surfels": 5 * i, "device_bytes": 2**20}} for i in range(count)]
(out / "stats.json").write_text(json.dumps({{"frames": frames}}))
"""


class Soak(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root = Path(self.folder.name)
        self.source = self.root / "source"
        for part in ("rgb", "depth"):
            (self.source / part).mkdir(parents=True)
            lines = []
            for i in range(4):
                (self.source / part / f"{i}.png").write_text(f"{part}{i}")
                lines.append(f"{100 + 0.1 * i:.6f} {part}/{i}.png")
            (self.source / f"{part}.txt").write_text("# list\n" + "\n".join(lines) + "\n")
        (self.source / "groundtruth.txt").write_text(
            "".join(f"{100 + 0.1 * i:.6f} {i} 0 0 0 0 0 1\n" for i in range(4))
        )
        (self.source / "camera.yaml").write_text("fx: 1\n")
        write_program(self.root / "build/posefusion", POSEFUSION)

    def tearDown(self):
        self.folder.cleanup()

    def soak(self, *options):
        return subprocess.run(
            [
                sys.executable,
                TOOLS / "soak",
                "--source",
                self.source,
                "--build",
                self.root / "build",
                "--out",
                self.root / "out",
                "--interval",
                "0.05",
                *options,
            ],
            capture_output=True,
            text=True,
        )

    def test_the_way_leads_there_and_back_again(self):
        self.assertEqual(soak.there_and_back(4, 10), [0, 1, 2, 3, 2, 1, 0, 1, 2, 3])
        self.assertEqual(soak.there_and_back(2, 5), [0, 1, 0, 1, 0])

    def test_the_long_sequence_lists_the_same_images_with_growing_stamps(self):
        soak.repeat_sequence(self.source, self.root / "long", 9)
        rgb, depth, truth = (
            soak.read_list(self.root / "long" / f) for f in ("rgb.txt", "depth.txt", "groundtruth.txt")
        )
        self.assertEqual([p for _, p in rgb], [f"rgb/{i}.png" for i in (0, 1, 2, 3, 2, 1, 0, 1, 2)])
        self.assertEqual([p for _, p in depth], [f"depth/{i}.png" for i in (0, 1, 2, 3, 2, 1, 0, 1, 2)])
        self.assertEqual([p.split()[0] for _, p in truth], list("012321012"))
        for k, (stamp, _) in enumerate(rgb):
            self.assertAlmostEqual(stamp, 100 + 0.1 * k, places=5)
        self.assertEqual((self.root / "long" / rgb[4][1]).read_text(), "rgb2")
        self.assertTrue((self.root / "long/camera.yaml").exists())

    def test_growth_is_told_from_none(self):
        self.assertAlmostEqual(soak.slope([(i, 7 + 0.002 * i) for i in range(100)]), 2)
        self.assertEqual(soak.slope([(i, 5) for i in range(10)]), 0)
        self.assertEqual(soak.slope([(1, None), (2, 3)]), 0)

    def test_memory_belongs_to_the_frame_it_was_seen_at(self):
        frames = [{"surfels": i, "stable_surfels": 0, "device_bytes": 0} for i in range(4)]
        self.assertEqual([row[1] for row in soak.series([(2, 100), (4, 300)], frames)], [None, 100, 100, 300])

    def test_a_run_is_watched(self):
        done = self.soak("--frames", "30")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("| 30 |", done.stdout)
        self.assertGreater(float(done.stdout.split("resident ")[-1].split(" MiB")[0]), 0)
        self.assertIn("surfels +10000", done.stdout)
        rows = (self.root / "out/soak.csv").read_text().splitlines()
        self.assertEqual(len(rows), 31)
        seen = [int(row.split(",")[1]) for row in rows[1:] if row.split(",")[1]]
        self.assertGreater(
            max(seen) - seen[0],
            8 * 2**20,
            "30 frames, 1 MiB each; a busy machine may miss the first ones, and see the last at the exit",
        )
        self.assertIn("<polyline", (self.root / "out/soak.svg").read_text())

    def test_what_goes_wrong_is_named(self):
        self.assertIn("status 1", self.soak("--frames", "5", "--", "--fail").stderr)
        (self.source / "rgb.txt").unlink()
        self.assertIn("no rgb.txt", self.soak().stderr)
        (self.root / "build/posefusion").unlink()
        self.assertIn("not built", self.soak().stderr)


if __name__ == "__main__":
    unittest.main()
