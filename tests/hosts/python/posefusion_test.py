#!/usr/bin/env python3
"""import posefusion: arrays in and out, the same results as the program, errors, stubs.

Needs PYTHONPATH and POSEFUSION_PROGRAM."""
import ast
import json
import os
import pathlib
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import warnings

import numpy as np
import posefusion

from png_file import read_png

PROGRAM = os.environ["POSEFUSION_PROGRAM"]
SOURCE = pathlib.Path(__file__).resolve().parents[3]
FRAMES, WIDTH, HEIGHT = 8, 160, 120


def run(*arguments):
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True)
    if done.returncode != 0:
        raise AssertionError(done.stderr)
    return done.stdout


def listed(file):
    return [line.split()[:2] for line in file.read_text().splitlines() if not line.startswith("#")]


def trajectory_matrices(file):
    """By stamp the 4 x 4 poses of a trajectory file."""
    poses = {}
    for stamp, tx, ty, tz, x, y, z, w in np.loadtxt(file, ndmin=2):
        cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        poses[stamp] = np.eye(4)
        poses[stamp][:3, :3] += 2 * (w * cross + cross @ cross)
        poses[stamp][:3, 3] = tx, ty, tz
    return poses


class Recorded(unittest.TestCase):
    """Tests on a recording of one person, made once."""

    @classmethod
    def setUpClass(cls):
        cls.temp = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.temp.name)
        cls.recording = cls.folder / "recording"
        run("synth", "--out", cls.recording, "--frames", FRAMES, "--people", 1, "--width", WIDTH, "--height", HEIGHT)
        cls.camera = posefusion.Camera.from_file(cls.recording / "camera.yaml")
        raw = [read_png(cls.recording / name) for _, name in listed(cls.recording / "depth.txt")]
        cls.frames = [(stamp, rgb, depth) for (stamp, rgb, _), depth in zip(posefusion.Recording(cls.recording), raw)]

    @classmethod
    def tearDownClass(cls):
        cls.temp.cleanup()

    def program(self, *options):
        out = self.folder / "out"
        run("run", self.recording, "--out", out, "--no-report", *options)
        return out

    def masks(self):
        """The true masks, as the program writes its own."""
        folder = self.recording / "masks"
        return [read_png(folder / f"{stamp}.png") for stamp, _ in listed(self.recording / "rgb.txt")]


class SameAsTheProgram(Recorded):
    def same(self, slam, out):
        slam.save_trajectory(self.folder / "python.txt")
        slam.save_surfels(self.folder / "python.ply")
        self.assertEqual((self.folder / "python.txt").read_bytes(), (out / "trajectory.txt").read_bytes())
        self.assertEqual((self.folder / "python.ply").read_bytes(), (out / "map.ply").read_bytes())

    def test_with_the_network(self):
        out = self.program("--save-masks")
        slam = posefusion.PoseFusion(self.camera)
        people = 0
        for stamp, rgb, depth in self.frames:
            frame = slam.process(rgb, depth, stamp)
            people += frame.people
            self.assertEqual(frame.joints.shape[1:], (18, 3))
            self.assertEqual(frame.labels.shape, (HEIGHT, WIDTH))
        self.assertGreater(people, 0, "the comparison says nothing about people")
        self.same(slam, out)

    def test_with_masks_and_options(self):
        masks = self.recording / "masks"
        out = self.program("--masks", masks, "--scale", "0.5", "--tracking-iterations", "6,5,4", "--no-loops")
        options = {"tracking": {"iterations": [6, 5, 4]}, "no_loops": True}
        slam = posefusion.PoseFusion(self.camera, options, scale=0.5, no_people=True)
        for (stamp, rgb, depth), mask in zip(self.frames, self.masks()):
            frame = slam.process(rgb, depth, stamp, mask=mask)
            self.assertEqual(frame.labels.shape, (HEIGHT // 2, WIDTH // 2))
        self.same(slam, out)

    def test_options_of_a_file(self):
        out = self.program("--no-people", "--tracking-icp-max-distance", "0.07", "--max-frames", 4)
        slam = posefusion.PoseFusion(self.camera, out / "config.yaml")
        words = [slam.process(rgb, depth, stamp).tracking for stamp, rgb, depth in self.frames[:4]]
        self.same(slam, out)
        self.assertEqual(words, [frame["tracking"] for frame in json.loads((out / "stats.json").read_text())["frames"]])

    def test_evaluate(self):
        out = self.program("--no-people")
        truth, estimate = self.recording / "groundtruth.txt", out / "trajectory.txt"

        def program(*options):
            evaluation = json.loads(run("evaluate", truth, estimate, "--json", *options))
            return {
                key: value
                for key, value in evaluation.items()
                if key not in ("groundtruth", "estimate", "time_offset_s")
            }

        expected = program()
        self.assertEqual(posefusion.evaluate(truth, estimate), expected)
        self.assertEqual(
            posefusion.evaluate(
                truth,
                estimate,
                0.01,
                2,
                rpe_delta_unit="frames",
                rpe_all_pairs=True,
                align="origin",
                scale=True,
                match="evo",
                time_offset=0.001,
            ),
            program(
                "--max-difference",
                0.01,
                "--delta",
                2,
                "--delta-unit",
                "frames",
                "--all-pairs",
                "--align",
                "origin",
                "--scale",
                "--match",
                "evo",
                "--time-offset",
                "0.001",
            ),
        )
        from_arrays = posefusion.evaluate(np.loadtxt(truth), np.loadtxt(estimate))
        rmse = [result["ate"]["translation_m"]["rmse"] for result in (from_arrays, expected)]
        self.assertAlmostEqual(*rmse, places=9)


class Objects(unittest.TestCase):
    """A door that swings becomes an object."""

    POSE_FRAMES, VERTEX = 10, [("position", "<f4", 3), ("normal", "<f4", 3), ("color", "u1", 3), ("radius", "<f4")]

    @classmethod
    def setUpClass(cls):
        cls.temp = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.temp.name)
        cls.recording, cls.out = cls.folder / "recording", cls.folder / "out"
        options = ("--scenario", "movers", "--seed", 3, "--people", 0, "--no-noise", "--frames", 32)
        run("synth", "--out", cls.recording, "--width", WIDTH, "--height", HEIGHT, *options)
        run("run", cls.recording, "--out", cls.out, "--no-people", "--objects", "--no-report")
        recording = posefusion.Recording(cls.recording)
        cls.slam = posefusion.PoseFusion(recording.camera, no_people=True, objects=True)
        cls.frames = [(stamp, cls.slam.process(rgb, depth, stamp)) for stamp, rgb, depth in recording]

    @classmethod
    def tearDownClass(cls):
        del cls.slam, cls.frames
        cls.temp.cleanup()

    def poses_of(self, label):
        """By stamp."""
        return {stamp: o.pose for stamp, frame in self.frames for o in frame.objects if o.label == label}

    def labels(self):
        labels = [int(folder.name) for folder in (self.out / "objects").iterdir()]
        self.assertTrue(labels, "the program found no object to compare with")
        return labels

    def test_poses_are_those_of_the_program(self):
        self.assertEqual({o.label for _, frame in self.frames for o in frame.objects}, set(self.labels()))
        for label in self.labels():
            poses = self.poses_of(label)
            written = trajectory_matrices(self.out / "objects" / str(label) / "trajectory.txt")
            self.assertEqual(list(poses), list(written))
            for stamp, pose in poses.items():
                np.testing.assert_allclose(pose, written[stamp], atol=1e-6)

    def test_maps_are_those_of_the_program(self):
        maps = self.slam.object_maps()
        self.assertEqual(list(maps), sorted(self.labels()))
        vertex = np.dtype(self.VERTEX + [("confidence", "<f4"), ("created", "<u4"), ("last_seen", "<u4")])
        for label, surfels in maps.items():
            ply = (self.out / "objects" / str(label) / "map.ply").read_bytes()
            written = np.frombuffer(ply.split(b"end_header\n", 1)[1], vertex)
            self.assertGreater(len(surfels), 100)
            self.assertEqual(set(surfels.dtype.names), set(vertex.names))
            for name in vertex.names:
                np.testing.assert_array_equal(surfels[name], written[name], name)
            self.assertGreater(len(self.slam.object_maps(stable_only=False)[label]), len(surfels))

    def test_the_door_moves_as_it_does(self):
        truth = trajectory_matrices(self.recording / "objects/101/groundtruth.txt")
        first_camera = next(iter(trajectory_matrices(self.recording / "groundtruth.txt").values()))
        poses = self.poses_of(101)
        self.assertGreater(len(poses), self.POSE_FRAMES)
        (first, *_, last), inverse = poses, np.linalg.inv
        true_motion = inverse(first_camera) @ truth[last] @ inverse(truth[first]) @ first_camera
        middle = poses[first][:, 3]
        self.assertGreater(np.linalg.norm(true_motion @ middle - middle), 0.05)
        np.testing.assert_allclose(poses[last][:, 3], true_motion @ middle, atol=0.02)

    def test_pixels_and_model_are_where_it_is(self):
        camera, surfels = posefusion.Camera.from_file(self.recording / "camera.yaml"), self.slam.object_maps()[101]
        _, frame = self.frames[-1]
        (door,) = [o for o in frame.objects if o.label == 101]
        self.assertEqual(door.pixels, (frame.movers == 101).sum())
        to_camera = np.linalg.inv(frame.pose) @ door.pose
        x, y, z = to_camera[:3, :3] @ surfels["position"].T + to_camera[:3, 3:]
        u, v = (np.rint(a).astype(int) for a in (camera.fx * x / z + camera.cx, camera.fy * y / z + camera.cy))
        inside = (u >= 0) & (u < WIDTH) & (v >= 0) & (v < HEIGHT)
        self.assertGreater((frame.movers[v[inside], u[inside]] == 101).mean(), 0.7)

    def test_none_are_there_unless_asked_for(self):
        recording = posefusion.Recording(self.recording)
        slam = posefusion.PoseFusion(recording.camera, no_people=True)
        stamp, rgb, depth = recording[0]
        self.assertEqual(slam.process(rgb, depth, stamp).objects, [])
        self.assertEqual(slam.object_maps(), {})
        with self.assertRaisesRegex(posefusion.Error, "objects"):
            posefusion.PoseFusion(recording.camera, no_people=True, no_motion=True, objects=True)


GERMAN = """
import locale, sys
if sys.argv[1] == "german":
    locale.setlocale(locale.LC_ALL, "de_DE.UTF-8")
    assert locale.str(1.5) == "1,5"
import numpy as np, posefusion
recording = posefusion.Recording(sys.argv[2])
method = posefusion.PoseFusion(recording.camera, {"tracking": {"icp_max_distance": 0.07}}, scale=0.5, no_people=True)
for stamp, rgb, depth in [recording[i] for i in range(3)]:
    method.process(rgb, depth, stamp)
method.save_trajectory(sys.argv[3] + "/trajectory.txt")
method.save_surfels(sys.argv[3] + "/map.ply", stable_only=False)
evaluation = posefusion.evaluate(sys.argv[2] + "/groundtruth.txt", sys.argv[3] + "/trajectory.txt")
print(evaluation["ate"], recording.camera.fx)
try:
    posefusion.PoseFusion(recording.camera, scale=1.5)
except posefusion.Error as error:
    print(error)
"""


class Locale(Recorded):
    """In a process that writes 1,5."""

    def run_in(self, language, environment):
        out = self.folder / language
        out.mkdir()
        done = subprocess.run(
            [sys.executable, "-c", GERMAN, language, str(self.recording), str(out)],
            capture_output=True,
            text=True,
            env={**os.environ, **environment},
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout, (out / "trajectory.txt").read_bytes(), (out / "map.ply").read_bytes()

    def test_changes_nothing(self):
        made = self.folder / "locale"
        made.mkdir()
        done = subprocess.run(
            ["localedef", "-i", "de_DE", "-f", "UTF-8", str(made / "de_DE.UTF-8")], capture_output=True
        )
        if done.returncode != 0:
            self.skipTest("needs localedef and the package locales to make de_DE.UTF-8")
        self.assertEqual(self.run_in("german", {"LOCPATH": str(made)}), self.run_in("english", {}))


class Arrays(Recorded):
    def slam_of(self, count=3, **options):
        slam = posefusion.PoseFusion(self.camera, no_people=True, **options)
        for stamp, rgb, depth in self.frames[:count]:
            slam.process(rgb, depth, stamp)
        return slam

    def test_depth_in_metres_is_the_same(self):
        slam = posefusion.PoseFusion(self.camera, no_people=True)
        for stamp, rgb, depth in self.frames[:3]:
            metres = depth.astype(np.float32) * (np.float32(1) / np.float32(self.camera.depth_scale))
            loaded = next(m for s, _, m in posefusion.Recording(self.recording) if s == stamp)
            np.testing.assert_array_equal(metres, loaded)
            metres[depth == 0] = np.nan  # not measured
            slam.process(rgb, metres, stamp)
        np.testing.assert_array_equal(slam.trajectory(), self.slam_of().trajectory())

    def test_strided_arrays_are_the_same(self):
        slam = posefusion.PoseFusion(self.camera, no_people=True)
        for stamp, rgb, depth in self.frames[:3]:
            slam.process(rgb[:, ::-1].copy()[:, ::-1], np.asfortranarray(depth), stamp)
        np.testing.assert_array_equal(slam.trajectory(), self.slam_of().trajectory())

    def test_surfels(self):
        slam = self.slam_of()
        surfels = slam.surfels(stable_only=False)
        self.assertGreater(len(surfels), 1000)
        self.assertEqual(surfels["position"].shape, (len(surfels), 3))
        self.assertFalse(surfels.flags.owndata, "the map was copied")
        np.testing.assert_allclose(np.linalg.norm(surfels["normal"], axis=1), 1, atol=1e-3)
        self.assertTrue((surfels["radius"] > 0).all() and (surfels["last_seen"] < 3).all())
        self.assertTrue((surfels["created"] <= surfels["last_seen"]).all())
        kept = surfels["color"].copy()
        del slam
        np.testing.assert_array_equal(surfels["color"], kept)  # outlives the engine

    def test_trajectory(self):
        trajectory = self.slam_of().trajectory()
        self.assertEqual(trajectory.shape, (3, 8))
        np.testing.assert_array_equal(trajectory[:, 0], [stamp for stamp, _, _ in self.frames[:3]])
        np.testing.assert_array_equal(trajectory[0, 1:], [0, 0, 0, 0, 0, 0, 1])

    def test_render(self):
        color, depth = self.slam_of(map={"stable_confidence": 0.5}).render(np.eye(4))
        self.assertEqual((color.shape, color.dtype), ((HEIGHT, WIDTH, 3), np.uint8))
        self.assertEqual((depth.shape, depth.dtype), ((HEIGHT, WIDTH), np.float32))
        measured = self.frames[0][2] / self.camera.depth_scale
        both = (depth > 0) & (measured > 0)
        self.assertGreater(both.mean(), 0.3)
        self.assertLess(np.median(np.abs(depth - measured)[both]), 0.02)

    def test_detector_and_segmenter(self):
        detector = posefusion.Detector(pose={"person_threshold": 0.2})
        self.assertIn("MoveNet", detector.description)
        joints = detector.detect(self.frames[0][1])
        self.assertEqual(joints.shape[1:], (18, 3))
        self.assertGreaterEqual(len(joints), 1)
        segmenter = posefusion.Segmenter(self.camera)
        labels, static = segmenter.segment(self.frames[0][1], self.frames[0][2], joints)
        true = self.masks()[0] > 0
        overlap = ((labels > 0) & true).sum() / ((labels > 0) | true).sum()
        self.assertGreater(overlap, 0.5)
        self.assertTrue((static[labels > 0] == 0).all() and (static > 0).any())

    def test_other_threads_go_on(self):
        slam, ticks, done = self.slam_of(1), [], threading.Event()

        def tick():
            while not done.is_set():
                ticks.append(time.monotonic())
                time.sleep(0.001)

        thread = threading.Thread(target=tick)
        thread.start()
        begin = time.monotonic()
        for stamp, rgb, depth in self.frames[1:4]:
            slam.process(rgb, depth, stamp)
        end = time.monotonic()
        done.set()
        thread.join()
        inside = sum(begin < t < end for t in ticks)
        self.assertGreater(inside, 3 * 2, f"{inside} ticks in {end - begin:.3f} s: the lock was held")


class Faults(Recorded):
    def fails(self, words, call, *arguments, **options):
        with self.assertRaises(posefusion.Error) as caught:
            call(*arguments, **options)
        for word in words:
            self.assertIn(word, str(caught.exception))

    def test_arrays(self):
        slam = posefusion.PoseFusion(self.camera, no_people=True)
        stamp, rgb, depth = self.frames[0]
        self.fails(["uint8", "float64"], slam.process, rgb.astype(float), depth, stamp)
        self.fails(["(height, width, 3)"], slam.process, rgb[..., 0], depth, stamp)
        self.fails(["uint16", "int64"], slam.process, rgb, depth.astype(int), stamp)
        self.fails(["size"], slam.process, rgb[:-4], depth[:-4], stamp)
        self.fails(["size"], slam.process, rgb, depth[:-4], stamp)
        self.fails(["bool"], slam.process, rgb, depth, stamp, mask=depth)
        self.fails(["size"], slam.process, rgb, depth, stamp, mask=np.zeros((4, 4), np.uint8))
        self.fails(["rigid"], slam.render, 2 * np.eye(4))
        slam.process(rgb, depth, stamp)  # none of these did any harm
        self.fails(["stamp", "order"], slam.process, rgb, depth, stamp)
        self.assertEqual(len(slam.trajectory()), 1)

    def test_frames_that_a_run_would_skip(self):
        slam = posefusion.PoseFusion(self.camera, no_people=True)
        stamp, rgb, depth = self.frames[0]
        self.fails(["black"], slam.process, np.zeros_like(rgb), depth, stamp)
        self.fails(["no measurement"], slam.process, rgb, np.zeros_like(depth), stamp)
        slam.process(rgb, depth, stamp)
        self.assertEqual(len(slam.trajectory()), 1)

    def test_a_camera_has_no_length(self):
        camera = self.folder / "dummy.yaml"  # OpenNI2's own camera for tests
        camera.write_text("fx: 300\nfy: 300\ncx: 160\ncy: 120\nwidth: 320\nheight: 240\n")
        try:
            live = posefusion.Recording("openni2:Dummy", camera_file=camera)
        except posefusion.Error as error:
            self.skipTest(str(error))  # built without cameras
        self.assertEqual((live.camera.fx, live.camera.width), (300, 320))
        with self.assertRaisesRegex(TypeError, r"^openni2:Dummy has no len\(\): a camera gives frames without end$"):
            len(live)

    def test_options(self):
        misspelt = {"tracking": {"icp_max_distanze": 1}}
        words = ["tracking.icp_max_distanze", "tracking.icp_max_distance"]
        self.fails(words, posefusion.PoseFusion, self.camera, misspelt)
        self.fails(["scale", "0.05 .. 1"], posefusion.PoseFusion, self.camera, scale=2)
        self.fails(["tracking.icp", "true | false"], posefusion.PoseFusion, self.camera, {"tracking.icp": 1})
        self.fails(["mask"], posefusion.PoseFusion, self.camera, masks="folder")
        for name in ("out", "resume", "checkpoint_every", "max_frames", "real_time"):
            self.fails([name, "posefusion run"], posefusion.PoseFusion, self.camera, {name: 1})
        self.fails(["save_map()"], posefusion.PoseFusion, self.camera, save_map="room.pfmap")
        self.fails(["needs a map"], posefusion.PoseFusion, self.camera, localise_only=True)
        self.fails(["none.yaml"], posefusion.PoseFusion, self.camera, "none.yaml")
        self.fails(["no pose network", "none.onnx"], posefusion.Detector, pose={"model": "none.onnx"})
        self.fails(["camera"], posefusion.Camera, 0, 1, 1, 1, 4, 4)
        for bad in (np.nan, np.inf):
            self.fails(["finite"], posefusion.Camera, bad, 1, 1, 1, 4, 4)
            self.fails(["finite"], posefusion.Camera, 1, 1, bad, 1, 4, 4)
            self.fails(["finite"], posefusion.Camera, 1, 1, 1, 1, 4, 4, bad)
            self.fails(["distortion", "finite"], posefusion.Camera, 1, 1, 1, 1, 4, 4, distortion=[0, bad])
        self.fails(["(n, 8)"], posefusion.evaluate, np.zeros((3, 7)), np.zeros((3, 8)))
        poses = np.zeros((3, 8))
        self.fails(["align", "'best'", "rigid, origin, none"], posefusion.evaluate, poses, poses, align="best")
        self.fails(["row 0"], posefusion.evaluate, np.zeros((3, 8)), np.zeros((3, 8)))

    def test_options_that_hold_themselves(self):
        values, group = [1], {"icp": True}
        values.append(values)
        group["tracking"] = group
        self.fails(["tracking.iterations"], posefusion.PoseFusion, self.camera, {"tracking": {"iterations": values}})
        self.fails(["tracking.tracking"], posefusion.PoseFusion, self.camera, {"tracking": group})
        self.fails(["tracking.tracking"], posefusion.PoseFusion, self.camera, tracking=group)

    def test_objects_that_were_never_initialised(self):
        uses = {
            posefusion.PoseFusion: lambda o: o.device,
            posefusion.Detector: lambda o: o.description,
            posefusion.Segmenter: lambda o: o.segment(*self.frames[0][1:]),
            posefusion.Frame: lambda o: o.pose,
            posefusion.MovingObject: lambda o: o.label,
            posefusion.Camera: lambda o: o.width,
            posefusion.Recording: len,
        }
        for kind, use in uses.items():
            with self.assertRaisesRegex(TypeError, rf"{kind.__name__}\.__init__\(\) has not been called"):
                use(kind.__new__(kind))
        with self.assertRaisesRegex(TypeError, r"Camera\.__init__\(\)"):
            posefusion.PoseFusion(posefusion.Camera.__new__(posefusion.Camera))

    def test_what_is_no_path(self):
        slam = posefusion.PoseFusion(self.camera, no_people=True)
        for call in (slam.save_map, slam.load_map, slam.save_surfels, slam.save_trajectory, posefusion.Recording):
            for wrong in (None, 5):
                self.assertRaises(TypeError, call, wrong)
        self.assertRaises(TypeError, posefusion.evaluate, None, None)
        self.assertRaises(TypeError, posefusion.PoseFusion, self.camera, 5)


class DamagedFrame(Recorded):
    """Frame 3 of a copy of the recording cannot be read."""

    def setUp(self):
        self.copy = self.folder / self.id()
        shutil.copytree(self.recording, self.copy)
        damaged = self.copy / listed(self.copy / "depth.txt")[3][1]
        damaged.write_bytes(damaged.read_bytes()[:100])

    def test_is_skipped_with_a_warning_as_a_run_does(self):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            stamps = [stamp for stamp, _, _ in posefusion.Recording(self.copy)]
        self.assertEqual(stamps, [stamp for i, (stamp, _, _) in enumerate(self.frames) if i != 3])
        self.assertEqual(len(caught), 1)
        self.assertRegex(str(caught[0].message), r"frame skipped: .*depth/")

    def test_is_an_error_where_it_is_asked_for(self):
        recording = posefusion.Recording(self.copy)
        self.assertEqual(len(recording), FRAMES)
        with self.assertRaisesRegex(posefusion.Error, "depth/"):
            recording[3]
        self.assertEqual(recording[4][0], self.frames[4][0])
        self.assertRaises(IndexError, lambda: recording[FRAMES])

    def test_a_warning_may_be_made_an_error(self):
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            with self.assertRaisesRegex(RuntimeWarning, "frame skipped"):
                list(posefusion.Recording(self.copy))

    def test_a_recording_of_nothing_else_is_an_error(self):
        for _, name in listed(self.copy / "depth.txt"):
            (self.copy / name).write_bytes(b"")
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            with self.assertRaisesRegex(posefusion.Error, "no frame of the recording can be used"):
                list(posefusion.Recording(self.copy))


class SavedMaps(Recorded):
    STABLE = {"map": {"stable_confidence": 1, "predict_confidence": 0.5}}

    def mapped(self):
        slam = posefusion.PoseFusion(self.camera, self.STABLE, no_people=True)
        for stamp, rgb, depth in self.frames:
            slam.process(rgb, depth, stamp)
        return slam

    def test_the_program_and_python_read_each_other(self):
        made, file = self.mapped(), self.folder / "room.pfmap"
        made.save_map(file)
        options = ("--no-people", "--map-stable-confidence", 1, "--map-predict-confidence", 0.5)
        out = self.program(*options, "--load-map", file)
        slam = posefusion.PoseFusion(self.camera, self.STABLE, no_people=True)
        slam.load_map(file)
        frames = [slam.process(rgb, depth, stamp) for stamp, rgb, depth in self.frames]
        self.assertEqual(frames[-1].tracking, "ok")
        slam.save_trajectory(self.folder / "python.txt")
        slam.save_surfels(self.folder / "python.ply")
        self.assertEqual((self.folder / "python.txt").read_bytes(), (out / "trajectory.txt").read_bytes())
        self.assertEqual((self.folder / "python.ply").read_bytes(), (out / "map.ply").read_bytes())
        self.program(*options, "--save-map", self.folder / "programs.pfmap")
        self.assertEqual((self.folder / "programs.pfmap").read_bytes(), file.read_bytes())

    def test_the_camera_is_found_and_the_map_stays_where_it_is_only_localised(self):
        file = self.folder / "localise.pfmap"
        made = self.mapped()
        made.save_map(file)
        before = made.surfels(stable_only=False)
        slam = posefusion.PoseFusion(self.camera, self.STABLE, no_people=True, load_map=file, localise_only=True)
        np.testing.assert_array_equal(slam.surfels(stable_only=False), before)
        words = [slam.process(rgb, depth, stamp).tracking for stamp, rgb, depth in self.frames]
        self.assertEqual(words, ["lost", "relocalised"] + ["ok"] * (len(words) - 2))
        np.testing.assert_allclose(slam.trajectory()[:, :4], made.trajectory()[1:, :4], atol=0.01)
        np.testing.assert_array_equal(slam.surfels(stable_only=False), before)

    def test_a_map_may_be_loaded_into_a_camera_that_has_moved_already(self):
        made, file = self.mapped(), self.folder / "again.pfmap"
        made.save_map(file)
        made.load_map(file)
        self.assertEqual(len(made.trajectory()), 0)
        words = [made.process(rgb, depth, stamp).tracking for stamp, rgb, depth in self.frames[:2]]  # earlier stamps
        self.assertEqual(words, ["lost", "relocalised"])
        self.assertEqual(len(made.trajectory()), 1)

    def test_faults(self):
        slam = self.mapped()
        with self.assertRaisesRegex(posefusion.Error, r"save_surfels\(\) writes \.ply"):
            slam.save_map(self.folder / "map.ply")
        with self.assertRaisesRegex(posefusion.Error, "none.pfmap"):
            slam.load_map(self.folder / "none.pfmap")
        empty = posefusion.PoseFusion(self.camera, no_people=True)
        empty.save_map(self.folder / "empty.pfmap")
        with self.assertRaisesRegex(posefusion.Error, "empty map"):
            slam.load_map(self.folder / "empty.pfmap")
        slam.save_map(self.folder / "good.pfmap")
        other = posefusion.PoseFusion(self.camera, no_people=True, scale=0.5)
        with self.assertRaisesRegex(posefusion.Error, "camera"):
            other.load_map(self.folder / "good.pfmap")
        stamp, rgb, depth = self.frames[0]
        self.assertEqual(other.process(rgb, depth, stamp).tracking, "first")  # no harm was done


DAEMON = """
import sys, threading, time
import posefusion
recording = posefusion.Recording(sys.argv[1])
method = posefusion.PoseFusion(recording.camera, no_people=True)
frames = [recording[i] for i in range(3)]
begun = threading.Event()

def work():
    for later in range(1000000):
        for stamp, rgb, depth in frames:
            begun.set()
            method.process(rgb, depth, stamp + later)

threading.Thread(target=work, daemon=True).start()
begun.wait()
time.sleep(float(sys.argv[2]))
print("the end")
"""

FORK = """
import os, sys
import posefusion
recording = posefusion.Recording(sys.argv[1])
method, detector = posefusion.PoseFusion(recording.camera), posefusion.Detector()
stamp, rgb, depth = recording[0]
method.process(rgb, depth, stamp)
detector.detect(rgb)
sys.stdout.flush()
if os.fork() == 0:
    for call in (lambda: method.process(rgb, depth, stamp + 1), method.trajectory, lambda: detector.detect(rgb)):
        try:
            call()
        except posefusion.Error as error:
            print(error)
    print(posefusion.PoseFusion(recording.camera).process(rgb, depth, stamp).tracking)
    del method
    sys.exit(7)
status = os.wait()[1]
print("child ended with", os.waitstatus_to_exitcode(status))
print(method.process(rgb, depth, stamp + 1).tracking)
"""


LISTENER = """
import sys, threading
import posefusion

def listen():
    print("opens", flush=True)
    live = posefusion.Recording("raw:-")
    print("waits", flush=True)
    for frame in live:
        print("a frame")
    print("the stream has ended")

if sys.argv[1] == "in the main thread":
    listen()
else:
    threading.Thread(target=listen, daemon=True).start()
    threading.Event().wait(1)
    print("the end", flush=True)
"""


class SilentPipe(unittest.TestCase):
    """A pipe whose writing end stays open, as that of a program that hangs; it is an error after 30 s."""

    PATIENCE = 30
    CAMERA = b"{fx: 30, fy: 30, cx: 15, cy: 11, width: 32, height: 24, depth_scale: 1000}"

    def listener(self, where, *, opens):
        process = subprocess.Popen(
            [sys.executable, "-c", LISTENER, where],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
        )
        self.addCleanup(process.kill)
        self.assertEqual(process.stdout.readline(), b"opens\n")
        if opens:
            process.stdin.write(b"posefusion-raw 1\n" + struct.pack("<I", len(self.CAMERA)) + self.CAMERA)
            process.stdin.flush()
            self.assertEqual(process.stdout.readline(), b"waits\n")
        time.sleep(0.3)
        return process

    def seconds_to_end(self, process):
        begin = time.monotonic()
        process.wait(2 * self.PATIENCE)
        took = time.monotonic() - begin
        out, error = process.stdout.read(), process.stderr.read().decode()
        for stream in (process.stdin, process.stdout, process.stderr):
            stream.close()
        return took, out, error

    def test_ctrl_c(self):
        for opens in (False, True):
            process = self.listener("in the main thread", opens=opens)
            process.send_signal(signal.SIGINT)
            took, out, error = self.seconds_to_end(process)
            self.assertEqual(error.splitlines()[-1:], ["KeyboardInterrupt"], error)
            self.assertEqual((process.returncode, out), (-signal.SIGINT, b""))
            self.assertLess(took, self.PATIENCE / 3)

    def test_the_end_does_not_wait_for_a_daemon_thread(self):
        process = self.listener("in a daemon thread", opens=True)
        took, out, error = self.seconds_to_end(process)
        self.assertEqual((process.returncode, error), (0, ""))
        self.assertTrue(out.startswith(b"the end\n"), out)
        self.assertLess(took, self.PATIENCE / 3)


class Processes(Recorded):
    def run_script(self, script, *arguments):
        return subprocess.run(
            [sys.executable, "-c", script, str(self.recording), *map(str, arguments)],
            capture_output=True,
            text=True,
            timeout=120,
        )

    def test_the_end_with_a_daemon_thread_inside_process(self):
        for delay in (0, 0.05, 0.11):
            done = self.run_script(DAEMON, delay)
            self.assertEqual((done.returncode, done.stdout, done.stderr), (0, "the end\n", ""))

    def test_a_forked_child_makes_its_own(self):
        done = self.run_script(FORK)
        refused = [
            f"this {name} was made before the process forked; make one of its own in the child"
            for name in ("PoseFusion", "PoseFusion", "Detector")
        ]
        self.assertEqual(done.stdout.splitlines(), [*refused, "first", "child ended with 7", "ok"], done.stderr)


class Package(unittest.TestCase):
    def test_stubs_say_what_there_is(self):
        folder = pathlib.Path(posefusion.__file__).parent
        self.assertTrue((folder / "py.typed").exists())
        stub = ast.parse((folder / "__init__.pyi").read_text())
        classes = {node.name: node for node in stub.body if isinstance(node, ast.ClassDef)}
        functions = {node.name for node in stub.body if isinstance(node, ast.FunctionDef)}
        self.assertEqual({*classes, *functions, "__version__"}, set(posefusion.__all__))
        for name, node in classes.items():
            if name == "Error":
                continue
            described = {f.name: [a.arg for a in f.args.args] for f in node.body if isinstance(f, ast.FunctionDef)}
            there = {m for m in vars(getattr(posefusion, name)) if not m.startswith("_")}
            self.assertEqual({m for m in described if not m.startswith("_")}, there, name)
            for method, arguments in described.items():
                documentation = getattr(getattr(posefusion, name), method).__doc__ or ""
                for argument in arguments[1:]:
                    self.assertIn(f"{argument}:", documentation, f"{name}.{method}")

    def test_example(self):
        example = SOURCE / "docs/examples/python/example.py"
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([sys.executable, example], cwd=folder, capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertRegex(done.stdout, r"ok camera at \[ ?0\.2[12]")  # 7 steps of 2 px at 2 m: 0.215 m
            self.assertEqual(len(np.loadtxt(pathlib.Path(folder) / "trajectory.txt")), 8)

    def test_version(self):
        self.assertEqual(f"posefusion {posefusion.__version__}", run("--version").splitlines()[0])


if __name__ == "__main__":
    unittest.main()
