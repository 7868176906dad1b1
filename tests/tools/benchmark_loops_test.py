"""tools/benchmark_loops: the arithmetic of its tables on tiny runs, and what it calls (stand-ins for the programs)."""
import json
import math
import subprocess
import sys
import unittest
from pathlib import Path

sys.dont_write_bytecode = True
from support import TOOLS, ProgramFolder, load, write_program

benchmark = load("benchmark_loops")

# Writes what the real one writes: synth a recording of six frames, run a trajectory that is lost for two of them.
POSEFUSION = """#!{python}
import json, pathlib, sys
with open(pathlib.Path(__file__).parent / "calls.txt", "a") as calls:
    calls.write(" ".join(sys.argv[1:]) + "\\n")
off, easy = "--no-loops" in sys.argv, "easy" in " ".join(sys.argv)
if sys.argv[1] == "evaluate":
    rmse = 0.005 if easy else 0.10 if "/off/" in sys.argv[3] else 0.03
    print(json.dumps({{"ate": {{"translation_m": {{"rmse": rmse}}}}}}))
    sys.exit(0)
out = pathlib.Path(sys.argv[sys.argv.index("--out") + 1])
out.mkdir(parents=True, exist_ok=True)
poses = ["%d.0 %f 0 0 0 0 0 1" % (i, 0.1 * i) for i in range(6)]
if sys.argv[1] == "synth":
    if sys.argv[sys.argv.index("--seed") + 1] == "666":
        sys.exit("error: no | such seed")
    (out / "groundtruth.txt").write_text("\\n".join(poses))
    (out / "events.json").write_text(json.dumps({{"revisit_from": {{"frame": 3, "stamp": "3.000000"}}}}))
    sys.exit(0)
poses[3] = "3.0 9 0 0 0 0 0 1"
(out / "trajectory.txt").write_text("\\n".join(poses))
frames = [{{"stamp": i, "tracking": "failed" if i == 3 else "ok"}} for i in range(6)]
loops = [{{"frame": 4, "kind": "global", "accepted": True}}, {{"frame": 5, "kind": "local", "accepted": False}}]
(out / "stats.json").write_text(json.dumps({{"frames": frames, "loops": [] if off else loops}}))
"""

EVALUATE_MAP = """#!{python}
import json, sys
fraction = 0.04 if "easy" in sys.argv[1] else 0.14 if sys.argv[2].endswith("off") else 0.05
print(json.dumps({{"duplicate_surface": {{"fraction": fraction, "revisited_fraction": fraction / 2}}}}))
"""


class Arithmetic(unittest.TestCase):
    def test_errors_are_measured_in_the_world_of_the_first_frame(self):
        half = math.sqrt(0.5)  # the true world is turned by 90 degrees about z and moved
        truth = [
            (0, [5, 5, 5], [0, 0, half, half]),
            (1, [5, 6, 5], [0, 0, half, half]),
            (2, [4, 6, 5], [0, 0, half, half]),
        ]
        estimate = [(0, [0, 0, 0], [0, 0, 0, 1]), (1, [1, 0, 0], [0, 0, 0, 1]), (2, [1, 1.3, 0], [0, 0, 0, 1])]
        errors = benchmark.pose_errors(truth, estimate)
        for (_, error), expected in zip(errors, (0, 0, 0.3)):
            self.assertAlmostEqual(error, expected)

    def test_frames_without_truth_or_estimate_are_left_out(self):
        pose = lambda stamp: (stamp, [stamp, 0, 0], [0, 0, 0, 1])
        errors = benchmark.pose_errors([pose(0), pose(1), pose(3)], [pose(1), pose(2), pose(3)])
        self.assertEqual([stamp for stamp, _ in errors], [1, 3])
        with self.assertRaises(RuntimeError):
            benchmark.pose_errors([pose(0)], [pose(7)])

    def test_relocalised_is_when_the_pose_stays_right(self):
        judge = lambda errors, tracked=(): benchmark.judge_kidnapping(list(enumerate(errors)), list(tracked), 2)
        self.assertEqual(judge([0, 1, 1, 1, 0.01, 0.02])["frames"], 2)
        self.assertEqual(judge([0, 1, 1, 0.01, 0.3, 0.02])["frames"], 3, "right once is not for good")
        self.assertEqual(judge([0, 0, 0.01, 0.01])["frames"], 0)
        self.assertIsNone(judge([0, 0, 1, 1, 0.06])["frames"])

    def test_wrong_is_tracked_and_far_off(self):
        errors = list(enumerate([0, 0, 0.5, 0.5, 0.1, 0.25]))
        self.assertEqual(benchmark.judge_kidnapping(errors, [0, 1, 3, 4, 5], 2)["wrong"], 2)
        self.assertEqual(benchmark.judge_kidnapping(errors, [0, 1, 4], 2)["wrong"], 0)

    def test_before_uncovering_it_is_astray(self):
        found = benchmark.judge_kidnapping(list(enumerate([0, 0.5, 0.5, 0.01, 0.5])), [0, 1, 4], 3)
        self.assertEqual((found["wrong"], found["astray"]), (1, 1))

    def test_duplicate_surface_is_counted_beyond_the_rooms_own(self):
        self.assertAlmostEqual(benchmark.reduction(0.14, 0.06, 0.04), 0.8)
        self.assertAlmostEqual(benchmark.reduction(0.14, 0.03, 0.04), 1)
        self.assertLess(benchmark.reduction(0.10, 0.12, 0.04), 0)
        self.assertIsNone(benchmark.reduction(0.03, 0.03, 0.04))

    def test_only_accepted_loops_count(self):
        loops = [{"kind": "local", "accepted": True}] * 2 + [
            {"kind": "global", "accepted": True},
            {"kind": "global", "accepted": False},
        ]
        self.assertEqual(benchmark.accepted_loops({"loops": loops}), {"local": 2, "global": 1})
        self.assertEqual(benchmark.accepted_loops({}), {})

    def test_loops_that_bent_the_map_say_how_long_tracking_stood_still(self):
        loops = [
            {"accepted": True, "nodes": 500, "solve_ms": 60.0, "milliseconds": 200.0},
            {"accepted": True, "nodes": 0, "solve_ms": 0, "milliseconds": 90.0},
            {"accepted": False, "nodes": 300, "solve_ms": 40.0, "milliseconds": 100.0},
        ]
        bends = benchmark.standstills(
            {"loops": loops, "frames": [{"slam_ms": 70.0}, {"slam_ms": 80.0}, {"slam_ms": 75.0}]}
        )
        self.assertEqual(bends, [(500, 60.0, 200.0, 75.0)])
        self.assertEqual(benchmark.standstills({}), [])
        run = {"ate": 0.05, "double": 0.1}
        text = benchmark.summary(
            [{"floor": 0.04, "off": run, "on": {**run, "standstills": bends * 2 + [(300, 30.0, 90.0, 75.0)]}}], []
        )
        self.assertIn(
            "3 loops bent the map: graphs of 300 to 500 nodes took 60 ms (median; most 60), "
            "all of the loop 200 ms (most 200); a frame takes 75 ms",
            text,
        )

    def test_the_summary_holds_runs_against_what_is_to_be_reached(self):
        walk = lambda off, on, double: {
            "floor": 0.04,
            "on": {"ate": on, "double": double},
            "off": {"ate": off, "double": 0.14},
        }
        text = benchmark.summary(
            [walk(0.10, 0.05, 0.05), walk(0.10, 0.06, 0.12), walk(0.01, 0.0105, 0.04), {"error": "x"}],
            [
                {"frames": 30, "wrong": 0, "astray": 0},
                {"frames": 31, "wrong": 2, "astray": 0},
                {"frames": None, "wrong": 0, "astray": 1},
            ],
        )
        self.assertIn("in 2 of 3 walks; at most half with loops in 1", text)
        self.assertIn("in 1 of the other 1", text)
        self.assertIn("at least 80 % in 1 of 2", text)
        self.assertIn("within 30 frames in 1 of 3 kidnappings; wrong in 1", text)


class Program(ProgramFolder):
    programs = {"build/posefusion": POSEFUSION, "build/tools/evaluate_map/evaluate_map": EVALUATE_MAP}

    def benchmark(self, *options):
        return subprocess.run(
            [
                sys.executable,
                TOOLS / "benchmark_loops",
                "--data",
                self.root / "data",
                "--out",
                self.root / "out",
                "--build",
                self.root / "build",
                *options,
            ],
            capture_output=True,
            text=True,
        )

    def calls(self, kind):
        return [c for c in (self.root / "build/calls.txt").read_text().splitlines() if c.startswith(kind + " ")]

    def test_a_walk_is_run_with_and_without_loops(self):
        done = self.benchmark("--only", "loop", "--seeds", "1", "--", "--device", "x")
        self.assertEqual(done.returncode, 0, done.stderr)
        rows = [
            [c.strip() for c in line.strip("|").split(" | ")]
            for line in done.stdout.splitlines()
            if line.startswith("| loop")
        ]
        self.assertEqual(len(rows), 2, "nobody, people")
        self.assertEqual(
            rows[0],
            ["loop", "0", "1", "10.00", "3.00", "0.30", "14.00", "5.00", "4.00", "90", "7.00", "2.50", "1 global"],
        )
        runs = self.calls("run")
        self.assertEqual(len(runs), 5, "on and off for each, and the easy walk once")
        self.assertEqual(len([r for r in runs if "--no-loops" in r]), 3)
        self.assertEqual(len([r for r in runs if "--no-people" in r]), 3)
        self.assertTrue(all(r.endswith("--device x") for r in runs))
        self.assertIn("reduced by at least 80 % in 2 of 2", done.stdout)

    def test_what_is_there_is_not_made_again(self):
        first = self.benchmark("--only", "kidnap", "--kidnap-seeds", "2").stdout
        again = self.benchmark("--only", "kidnap", "--kidnap-seeds", "2").stdout
        self.assertEqual(first, again)
        self.assertEqual((len(self.calls("synth")), len(self.calls("run"))), (2, 2))
        self.assertIn("| 1 | 1 | 0 | 0 | 0.00 | 1 global |", first)
        write_program(self.root / "build/posefusion", POSEFUSION + "# rebuilt\n")
        self.benchmark("--only", "kidnap", "--kidnap-seeds", "2")
        self.assertEqual((len(self.calls("synth")), len(self.calls("run"))), (2, 4))

    def test_failures_are_shown_and_the_rest_goes_on(self):
        write_program(self.root / "build/posefusion", POSEFUSION.replace('"666"', '"2"'))
        done = self.benchmark("--only", "kidnap", "--kidnap-seeds", "3", "--table", self.root / "table.md")
        self.assertEqual(done.returncode, 1)
        self.assertIn("| 2 | failed: error: no / such seed |", done.stdout)
        self.assertIn("| 3 | 1 |", done.stdout)
        self.assertEqual((self.root / "table.md").read_text(), done.stdout)

    def test_a_missing_program_is_named(self):
        (self.root / "build/posefusion").unlink()
        self.assertIn("not built", self.benchmark().stderr)


if __name__ == "__main__":
    unittest.main()
