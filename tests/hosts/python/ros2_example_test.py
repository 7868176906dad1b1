"""docs/examples/ros2: its conversions without ROS, with what has the fields of the messages; all of it compiles."""
import sys
import unittest
from pathlib import Path
from types import SimpleNamespace
from xml.etree import ElementTree

import numpy as np

sys.dont_write_bytecode = True
EXAMPLE = Path(__file__).resolve().parents[3] / "docs/examples/ros2"
sys.path.insert(0, str(EXAMPLE))
from posefusion_ros import conversions


def image(pixels, encoding, padding=0, big_endian=False):
    height, width = pixels.shape[:2]
    pixels = pixels.astype(pixels.dtype.newbyteorder(">" if big_endian else "<"))
    rows = np.ascontiguousarray(pixels).view(np.uint8).reshape(height, -1)
    data = np.pad(rows, ((0, 0), (0, padding)), constant_values=99).tobytes()
    step = rows.shape[1] + padding
    return SimpleNamespace(
        height=height, width=width, encoding=encoding, step=step, is_bigendian=int(big_endian), data=data
    )


class Conversions(unittest.TestCase):
    def setUp(self):
        self.random = np.random.default_rng(1)

    def test_colour(self):
        rgb = self.random.integers(0, 256, (4, 6, 3), np.uint8)
        alpha = np.full((4, 6, 1), 7, np.uint8)
        for encoding, pixels in (
            ("rgb8", rgb),
            ("bgr8", rgb[:, :, ::-1]),
            ("rgba8", np.concatenate([rgb, alpha], 2)),
            ("bgra8", np.concatenate([rgb[:, :, ::-1], alpha], 2)),
        ):
            for padding in (0, 5):
                np.testing.assert_array_equal(conversions.colour_of(image(pixels, encoding, padding)), rgb, encoding)
        grey = conversions.colour_of(image(rgb[:, :, :1], "mono8"))
        np.testing.assert_array_equal(grey, rgb[:, :, [0, 0, 0]])
        with self.assertRaisesRegex(ValueError, "yuv422"):
            conversions.colour_of(image(rgb, "yuv422"))

    def test_depth(self):
        millimetres = self.random.integers(0, 5000, (4, 6), np.uint16)
        for big_endian in (False, True):
            found = conversions.depth_of(image(millimetres, "16UC1", 3, big_endian))
            np.testing.assert_array_equal(found, millimetres)
            self.assertTrue(found.dtype.isnative)
        metres = np.array([[1.5, np.nan], [np.inf, 0.25]], np.float32)
        np.testing.assert_array_equal(conversions.depth_of(image(metres, "32FC1")), [[1.5, 0], [0, 0.25]])
        with self.assertRaisesRegex(ValueError, "rgb8"):
            conversions.depth_of(image(millimetres, "rgb8"))

    def test_camera(self):
        k = [500.0, 0.0, 319.5, 0.0, 501.0, 239.5, 0.0, 0.0, 1.0]
        info = SimpleNamespace(k=k, d=[0.1, 0.2, 0, 0, 0], width=640, height=480, distortion_model="plumb_bob")
        found = conversions.camera_arguments(info)
        self.assertEqual([found[name] for name in ("fx", "fy", "cx", "cy")], [500.0, 501.0, 319.5, 239.5])
        self.assertEqual(found["distortion"], [0.1, 0.2, 0, 0, 0])
        self.assertEqual(found["depth_scale"], 1000)
        info.distortion_model = "equidistant"
        with self.assertRaisesRegex(ValueError, "rectify"):
            conversions.camera_arguments(info)

    def test_rotations_and_quaternions_belong_together(self):
        for q in [*np.eye(4), *self.random.normal(size=(50, 4))]:
            q = q / np.linalg.norm(q) * (1 if q[3] >= 0 else -1)
            rotation = conversions.rotation_of(*q)
            np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=1e-12)
            found = conversions.quaternion_of(rotation)
            np.testing.assert_allclose(found if found @ q >= 0 else -found, q, atol=1e-12)

    def test_the_map_is_upright(self):
        forward, left, up = (0, 0, 2), (-2, 0, 0), (0, -2, 0)  # of a camera
        for there, expected in ((forward, (2, 0, 0)), (left, (0, 2, 0)), (up, (0, 0, 2))):
            T = np.eye(4)
            T[:3, 3] = there
            np.testing.assert_array_equal(conversions.in_map(T)[:3, 3], expected)
        covariance = np.diag([1.0, 2, 3, 4, 5, 6])  # right, down, forward
        turned = conversions.covariance_in_map(covariance, conversions.in_map(np.eye(4)))
        np.testing.assert_array_equal(turned, np.diag([3.0, 1, 2, 6, 4, 5]))
        surfels = np.zeros(1, [("position", np.float32, 3), ("color", np.uint8, 3)])
        surfels["position"], surfels["color"] = forward, (1, 2, 3)
        cloud = conversions.cloud_of(surfels)
        np.testing.assert_array_equal(cloud["position"][0], (2, 0, 0))
        self.assertEqual(cloud["rgb"][0], 0x010203)
        self.assertEqual(cloud.itemsize, 16)

    def test_transforms(self):
        translation = SimpleNamespace(x=1.0, y=2.0, z=3.0)
        half_turn_about_z = SimpleNamespace(x=0.0, y=0.0, z=1.0, w=0.0)
        T = conversions.transform_of(translation, half_turn_about_z)
        np.testing.assert_allclose(T @ [1, 0, 0, 1], [0, 2, 3, 1], atol=1e-12)
        self.assertEqual(conversions.seconds(SimpleNamespace(sec=2, nanosec=500_000_000)), 2.5)


class Package(unittest.TestCase):
    def test_all_of_it_compiles(self):
        files = sorted(EXAMPLE.rglob("*.py"))
        self.assertGreaterEqual(len(files), 5)
        for file in files:
            compile(file.read_text(), str(file), "exec")

    def test_its_name_is_the_same_everywhere(self):
        name = ElementTree.parse(EXAMPLE / "package.xml").findtext("name")
        self.assertTrue((EXAMPLE / name / "node.py").exists())
        self.assertTrue((EXAMPLE / "resource" / name).exists())
        self.assertIn(f'PACKAGE = "{name}"', (EXAMPLE / "setup.py").read_text())
        self.assertIn(f'package="{name}"', (EXAMPLE / "launch/posefusion.launch.py").read_text())

    def test_what_it_imports_of_ros_is_declared(self):
        declared = {each.text for each in ElementTree.parse(EXAMPLE / "package.xml").iter("exec_depend")}
        lines = (EXAMPLE / "posefusion_ros/node.py").read_text().splitlines()
        modules = {line.split()[1].split(".")[0] for line in lines if line.startswith(("import ", "from "))}
        ours = {"numpy", "posefusion", ""}
        self.assertLessEqual(modules - ours, declared)


if __name__ == "__main__":
    unittest.main()
