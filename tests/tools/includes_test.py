"""Arrows go one way: no file includes what lies above it, or a library that is none of its business.

usage: includes_test.py [unittest options]
"""
import re
import sys
import tempfile
import unittest
from pathlib import Path

sys.dont_write_bytecode = True
SOURCE = Path(__file__).resolve().parents[2]

# Folder -> the folders it stands on. It may include their headers, those of all that they stand on, and its own.
STANDS_ON = {
    "shaders/include": [],  # what C++ and GLSL share
    "engine/core": [],
    "engine/vulkan": ["engine/core", "shaders/include"],
    "engine/preprocess": ["engine/vulkan"],
    "engine/tracking": ["engine/preprocess"],
    "engine/map": ["engine/tracking"],
    "engine/loops": ["engine/map"],
    "engine/slam": ["engine/loops"],
    "engine/objects": ["engine/slam"],
    "pose": ["engine/core"],
    "segmentation": ["engine/core", "pose"],
    "hosts/io": ["engine/slam", "segmentation"],
    "hosts/features": ["engine/tracking"],
    "hosts/adjust": ["hosts/io", "hosts/features"],
    "hosts/config": ["hosts/io", "hosts/features"],
    "hosts/evaluate": ["hosts/io"],
    "hosts/mesh": ["hosts/io"],
    "hosts/synth": ["hosts/mesh"],
    "hosts/pipeline": ["hosts/config", "engine/objects"],
    "hosts/report": ["hosts/evaluate", "hosts/pipeline"],
    "hosts/run": ["hosts/report", "hosts/mesh", "hosts/synth", "hosts/adjust"],
    "hosts/export": ["hosts/run"],
    "hosts/texture": ["hosts/mesh", "hosts/export"],
    "hosts/web": ["hosts/run"],
    "hosts/viewer": ["hosts/run"],
    "hosts/cli": ["hosts/viewer", "hosts/texture", "hosts/web"],
    "hosts/library": ["hosts/pipeline", "hosts/evaluate"],
    "hosts/python": ["hosts/library"],
    "hosts/package": [],  # of the wheel: stand-ins for libraries of others
}

# Library, as its headers are named -> the folders that may know it. Others (Eigen, the standard's) are everybody's.
KNOWN_TO = {
    "opencv2/": ["pose", "segmentation", "hosts"],
    "onnxruntime": ["pose"],
    "pcl/": ["segmentation", "hosts/mesh"],
    "embree": ["hosts/synth"],
    "libav": ["hosts/io"],
    "libswscale": ["hosts/io"],
    "meshoptimizer": ["hosts/mesh"],
    "stb/": ["hosts/texture", "hosts/package"],
    "vulkan/": ["engine/vulkan", "hosts/viewer"],
    "shaders/viewer_": ["hosts/viewer"],  # SPIR-V that CMake makes of shaders/viewer
    "glm/": ["engine/vulkan", "hosts/viewer"],
    "GLFW/": ["hosts/viewer"],
    "imgui": ["hosts/viewer"],
    "CLI/": ["hosts/cli"],
    "yaml-cpp/": ["hosts"],
    "nlohmann/": ["hosts"],
    "fmt/": ["hosts"],
    "pybind11/": ["hosts/python"],
    "png.h": ["hosts/package"],
    "jpeglib.h": ["hosts/package"],
    "webp/": ["hosts/package"],
}

# In engine, pose and segmentation any other library needs a row of its own above.
CORE = ("engine", "pose", "segmentation")
WITHOUT_A_ROW = re.compile(r"Eigen/|sys/|unistd\.h$|dlfcn\.h$|link\.h$|[a-z_0-9]+$")  # and the standard library

INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^">]+)[">]', re.MULTILINE)


def folder_of(path, folders):
    """The row of the table that a file belongs to, or None."""
    return next((folder for folder in folders if path.startswith(folder + "/")), None)


def below(folder):
    """All that a folder stands on, itself included."""
    return {folder}.union(*(below(lower) for lower in STANDS_ON[folder]))


def faults_of(path, text):
    """What is wrong with the includes of a file. @param path  relative to the source folder"""
    home = folder_of(path, STANDS_ON)
    if home is None:
        return [f"{path}: its folder has no place in the table of {Path(__file__).name}"]
    faults = []
    for line in text.splitlines():
        for bracket, name in INCLUDE.findall(line):
            library = next((prefix for prefix in KNOWN_TO if name.startswith(prefix)), None)
            if library is not None and not folder_of(path, KNOWN_TO[library]):
                faults.append(f"{path}: <{name}> belongs to {', '.join(KNOWN_TO[library])} only")
            unknown = bracket == "<" and library is None and not WITHOUT_A_ROW.match(name)
            if unknown and path.split("/")[0] in CORE:
                faults.append(f"{path}: <{name}> is of a library without a row in {Path(__file__).name}")
            target = folder_of(name, STANDS_ON)
            if target is not None and target not in below(home):
                faults.append(f"{path}: \"{name}\" lies above {home} or beside it")
            if target is None and bracket == '"' and library is None:
                faults.append(f"{path}: \"{name}\" is not named from the source folder on")
    return faults


def faults_in(source):
    files = sorted(
        file for top in ("engine", "pose", "segmentation", "hosts") for file in (source / top).rglob("*.[ch]pp")
    )
    return [fault for file in files for fault in faults_of(str(file.relative_to(source)), file.read_text())]


class Includes(unittest.TestCase):
    def test_none_goes_up(self):
        faults = faults_in(SOURCE)
        self.assertEqual(faults, [], "\n" + "\n".join(faults))

    def test_the_table_names_folders_that_are_there(self):
        known = [folder for folders in KNOWN_TO.values() for folder in folders]
        for folder in [*STANDS_ON, *known]:
            self.assertTrue((SOURCE / folder).is_dir(), folder)

    def test_a_bad_include_is_found(self):
        for path, name in {
            "engine/map/surfel_map.hpp": '"engine/slam/slam.hpp"',
            "engine/core/image.hpp": '"engine/vulkan/buffer.hpp"',
            "engine/loops/deformer.hpp": '"hosts/io/ply.hpp"',
            "engine/slam/slam.cpp": "<opencv2/core.hpp>",
            "engine/tracking/tracker.hpp": "<vulkan/vulkan.h>",
            "engine/core/byte_stream.hpp": "<zlib.h>",
            "pose/detector.cpp": '"engine/vulkan/context.hpp"',
            "segmentation/segmenter.hpp": "<onnxruntime_cxx_api.h>",
            "hosts/io/ply.cpp": '"hosts/config/run_config.hpp"',
            "hosts/report/report.cpp": '"hosts/mesh/mesh.hpp"',
            "hosts/viewer/viewer.cpp": '"hosts/cli/commands.hpp"',
            "hosts/evaluate/evaluation.cpp": '"evaluation.hpp"',
            "hosts/elsewhere/new.cpp": "<vector>",
        }.items():
            with tempfile.TemporaryDirectory() as folder:
                file = Path(folder) / path
                file.parent.mkdir(parents=True)
                file.write_text(f"#pragma once\n#include <vector>\n  #  include {name}\n")
                faults = faults_in(Path(folder))
                self.assertEqual(len(faults), 1, (path, name))
                self.assertIn(path, faults[0])

    def test_a_good_include_is_none(self):
        for path, name in {
            "engine/map/surfel_map.hpp": '"engine/core/image.hpp"',
            "engine/vulkan/shared_types.hpp": '"shaders/include/shared_types.h"',
            "hosts/cli/main.cpp": '"engine/vulkan/device_info.hpp"',
            "hosts/viewer/scene_renderer.hpp": "<vulkan/vulkan.h>",
            "hosts/python/module.cpp": '"hosts/pipeline/posefusion.hpp"',
            "segmentation/skeleton.hpp": '"pose/joints.hpp"',
        }.items():
            self.assertEqual(faults_of(path, f"#include {name}\n"), [])


if __name__ == "__main__":
    unittest.main()
