"""tools/benchmark with stand-ins for the programs it calls: what it runs, what it repeats, what its table says."""
import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.dont_write_bytecode = True
from support import TOOLS, write_program

# Writes what a run writes; fails for recordings whose name says so. Every call is noted in calls.txt beside it.
POSEFUSION = """#!{python}
import json, pathlib, sys
with open(pathlib.Path(__file__).parent / "calls.txt", "a") as calls:
    calls.write(" ".join(sys.argv[1:]) + "\\n")
if sys.argv[1] == "evaluate":
    statistics = {{"rmse": 0.0123}}
    print(json.dumps({{"ate": {{"translation_m": statistics}}, "rpe": {{"translation_m_per_s": statistics,
          "rotation_deg_per_s": {{"rmse": 0.5}}}}, "max_distance_from_start_m": 0.25}}))
    sys.exit(0)
if "broken" in sys.argv[2]:
    sys.exit("error: the recording | is broken")
out = pathlib.Path(sys.argv[sys.argv.index("--out") + 1])
(out / "trajectory.txt").write_text("")
summary = {{"frames": 42, "tracking_failures": 1, "stable_surfels": 1000, "frame_time": {{"median_ms": 123.4}}}}
(out / "stats.json").write_text(json.dumps({{"device": {{"name": "stand-in"}}, "summary": summary}}))
"""

EVALUATE_MAP = """#!{python}
import json
print(json.dumps({{"by_first_pose": {{"fraction": 0.00123}}}}))
"""


class Benchmark(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root = Path(self.folder.name)
        write_program(self.root / "build/posefusion", POSEFUSION)
        write_program(self.root / "build/tools/evaluate_map/evaluate_map", EVALUATE_MAP)
        self.recording("data/walk", masks=True, truth=True)
        self.recording("data/deeper/bare", masks=False, truth=False)

    def tearDown(self):
        self.folder.cleanup()

    def recording(self, name, masks, truth):
        folder = self.root / name
        folder.mkdir(parents=True)
        (folder / "associations.txt").write_text("")
        if masks:
            (folder / "masks").mkdir()
        if truth:
            (folder / "groundtruth.txt").write_text("")

    def benchmark(self, *options):
        command = [
            sys.executable,
            TOOLS / "benchmark",
            "--data",
            self.root / "data",
            "--out",
            self.root / "out",
            "--build",
            self.root / "build",
            *options,
        ]
        return subprocess.run(command, capture_output=True, text=True)

    def runs(self):
        calls = self.root / "build/calls.txt"
        return [c for c in calls.read_text().splitlines() if c.startswith("run ")] if calls.exists() else []

    def cells(self, table, recording, variant):
        for line in table.splitlines():
            cells = [c.strip() for c in line.strip("|").split(" | ")]
            if cells[:2] == [recording, variant]:
                return cells
        self.fail(f"no row for {recording}, {variant} in\n{table}")

    def test_every_recording_is_run_in_every_variant_it_allows(self):
        done = self.benchmark("--", "--max-frames", "5")
        self.assertEqual(done.returncode, 0, done.stderr)
        runs = self.runs()
        self.assertEqual(len(runs), 5)
        self.assertEqual(len([r for r in runs if "--no-people" in r]), 2)
        self.assertEqual(len([r for r in runs if "--masks" in r]), 1)
        self.assertTrue(all(r.endswith("--max-frames 5") for r in runs))

    def test_the_table_has_the_numbers(self):
        table = self.benchmark().stdout
        self.assertEqual(
            self.cells(table, "walk", "default")[2:11],
            ["42", "1.23", "1.00", "1.23", "0.50", "25.00", "0.123", "1", "123"],
        )
        self.assertEqual(self.cells(table, "bare", "no-people")[2:9], ["42", "-", "-", "-", "-", "-", "-"])

    def test_complete_runs_are_not_repeated(self):
        self.benchmark()
        before = len(self.runs())
        again = self.benchmark()
        self.assertEqual(len(self.runs()), before)
        self.assertEqual(self.cells(again.stdout, "walk", "default")[2], "42")

    def test_other_options_or_another_program_are_run_anew(self):
        self.benchmark("--only", "bare", "--variants", "default")
        self.benchmark("--only", "bare", "--variants", "default", "--", "--scale", "0.5")
        self.assertEqual(len(self.runs()), 2)
        write_program(self.root / "build/posefusion", POSEFUSION + "# rebuilt\n")
        self.benchmark("--only", "bare", "--variants", "default", "--", "--scale", "0.5")
        self.assertEqual(len(self.runs()), 3)

    def test_a_failed_run_is_shown_and_tried_again(self):
        self.recording("data/broken", masks=False, truth=True)
        for attempt in (1, 2):
            done = self.benchmark("--only", "broken", "walk", "--variants", "default")
            self.assertEqual(done.returncode, 1)
            self.assertIn("failed: error: the recording / is broken", done.stdout)
            self.assertIn("| walk | default | 42 |", done.stdout)
        self.assertEqual(len([r for r in self.runs() if "broken" in r]), 2)

    def test_what_is_missing_is_named(self):
        self.assertIn("no recordings found", self.benchmark("--only", "nothing").stderr)
        self.assertIn("no such folder", self.benchmark("--data", str(self.root / "none")).stderr)
        (self.root / "build/posefusion").unlink()
        self.assertIn("not built", self.benchmark().stderr)

    def test_the_table_can_be_written_to_a_file(self):
        done = self.benchmark("--only", "bare", "--table", self.root / "table.md")
        self.assertEqual((self.root / "table.md").read_text(), done.stdout)


if __name__ == "__main__":
    unittest.main()
