"""tools/benchmark with stand-ins for the programs it calls: what it runs, what it repeats, what its table says."""
import json
import os
import shutil
import signal
import subprocess
import sys
import time
import unittest

sys.dont_write_bytecode = True
from benchmark_programs import EVALUATE_MAP, POSEFUSION, WithPrograms
from support import TOOLS, write_program

sys.path.insert(0, str(TOOLS))
from benchmarking.confidence import interval, t_quantile


class Benchmark(WithPrograms):
    def setUp(self):
        super().setUp()
        self.recording("data/walk", masks=True, truth=True)
        self.recording("data/deeper/bare", masks=False, truth=False)

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


class ManyRuns(WithPrograms):
    """Seeds, options and synthetic recordings, several at a time."""

    def test_all_seeds_of_all_options_are_run(self):
        self.recording("data/walk")
        self.recording("data/sit")
        done = self.benchmark("--seeds", "3", "--option", "half=--scale 0.5", "--jobs", "2")
        self.assertEqual(done.returncode, 0, done.stderr)
        runs = self.runs()
        self.assertEqual(len(runs), 2 * 2 * 3)
        self.assertEqual(len(set(runs)), 12)
        self.assertEqual(len([run for run in runs if "--scale 0.5" in run]), 6)
        self.assertEqual(len([run for run in runs if "--start 2 --loops-fern-seed 3" in run]), 4)
        # errors of 1.23, 2.23 and 3.23 cm: their standard deviation is 1, so half the interval is 4.303 / sqrt(3)
        for recording in ("walk", "sit"):
            self.assertEqual(self.cells(done.stdout, recording, "half")[2:6], ["3", "0", "2.23", "2.23 ± 2.48"])
        page = (self.root / "out/page.html").read_text()
        for text in ("2.23 ± 2.48", '"recordings": ["sit", "walk"]', '"name": "half"'):
            self.assertIn(text, page)

    def test_synthetic_recordings_are_made_once(self):
        options = ("--synth", "room=--frames 4 --static", "--seeds", "2", "--jobs", "2")
        done = self.run_tool(*options, "--variants", "default", "no-people", "masks")
        self.assertEqual(done.returncode, 0, done.stderr)
        made = sorted(self.calls("synth"))
        self.assertEqual(len(made), 2)
        self.assertTrue(made[1].endswith("--frames 4 --static --seed 2"), made)
        self.assertEqual(len(self.runs()), 4, "two seeds of two variants: without people there are no masks")

    def test_an_interrupted_benchmark_continues(self):
        self.recording("data/a_quick_one")
        self.recording("data/b_slow_one")
        options = ("--data", self.root / "data", "--variants", "default")
        first = subprocess.Popen(
            self.command(*options), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True
        )
        deadline = time.monotonic() + 30
        while len(self.runs()) < 2 and time.monotonic() < deadline:
            time.sleep(0.02)
        os.killpg(first.pid, signal.SIGINT)  # as Ctrl-C does
        out, err = first.communicate()
        self.assertEqual(first.returncode, 130, err)
        self.assertIn("the same command continues from here", err)
        self.cells(out, "a_quick_one", "default")
        (self.root / "build/go").write_text("")
        again = self.run_tool(*options)
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertEqual([run.count("a_quick_one/default") for run in self.runs()], [1, 0, 0])

    def test_wrong_combinations_are_told(self):
        for options, error in (
            (("--jobs", "0"), "at least 1"),
            (("--jobs", "2", "--slurm"), "give one of them"),
            (("--tum", "x", "--data", "x"), "leave --data and --synth out"),
            (("--option", "--scale=0.5"), "expected one argument"),
            (("--option", "a/b=--scale 0.5"), "has to be NAME=OPTIONS"),
        ):
            done = self.run_tool(*options)
            self.assertEqual(done.returncode, 2)
            self.assertIn(error, done.stderr)
        self.recording("data/walk")
        self.recording("data/again/walk")
        self.assertIn("have the same name", self.benchmark().stderr)


class Tum(WithPrograms):
    def test_what_is_there_is_run_and_shown_beside_the_published_figures(self):
        for name in ("freiburg3_walking_xyz", "freiburg3_sitting_static", "freiburg1_desk"):
            self.recording(f"tum/rgbd_dataset_{name}")
        self.recording("tum/something_else")
        done = self.run_tool("--tum", self.root / "tum")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(len(self.runs()), 3 * 5)
        accuracy, relative = done.stdout.split("Table 2")
        self.assertEqual(
            self.cells(accuracy, "freiburg3_walking_xyz"),
            ["freiburg3_walking_xyz", "67.78", "65.31", "37.11", "3.21", "3.23 (1.23 to 5.23)"]
            + ["3.21 PoseFusion", "1.2 WildGS-SLAM"],
        )
        self.assertEqual(
            self.cells(relative, "freiburg3_sitting_static")[1:],
            ["1.19", "3.23 (1.23 to 5.23)"] + ["1 ElasticFusion", "0.78 DS-SLAM"],
        )
        self.assertIn("median of 5 runs", accuracy)
        self.assertEqual(
            self.cells(relative, "freiburg1_desk")[1:], ["3.23 (1.23 to 5.23)", "1.7 BAD SLAM", "1.5 MonoGS"]
        )
        address = "https://cvg.cit.tum.de/rgbd/dataset/freiburg3/rgbd_dataset_freiburg3_walking_static.tgz"
        self.assertIn(f"not there: rgbd_dataset_freiburg3_walking_static ({address})", done.stdout)
        self.assertNotIn("something_else", done.stdout)

    def test_a_folder_without_them_says_what_was_looked_for(self):
        done = self.run_tool("--tum", self.root)
        self.assertEqual(done.returncode, 1)
        self.assertIn("none of TUM's recordings is there", done.stderr)
        self.assertEqual(done.stderr.count("not there: rgbd_dataset_freiburg3_"), 7)


class Installed(WithPrograms):
    """Laid down as `cmake --install` does, with stand-ins for the programs."""

    programs = {"usr/bin/posefusion": POSEFUSION, "usr/libexec/posefusion/evaluate_map": EVALUATE_MAP}

    def setUp(self):
        super().setUp()
        tools = self.root / "usr/share/posefusion/tools"
        shutil.copytree(TOOLS / "benchmarking", tools / "benchmarking")
        shutil.copy(TOOLS / "benchmark", tools)
        folders = {"bin": "../../../../bin", "libexec": "../../../../libexec/posefusion", "data": "../.."}
        (tools / "benchmarking/installed.json").write_text(json.dumps(folders))
        (self.root / "usr/bin/posefusion-benchmark").symlink_to("../share/posefusion/tools/benchmark")

    def installed(self, *options):
        command = [sys.executable, self.root / "usr/bin/posefusion-benchmark", *options]
        return subprocess.run(command, capture_output=True, text=True, cwd=self.root)

    def test_the_programs_beside_it_are_run_and_results_go_into_the_current_folder(self):
        self.recording("data/walk", masks=True)
        done = self.installed("--data", "data", "--variants", "masks")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.cells(done.stdout, "walk", "masks")[8], "0.123", "ghosts, by evaluate_map")
        self.assertTrue((self.root / "benchmark/walk/masks/seed_1/trajectory.txt").exists())

    def test_recordings_have_to_be_named(self):
        done = self.installed()
        self.assertEqual(done.returncode, 1)
        self.assertEqual(done.stderr, "benchmark: no recordings named; give --data, --synth or --tum\n")

    def test_a_missing_program_is_named(self):
        (self.root / "usr/bin/posefusion").unlink()
        done = self.installed("--synth", "room=--static")
        self.assertIn(f"{self.root.resolve()}/usr/bin/posefusion: not there", done.stderr)


class Confidence(unittest.TestCase):
    def test_interval(self):
        self.assertEqual(interval([]), (None, None))
        self.assertEqual(interval([3.0]), (3, None))
        mean, half = interval([1.0, 2.0, 3.0, 4.0, 5.0])
        self.assertEqual(mean, 3)
        self.assertAlmostEqual(half, 2.776 * 2.5**0.5 / 5**0.5)

    def test_the_quantile_of_many_degrees_follows_the_table(self):
        self.assertAlmostEqual(t_quantile(31), 2.040, delta=0.005)
        self.assertAlmostEqual(t_quantile(100), 1.984, delta=0.001)


if __name__ == "__main__":
    unittest.main()
