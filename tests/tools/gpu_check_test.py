#!/usr/bin/env python3
"""tools/gpu_check: a packed folder agrees with itself on the CPU driver, and says when a device gives something else.

    gpu_check_test.py SOURCE BUILD SCRATCH
"""
import json
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

SOURCE, BUILD, SCRATCH = map(Path, sys.argv[1:4])
FRAMES = 24
LARGEST_MB = 50


def replay(folder):
    command = [folder / "bin/gpu_check", folder, "--device", "llvmpipe", "--widths", "320", "--maps", "0.3"]
    return subprocess.run([str(part) for part in command], capture_output=True, text=True)


class GpuCheck(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = SCRATCH / "folder"
        shutil.rmtree(SCRATCH, ignore_errors=True)
        SCRATCH.mkdir(parents=True)
        options = ["--build", BUILD, "--frames", FRAMES, "--widths", "320"]
        command = [SOURCE / "tools/gpu_check/pack", cls.folder, *options]
        subprocess.run(
            [str(part) for part in command], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )

    def test_the_device_that_it_was_packed_with_agrees_to_the_last_digit(self):
        result = replay(self.folder)
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        self.assertRegex(result.stdout, r"320x240 +camera 0\.0000 mm .*surfels \+0\.00 %, stable \+0\.00 %.*: agrees")
        self.assertRegex(result.stdout, r"  0\.3\d M\n")  # the enlarged map
        for stage in ("preprocess", "track level 0", "fuse", "predict"):
            self.assertRegex(result.stdout, rf"{stage} +\d+\.\d{{3}}")

    def test_another_trajectory_or_map_is_no_agreement(self):
        changes = {
            "poses": lambda json: json["poses"][-1].__setitem__(0, json["poses"][-1][0] + 0.001),
            "surfels": lambda json: json.__setitem__("surfels", json["surfels"] * 2),
        }
        file = self.folder / "expected-320x240.json"
        expected = file.read_text()
        for what, change in changes.items():
            with self.subTest(what):
                wrong = json.loads(expected)
                change(wrong)
                file.write_text(json.dumps(wrong))
                result = replay(self.folder)
                file.write_text(expected)
                self.assertEqual(result.returncode, 1)
                self.assertIn("DIFFERS", result.stdout)

    def test_a_damaged_folder_is_named(self):
        image = next((self.folder / "recording/depth").iterdir())
        content = image.read_bytes()
        image.write_bytes(content[: len(content) // 2])
        result = replay(self.folder)
        image.write_bytes(content)
        self.assertEqual(result.returncode, 1)
        self.assertIn(image.name, result.stderr)
        self.assertEqual(len(result.stderr.splitlines()), 1)

    def test_it_needs_nothing_but_the_c_library_and_the_vulkan_loader(self):
        for program in (self.folder / "bin").iterdir():
            output = subprocess.run(["ldd", program], capture_output=True, text=True, check=True).stdout
            names = {line.split()[0].split(".so")[0].split("/")[-1] for line in output.splitlines()}
            self.assertLessEqual(names, {"linux-vdso", "libvulkan", "libm", "libc", "ld-linux-x86-64"}, program.name)

    def test_with_100_frames_it_stays_below_50_mb(self):
        sizes = {file: file.stat().st_size for file in self.folder.rglob("*") if file.is_file()}
        frames = sum(size for file, size in sizes.items() if "recording" in file.parts)
        self.assertLess(sum(sizes.values()) - frames + frames * 100 / FRAMES, LARGEST_MB * 1e6)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
