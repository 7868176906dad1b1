#!/usr/bin/env python3
"""`posefusion export --nerfstudio` and `--colmap` of a run whose poses and map are exact, read back by readers written
down once more from the definitions of the formats, and by COLMAP where it is installed.
Usage: data_sets_test.py PROGRAM FULL_DISK_LIBRARY
"""
import json
import os
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

import numpy as np
from png_file import read_png

PROGRAM, FULL_DISK = sys.argv.pop(1), sys.argv.pop(1)
FRAMES, WIDTH, HEIGHT = 12, 160, 120
LENS = {"k1": -0.12, "k2": 0.03, "p1": 0.002, "p2": -0.001}
MARGIN = 1  # of masks: 4 pixels at a width of 640


def execute(*arguments, environment=None):
    command = [PROGRAM, *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, env=dict(os.environ, **(environment or {})))


def rotation_of(w, x, y, z):
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def read_tum(file):
    """{stamp: 4x4 camera to world}"""
    poses = {}
    for line in file.read_text().splitlines():
        if not line.startswith("#"):
            stamp, *numbers = line.split()
            x, y, z, qx, qy, qz, qw = map(float, numbers)
            poses[stamp] = np.eye(4)
            poses[stamp][:3, :3], poses[stamp][:3, 3] = rotation_of(qw, qx, qy, qz), (x, y, z)
    return poses


def read_camera(file):
    lines = (line.split("#")[0].split(":") for line in file.read_text().splitlines())
    return {parts[0].strip(): float(parts[1]) for parts in lines if len(parts) == 2}


def bent(x, y, lens):
    """OpenCV's rational model"""
    k1, k2, p1, p2, k3, k4, k5, k6 = (lens.get(name, 0.0) for name in ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"))
    r2 = x * x + y * y
    radial = (1 + r2 * (k1 + r2 * (k2 + r2 * k3))) / (1 + r2 * (k4 + r2 * (k5 + r2 * k6)))
    return (
        x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
        y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y,
    )


def straightened(x, y, lens):
    ideal_x, ideal_y = x, y
    for _ in range(50):
        again_x, again_y = bent(ideal_x, ideal_y, lens)
        ideal_x, ideal_y = ideal_x + x - again_x, ideal_y + y - again_y
    return ideal_x, ideal_y


def write_map(file, points, colors, normals):
    names = [*"xyz", "nx", "ny", "nz", "red", "green", "blue", "radius", "confidence", "created", "last_seen"]
    kinds = ["<f4"] * 6 + ["u1"] * 3 + ["<f4"] * 2 + ["<u4"] * 2
    ply = {"<f4": "float", "u1": "uchar", "<u4": "uint"}
    vertices = np.zeros(len(points), list(zip(names, kinds)))
    for i in range(3):
        vertices[names[i]], vertices[names[3 + i]] = points[:, i], normals[:, i]
        vertices[names[6 + i]] = colors[:, i]
    vertices["radius"], vertices["confidence"] = 0.005, 20
    header = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n"
    header += "".join(f"property {ply[kind]} {name}\n" for name, kind in zip(names, kinds)) + "end_header\n"
    file.write_bytes(header.encode() + vertices.tobytes())


def read_points(file):
    """Positions and colours of a binary PLY of one element."""
    header, body = file.read_bytes().split(b"end_header\n", 1)
    kinds = {"float": "<f4", "uchar": "u1", "uint": "<u4"}
    properties = [line.split()[1:] for line in header.decode().splitlines() if line.startswith("property")]
    vertices = np.frombuffer(body, [(name, kinds[kind]) for kind, name in properties])
    return np.stack([vertices[n] for n in "xyz"], 1), np.stack([vertices[n] for n in ("red", "green", "blue")], 1)


class Reader:
    def __init__(self, file):
        self.bytes, self.at = file.read_bytes(), 0

    def take(self, kinds):
        values = struct.unpack_from("<" + kinds, self.bytes, self.at)
        self.at += struct.calcsize("<" + kinds)
        return values if len(kinds) > 1 else values[0]

    def text(self):
        end = self.bytes.index(b"\0", self.at)
        text, self.at = self.bytes[self.at : end].decode(), end + 1
        return text


CAMERA_MODELS = {1: ("PINHOLE", 4), 4: ("OPENCV", 8), 6: ("FULL_OPENCV", 12)}


def read_binary_model(folder):
    """Cameras, images and points as https://colmap.github.io/format.html has them."""
    cameras, images, points = {}, {}, {}
    file = Reader(folder / "cameras.bin")
    for _ in range(file.take("Q")):
        number, model, width, height = file.take("IiQQ")
        name, count = CAMERA_MODELS[model]
        cameras[number] = (name, width, height, file.take(f"{count}d"))
    assert file.at == len(file.bytes)
    file = Reader(folder / "images.bin")
    for _ in range(file.take("Q")):
        number, *pose, camera = file.take("I7dI")
        name = file.text()
        seen = [file.take("ddQ") for _ in range(file.take("Q"))]
        images[number] = (tuple(pose), camera, name, seen)
    assert file.at == len(file.bytes)
    file = Reader(folder / "points3D.bin")
    for _ in range(file.take("Q")):
        number, x, y, z, r, g, b, error = file.take("QdddBBBd")
        track = [file.take("II") for _ in range(file.take("Q"))]
        points[number] = ((x, y, z), (r, g, b), error, track)
    assert file.at == len(file.bytes)
    return cameras, images, points


def read_text_model(folder):
    def lines(name):
        return [line for line in (folder / name).read_text().split("\n") if not line.startswith("#")][:-1]

    cameras, images, points = {}, {}, {}
    for line in lines("cameras.txt"):
        number, name, width, height, *parameters = line.split()
        cameras[int(number)] = (name, int(width), int(height), tuple(map(float, parameters)))
    rows = lines("images.txt")
    for line, seen in zip(rows[::2], rows[1::2]):
        number, *pose, camera, name = line.split()
        seen = seen.split()
        triples = [(float(x), float(y), int(p)) for x, y, p in zip(seen[::3], seen[1::3], seen[2::3])]
        images[int(number)] = (tuple(map(float, pose)), int(camera), name, triples)
    for line in lines("points3D.txt"):
        number, x, y, z, r, g, b, error, *track = line.split()
        track = list(map(int, track))
        points[int(number)] = (
            (float(x), float(y), float(z)),
            (int(r), int(g), int(b)),
            float(error),
            list(zip(track[::2], track[1::2])),
        )
    return cameras, images, points


class Run:
    """A folder as `posefusion run` leaves it, of a recording with ground truth, which takes the place of what was
    found; the map is what two of the frames show."""

    def __init__(self, folder, recording, lens=None, masks=True):
        self.folder, self.recording, self.lens = folder, recording, lens or {}
        folder.mkdir(parents=True)
        self.camera = read_camera(recording / "camera.yaml")
        config = f"save_masks: {str(masks).lower()}\n"
        if lens:
            camera = folder / "lens.yaml"
            camera.write_text("".join(f"{k}: {v}\n" for k, v in {**self.camera, **lens}.items()))
            config += f'camera: "{camera}"\n'
        (folder / "config.yaml").write_text(config)
        (folder / "stats.json").write_text(json.dumps({"recording": {"folder": str(recording)}}))
        self.poses = read_tum(recording / "groundtruth.txt")
        self.stamps = [line.split()[0] for line in (recording / "associations.txt").read_text().splitlines()]
        shutil.copy(recording / "groundtruth.txt", folder / "trajectory.txt")
        self.write_map()
        if masks:
            self.write_masks()

    def depth(self, stamp):
        return read_png(self.recording / "depth" / f"{stamp}.png") / self.camera["depth_scale"]

    def color(self, stamp):
        return read_png(self.recording / "rgb" / f"{stamp}.png")

    def write_map(self):
        v, u = np.mgrid[2 : HEIGHT - 2 : 2, 2 : WIDTH - 2 : 2]
        points, colors, normals = [], [], []
        for stamp in (self.stamps[0], self.stamps[-1]):
            z, pose = self.depth(stamp)[v, u], self.poses[stamp]
            x, y = straightened(
                (u - self.camera["cx"]) / self.camera["fx"], (v - self.camera["cy"]) / self.camera["fy"], self.lens
            )
            seen = np.stack([x * z, y * z, z], -1)[z > 0]
            points.append(seen @ pose[:3, :3].T + pose[:3, 3])
            colors.append(self.color(stamp)[v, u][z > 0])
            to_eye = -seen / np.linalg.norm(seen, axis=1, keepdims=True)
            normals.append(to_eye @ pose[:3, :3].T)
        write_map(self.folder / "map.ply", *(np.concatenate(part) for part in (points, colors, normals)))

    def write_masks(self):
        """As files that `run --masks` would read, too: somebody covers a rectangle."""
        (self.folder / "masks").mkdir()
        mask = np.zeros((HEIGHT, WIDTH), np.uint8)
        mask[40:80, 50:90] = 1
        for stamp in self.stamps:
            rows = b"".join(b"\0" + row.tobytes() for row in mask)
            write_png(self.folder / "masks" / f"{stamp}.png", rows, 8)


def write_png(file, rows, bits):
    import zlib

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", WIDTH, HEIGHT, bits, 0, 0, 0, 0)
    file.write_bytes(
        b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")
    )


class DataSets(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temp = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.temp.name)
        cls.recording = cls.folder / "recording"
        size = ("--frames", FRAMES, "--width", WIDTH, "--height", HEIGHT)
        for arguments in (
            ("synth", "--out", cls.folder / "jpeg", *size, "--static", "--no-noise"),
            ("record", cls.folder / "jpeg", "--out", cls.recording),  # colour as PNG
        ):
            result = execute(*arguments)
            assert result.returncode == 0, result.stderr

    @classmethod
    def tearDownClass(cls):
        cls.temp.cleanup()

    def setUp(self):
        self.place = self.folder / self.id().split(".")[-1]

    def run_of(self, **options):
        return Run(self.place / "run", self.recording, **options)

    def export(self, run, *options):
        """Every frame that moved at all."""
        return execute("export", run.folder, "--view-distance", "0.001", *options)

    def exported(self, run, *options):
        result = self.export(run, *options)
        self.assertEqual(result.returncode, 0, result.stderr)
        return result

    def expect_error(self, result, *words, code=1):
        self.assertEqual(result.returncode, code, result.stderr)
        lines = [line for line in result.stderr.splitlines() if line.startswith("posefusion: ")]
        errors = [line for line in lines if not line.startswith("posefusion: warning: ")]
        self.assertEqual(len(errors), 1, result.stderr)
        for word in words:
            self.assertIn(word, errors[0])

    def expect_projections(self, pixels, depths, view_depth, view_color, colors, exact):
        """Where points that are in front of a camera are seen, the depth image has their depth and the image their
        colour. exact: half of the map was made of this view, so that these points come back to their pixels."""
        u, v = np.rint(pixels).astype(int).T
        inside = (depths > 0.1) & (u >= 0) & (v >= 0) & (u < view_depth.shape[1]) & (v < view_depth.shape[0])
        pixels, depths, colors, u, v = pixels[inside], depths[inside], colors[inside], u[inside], v[inside]
        measured = view_depth[v, u]
        known = measured > 0
        self.assertGreater(np.count_nonzero(known), 500)
        differences = np.abs(measured - depths)
        color_differences = np.abs(view_color[v, u].astype(int) - colors).max(axis=1)
        self.assertLess(np.median(differences[known]), 0.005)
        self.assertGreater(np.mean(differences[known] < 0.02), 0.75)
        self.assertLess(np.median(color_differences[known]), 12)
        if exact:
            at_home = known & (np.abs(pixels - np.stack([u, v], 1)).max(axis=1) < 0.02)
            self.assertGreater(np.count_nonzero(at_home), 0.4 * np.count_nonzero(known))
            self.assertGreater(np.mean(differences[at_home] < 0.001), 0.95)
            self.assertGreater(np.mean(color_differences[at_home] == 0), 0.95)

    def check_nerfstudio(self, run, data, lens, same_images=True):
        transforms = json.loads((data / "transforms.json").read_text())
        self.assertEqual(transforms["camera_model"], "OPENCV")
        self.assertEqual((transforms["w"], transforms["h"]), (WIDTH, HEIGHT))
        self.assertAlmostEqual(transforms["fl_x"], run.camera["fx"], 4)
        self.assertAlmostEqual(transforms["cx"], run.camera["cx"] + 0.5, 4)
        self.assertAlmostEqual(transforms["cy"], run.camera["cy"] + 0.5, 4)
        for name in ("k1", "k2", "k3", "p1", "p2"):
            self.assertAlmostEqual(transforms[name], lens.get(name, 0), 6)
        points, colors = read_points(data / transforms["ply_file_path"])
        self.assertGreater(len(points), 1000)
        frames = transforms["frames"]
        self.assertEqual(len(frames), FRAMES)
        self.assertEqual(frames, sorted(frames, key=lambda frame: frame["file_path"]))
        for frame in frames:
            stamp = Path(frame["file_path"]).stem
            camera_to_world = np.array(frame["transform_matrix"]) @ np.diag([1, -1, -1, 1])  # OpenGL to OpenCV
            np.testing.assert_allclose(camera_to_world, run.poses[stamp], atol=1e-7)
            color, depth = read_png(data / frame["file_path"]), read_png(data / frame["depth_file_path"])
            self.assertEqual(depth.dtype, np.uint16)
            metres = depth * transforms["depth_unit_scale_factor"]
            if same_images:
                np.testing.assert_array_equal(color, run.color(stamp))
                kept = depth > 0
                self.assertLessEqual(np.abs(metres - run.depth(stamp))[kept].max(), 0.00051)
            if "mask_path" in frame:
                mask = read_png(data / frame["mask_path"])
                self.assertEqual(set(np.unique(mask)), {0, 255})
                self.assertFalse(depth[mask == 0].any(), "depth of people")
                if same_images:
                    expected = np.full((HEIGHT, WIDTH), 255, np.uint8)
                    expected[40 - MARGIN : 80 + MARGIN, 50 - MARGIN : 90 + MARGIN] = 0
                    np.testing.assert_array_equal(mask, expected)
            # as nerfstudio projects: the camera looks along -z, y is up, pixel centres are at halves
            local = (points - np.array(frame["transform_matrix"])[:3, 3]) @ np.array(frame["transform_matrix"])[:3, :3]
            x, y = bent(local[:, 0] / -local[:, 2], -local[:, 1] / -local[:, 2], lens)
            pixels = np.stack([x * transforms["fl_x"] + transforms["cx"], y * transforms["fl_y"] + transforms["cy"]], 1)
            exact = same_images and stamp == run.stamps[0]
            self.expect_projections(pixels - 0.5, -local[:, 2], metres, color, colors, exact)
        return transforms

    def check_colmap(self, run, data, lens):
        model = read_binary_model(data / "sparse/0")
        cameras, images, points = model
        self.check_same_model(model, read_text_model(data / "sparse/0"))
        ((name, width, height, parameters),) = cameras.values()
        self.assertEqual((width, height), (WIDTH, HEIGHT))
        fx, fy, cx, cy = parameters[:4]
        names = ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6")[: len(parameters) - 4]
        written = dict(zip(names, parameters[4:]))
        for key in ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"):
            self.assertAlmostEqual(written.get(key, 0), lens.get(key, 0), 6)
        self.assertEqual(len(images), FRAMES)
        tracked = 0
        for number, (pose, camera, file, seen) in images.items():
            self.assertIn(camera, cameras)
            rotation, translation = rotation_of(*pose[:4]), np.array(pose[4:])
            expected = np.linalg.inv(run.poses[Path(file).stem])
            np.testing.assert_allclose(rotation, expected[:3, :3], atol=1e-7)
            np.testing.assert_allclose(translation, expected[:3, 3], atol=1e-7)
            color, mask = read_png(data / "images" / file), read_png(data / "masks" / f"{file}.png")
            np.testing.assert_array_equal(color, run.color(Path(file).stem))
            self.assertGreater(len(seen), 100)
            for place, (u, v, point) in enumerate(seen):
                position, point_color, error, track = points[point]
                self.assertIn((number, place), track)
                x, y, z = rotation @ position + translation
                self.assertGreater(z, 0)
                x, y = bent(x / z, y / z, lens)
                self.assertLess(np.hypot(x * fx + cx - u, y * fy + cy - v), 0.01)
                self.assertEqual(mask[int(v), int(u)], 255, "a point on people")
                tracked += 1
        self.assertEqual(tracked, sum(len(track) for *_, track in points.values()))
        all_points = np.array([position for position, *_ in points.values()])
        for number, (pose, _, file, _) in images.items():
            local = all_points @ rotation_of(*pose[:4]).T + pose[4:]
            x, y = bent(local[:, 0] / local[:, 2], local[:, 1] / local[:, 2], lens)
            pixels = np.stack([x * fx + cx, y * fy + cy], 1) - 0.5
            stamp = Path(file).stem
            colors = np.array([c for _, c, *_ in points.values()])
            exact = stamp == run.stamps[0]
            self.expect_projections(pixels, local[:, 2], run.depth(stamp), run.color(stamp), colors, exact)
        return name

    def check_same_model(self, a, b):
        self.assertEqual(a[0].keys(), b[0].keys())
        for number, (name, width, height, parameters) in a[0].items():
            self.assertEqual((name, width, height), b[0][number][:3])
            np.testing.assert_allclose(parameters, b[0][number][3], rtol=1e-6, atol=1e-9)
        self.assertEqual(a[1].keys(), b[1].keys())
        for number, (pose, camera, name, seen) in a[1].items():
            np.testing.assert_allclose(pose, b[1][number][0], rtol=1e-6, atol=1e-9)
            self.assertEqual((camera, name), b[1][number][1:3])
            np.testing.assert_allclose(seen, b[1][number][3], rtol=1e-6)
        self.assertEqual(a[2].keys(), b[2].keys())
        for number, (position, color, error, track) in a[2].items():
            np.testing.assert_allclose(position, b[2][number][0], rtol=1e-5, atol=1e-6)
            self.assertEqual((color, error, track), b[2][number][1:])

    def test_both_show_the_map_where_it_is_seen(self):
        run = self.run_of()
        result = self.exported(run, "--nerfstudio", self.place / "nerf", "--colmap", self.place / "colmap")
        self.assertIn(f"nerf: {FRAMES} views of {FRAMES} frames", result.stdout)
        self.assertNotIn("warning", result.stderr)
        transforms = self.check_nerfstudio(run, self.place / "nerf", {})
        self.assertTrue(all("mask_path" in frame for frame in transforms["frames"]))
        self.assertEqual(self.check_colmap(run, self.place / "colmap", {}), "PINHOLE")
        self.assertEqual({entry.name for entry in self.place.iterdir()}, {"run", "nerf", "colmap"})

    def test_a_lens_is_described(self):
        run = self.run_of(lens=LENS)
        self.exported(run, "--nerfstudio", self.place / "nerf", "--colmap", self.place / "colmap")
        self.check_nerfstudio(run, self.place / "nerf", LENS)
        self.assertEqual(self.check_colmap(run, self.place / "colmap", LENS), "OPENCV")

    def test_a_rational_lens_is_described_to_colmap_and_undone_for_nerfstudio(self):
        lens = {**LENS, "k3": 0.002, "k4": -0.01}
        run = self.run_of(lens=lens)
        self.exported(run, "--colmap", self.place / "colmap")
        self.assertEqual(self.check_colmap(run, self.place / "colmap", lens), "FULL_OPENCV")
        result = self.exported(run, "--nerfstudio", self.place / "nerf")
        self.assertIn("undistorted", result.stderr)
        self.check_nerfstudio(run, self.place / "nerf", {}, same_images=False)

    def test_the_lens_is_undone_on_request(self):
        run = self.run_of(lens=LENS)
        self.exported(run, "--undistort", "--nerfstudio", self.place / "nerf", "--colmap", self.place / "colmap")
        self.check_nerfstudio(run, self.place / "nerf", {}, same_images=False)
        self.assertIn("PINHOLE", (self.place / "colmap/sparse/0/cameras.txt").read_text())

    def test_views_are_chosen_and_points_limited(self):
        run = self.run_of()
        self.exported(run, "--nerfstudio", self.place / "nerf", "--view-angle", "1e6", "--points", "300")
        all_views = json.loads((self.place / "nerf/transforms.json").read_text())["frames"]
        points, _ = read_points(self.place / "nerf/points.ply")
        self.assertLessEqual(len(points), 300)
        self.assertGreater(len(points), 100)
        result = execute("export", run.folder, "--nerfstudio", self.place / "few", "--view-distance", "100")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertGreater(len(all_views), 1)
        self.assertEqual(len(json.loads((self.place / "few/transforms.json").read_text())["frames"]), 1)

    def test_missing_masks_are_said(self):
        run = self.run_of(masks=False)
        result = self.exported(run, "--nerfstudio", self.place / "nerf")
        self.assertIn("--save-masks", result.stderr)
        transforms = self.check_nerfstudio(run, self.place / "nerf", {})
        self.assertFalse(any("mask_path" in frame for frame in transforms["frames"]))
        self.assertFalse((self.place / "nerf/masks").exists())

    def test_frames_that_cannot_be_used_are_left_out(self):
        run = self.run_of()
        spoilt = self.place / "spoilt"
        shutil.copytree(self.recording, spoilt)
        (spoilt / "rgb" / f"{run.stamps[3]}.png").write_bytes(b"no image")
        (run.folder / "masks" / f"{run.stamps[5]}.png").unlink()
        result = self.exported(run, "--recording", spoilt, "--nerfstudio", self.place / "nerf")
        self.assertIn(run.stamps[3], result.stderr)
        self.assertIn("1 frame without a mask", result.stderr)
        frames = json.loads((self.place / "nerf/transforms.json").read_text())["frames"]
        names = {Path(frame["file_path"]).stem for frame in frames}
        self.assertEqual(names, set(run.stamps) - {run.stamps[3], run.stamps[5]})

    def test_a_mesh_is_painted_from_the_views(self):
        run = self.run_of()
        mesh = lambda name, *options: self.export(
            run, "--mesh", self.place / name, "--texture", "--resolution", "0.05", *options
        )
        done = mesh("room.glb")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stdout, r"room\.glb: .*texture of \d+ x \d+ .* from \d+ views?\n")
        file = (self.place / "room.glb").read_bytes()
        gltf = json.loads(file[20 : 20 + struct.unpack_from("<I", file, 12)[0]])
        self.assertIn("TEXCOORD_0", gltf["meshes"][0]["primitives"][0]["attributes"])
        self.assertEqual(gltf["images"][0]["mimeType"], "image/jpeg")
        self.assertEqual(mesh("room.obj", "--texture-size", "256").returncode, 0)
        self.assertEqual(read_png(self.place / "room.png").shape, (256, 256, 3))
        self.expect_error(mesh("room.ply"), "only .obj and .glb", code=2)
        self.expect_error(mesh("room.glb", "--texture-size", "3"), "--texture-size", code=2)
        self.expect_error(execute("export", run.folder / "map.ply", "--mesh", "a.glb", "--texture"), "output folder")

    def test_same_run_same_bytes(self):
        run = self.run_of()
        for name in ("a", "b"):
            self.exported(run, "--nerfstudio", self.place / name / "n", "--colmap", self.place / name / "c")
        files = [file.relative_to(self.place / "a") for file in (self.place / "a").rglob("*") if file.is_file()]
        self.assertGreater(len(files), 5 * FRAMES)
        for file in files:
            self.assertEqual((self.place / "a" / file).read_bytes(), (self.place / "b" / file).read_bytes(), file)

    def test_faults_end_in_one_line_and_leave_nothing(self):
        run, nerf = self.run_of(), self.place / "nerf"
        to_nerf = ("--nerfstudio", nerf)
        self.expect_error(execute("export", run.folder / "map.ply", *to_nerf), "is not the output folder")
        self.expect_error(self.export(run, *to_nerf, "--colmap", nerf), "a folder each", code=2)
        self.expect_error(self.export(run, *to_nerf, "--view-angle", "0"), "angle", code=2)
        self.expect_error(self.export(run, *to_nerf, "--points", "0"), "--points", code=2)
        self.expect_error(self.export(run, *to_nerf, "--recording", self.place / "gone"), "gone")
        other = self.place / "other"
        shutil.copytree(self.recording, other)
        lines = [line.split() for line in (other / "associations.txt").read_text().splitlines()]
        later = "".join(f"{float(a) + 5000:.6f} {b} {float(c) + 5000:.6f} {d}\n" for a, b, c, d in lines)
        (other / "associations.txt").write_text(later)
        self.expect_error(self.export(run, *to_nerf, "--recording", other), "none of the frames")
        full = self.place / "full"
        full.mkdir()
        (full / "file").write_text("precious")
        self.expect_error(self.export(run, "--nerfstudio", full), "full", "not empty")
        self.assertEqual([entry.name for entry in full.iterdir()], ["file"])
        stats = run.folder / "stats.json"
        for text, word in (
            ("{}", "--recording"),
            ("no json", "--recording"),
            ('{"recording": {"folder": "/nowhere"}}', "/nowhere"),
            ('{"recording": {"folder": "openni2:"}}', "camera"),
        ):
            stats.write_text(text)
            self.expect_error(self.export(run, *to_nerf), word)
        (run.folder / "trajectory.txt").write_text("")
        self.expect_error(self.export(run, *to_nerf, "--recording", self.recording), "trajectory.txt")
        self.assertEqual({entry.name for entry in self.place.iterdir()}, {"run", "other", "full"})

    def test_a_full_disk_leaves_nothing(self):
        run, disk = self.run_of(), self.place / "disk"
        disk.mkdir()
        environment = {"LD_PRELOAD": FULL_DISK, "FULL_DISK_FOLDER": str(disk.resolve())}
        environment["FULL_DISK_TOTAL_BYTES"] = "200000"
        for option in ("--nerfstudio", "--colmap"):
            result = execute(
                *("export", run.folder, "--view-distance", "0.001", option, disk / "set"), environment=environment
            )
            self.expect_error(result, "No space left on device")
            self.assertEqual(list(disk.iterdir()), [])

    def test_an_interruption_leaves_nothing(self):
        run = self.run_of()
        longer = self.place / "longer"
        shutil.copytree(self.recording, longer)
        pairs = [line.split() for line in (longer / "associations.txt").read_text().splitlines()]
        poses = (self.recording / "groundtruth.txt").read_text().splitlines()[-1].split()[1:]
        with open(longer / "associations.txt", "w") as lines, open(run.folder / "trajectory.txt", "w") as trajectory:
            for i in range(20000):
                stamp, (_, color, _, depth) = f"{3000 + i / 30:.6f}", pairs[i % len(pairs)]
                lines.write(f"{stamp} {color} {stamp} {depth}\n")
                trajectory.write(f"{stamp} {' '.join(poses)}\n")
        (run.folder / "config.yaml").write_text("no_people: true\nno_motion: true\n")
        command = [PROGRAM, "export", run.folder, "--recording", longer, "--colmap", self.place / "set"]
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
            for line in process.stderr:
                if "choosing views" in line:
                    break
            asked = time.monotonic()
            process.send_signal(signal.SIGINT)
            _, err = process.communicate(timeout=60)
            self.assertLess(time.monotonic() - asked, 10)
        self.assertEqual(process.returncode, 130, err)
        self.assertIn("interrupted", err)
        self.assertEqual({entry.name for entry in self.place.iterdir()}, {"run", "longer"})

    def test_colmap_reads_it(self):
        if not shutil.which("colmap"):
            self.skipTest("colmap is not installed (Debian: apt-get install colmap)")
        run, data = self.run_of(lens=LENS), self.place / "colmap"
        self.exported(run, "--colmap", data)
        display = dict(os.environ, QT_QPA_PLATFORM="offscreen")
        for kind, suffix in (("TXT", "bin"), ("BIN", "txt")):  # what was written as `suffix`, converted to the other
            given, made = self.place / suffix, self.place / f"{suffix}_converted"
            given.mkdir()
            made.mkdir()
            for name in ("cameras", "images", "points3D"):
                shutil.copy(data / "sparse/0" / f"{name}.{suffix}", given)
            paths = ["--input_path", given, "--output_path", made]
            subprocess.run(
                ["colmap", "model_converter", *paths, "--output_type", kind],
                check=True, capture_output=True, env=display,
            )  # fmt: skip
            read = read_text_model if kind == "TXT" else read_binary_model
            self.check_same_model(read_binary_model(data / "sparse/0"), read(made))
            result = subprocess.run(
                ["colmap", "model_analyzer", "--path", given], check=True, capture_output=True, text=True, env=display
            )
            said = result.stdout + result.stderr
            self.assertIn(f"Registered images: {FRAMES}", said)


if __name__ == "__main__":
    unittest.main()
