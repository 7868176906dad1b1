#!/usr/bin/python3
"""Meshes of a run against the true surface of its synthetic room: every kind of file, trimmed, simplified, textured.

usage: mesh_quality_test.py POSEFUSION EVALUATE_MESH [unittest options]
"""
import json
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

POSEFUSION, EVALUATE_MESH = (Path(argument).resolve() for argument in sys.argv[1:3])


def call(*arguments):
    done = subprocess.run([*map(str, arguments)], capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(f"{arguments}: {done.stderr}")
    return done.stdout


class MeshQuality(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.scratch.name)
        cls.room, cls.run_folder = cls.folder / "room", cls.folder / "run"
        call(POSEFUSION, "synth", "--out", cls.room, "--frames", 40, "--width", 320, "--height", 240, "--static")
        call(POSEFUSION, "run", cls.room, "--out", cls.run_folder, "--no-people", "--no-report")
        exports = {
            "usual.ply": (),
            "usual.glb": (),
            "textured.glb": ("--texture", "--texture-size", 512),
            "open.ply": ("--trim", 0.5),
            "small.ply": ("--max-triangles", 5000),
        }
        for name, options in exports.items():
            options = ("--mesh", cls.folder / name, "--resolution", 0.03, *options)
            call(POSEFUSION, "export", cls.run_folder, *options)
        files = [cls.folder / name for name in exports]
        scores = json.loads(call(EVALUATE_MESH, cls.room, cls.run_folder, *files, "--json"))
        cls.scores = dict(zip(exports, scores))

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    def test_most_of_the_mesh_is_right_and_most_of_the_room_is_there(self):
        usual = self.scores["usual.ply"]
        self.assertGreater(usual["accuracy"], 0.8)
        self.assertGreater(usual["completeness"], 0.7)
        self.assertLess(usual["invented"], 0.02)
        self.assertLess(usual["mean_distance_m"], 0.01)

    def test_every_file_has_the_same_surface(self):
        for name in ("usual.glb", "textured.glb"):
            for key, value in self.scores["usual.ply"].items():
                if key != "mesh":
                    # points are drawn triangle by triangle, and each file has its own order of them
                    allowed = 4e-3 * max(abs(value), 1)
                    self.assertAlmostEqual(self.scores[name][key], value, delta=allowed, msg=f"{name}: {key}")

    def test_what_is_not_trimmed_is_invented(self):
        self.assertGreater(self.scores["open.ply"]["invented"], 3 * self.scores["usual.ply"]["invented"] + 0.01)
        self.assertGreater(self.scores["open.ply"]["area_m2"], self.scores["usual.ply"]["area_m2"])

    def test_simplification_keeps_the_surface(self):
        usual, small = self.scores["usual.ply"], self.scores["small.ply"]
        self.assertLessEqual(small["triangles"], 5000)
        self.assertGreater(usual["triangles"], 10000)
        self.assertGreater(small["accuracy"], usual["accuracy"] - 0.1)
        self.assertGreater(small["completeness"], usual["completeness"] - 0.1)

    def test_the_table_has_a_row_for_each(self):
        table = call(EVALUATE_MESH, self.room, self.run_folder, self.folder / "usual.ply").splitlines()
        self.assertEqual(len(table), 2)
        self.assertIn("usual.ply", table[1])

    def test_what_cannot_be_compared_is_one_clear_line(self):
        (self.folder / "none.ply").write_text("ply\n")
        for mesh, words in (("none.ply", "none.ply"), ("missing.glb", "missing.glb"), ("a.obj", "no .ply")):
            command = [EVALUATE_MESH, self.room, self.run_folder, self.folder / mesh]
            done = subprocess.run(command, capture_output=True, text=True)
            self.assertEqual(done.returncode, 1)
            self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)
            self.assertIn(words, done.stderr)


if __name__ == "__main__":
    os.environ.setdefault("LP_NUM_THREADS", "1")
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
