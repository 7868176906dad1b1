#!/usr/bin/env python3
"""Hundreds of odd and damaged inputs, like those that people report: each gives the right result or one clear line.

usage: odd_inputs_test.py PROGRAM [NAME ...]

Every case states the exit code, what the one error line (or a warning) says, and the number of frames or poses that are
the right answer. NAME runs only the cases whose name contains it and prints what the program said.
"""
import base64
import concurrent.futures
import functools
import json
import math
import os
import random
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import zlib
from pathlib import Path

WIDTH, HEIGHT, FRAMES = 80, 60, 8
CAMERA = {"fx": 66.8, "fy": 66.8, "cx": 39.5, "cy": 29.5, "width": WIDTH, "height": HEIGHT}
TIMEOUT = 60  # seconds that a case may take on a busy machine; longer: it hangs
ENOUGH_CASES = 200


class Case:
    """What is run, and what must come of it."""

    def __init__(self, name, arguments, code=0, says=None, frames=None, check=None):
        self.name = name
        self.arguments = [str(argument) for argument in arguments]
        self.code = code
        self.says = says  # pattern in the error line, or in a warning where there is no error
        self.frames = frames  # frames recorded, or poses written
        self.check = check  # called with what was printed; returns what is wrong, or nothing

    def run(self, program):
        """@return the faults, and what the program said."""
        try:
            done = subprocess.run(
                [program, *self.arguments], capture_output=True, text=True, errors="replace", timeout=TIMEOUT
            )
        except subprocess.TimeoutExpired:
            return ["hangs"], ""
        errors = [line for line in done.stderr.splitlines() if line.startswith("posefusion: ")]
        errors = [line for line in errors if "the driver compiles the shaders" not in line]  # on a slow machine
        warnings = [line for line in errors if line.startswith("posefusion: warning: ")]
        errors = [line for line in errors if line not in warnings]
        faults = []
        if done.returncode != self.code:
            faults.append(f"exit code {done.returncode} instead of {self.code}")
        if len(errors) != (0 if self.code == 0 else 1):
            faults.append(f"{len(errors)} error lines")
        said = errors if self.code != 0 else warnings + done.stdout.splitlines()
        if self.says and not any(re.search(self.says, line) for line in said):
            faults.append(f"does not say '{self.says}'")
        if not self.says and warnings:
            faults.append("warns of what is in order")
        if self.frames is not None:
            counts = re.findall(r"(\d+) frames? (?:of \d|\()?|(\d+) frames? in ", done.stdout)
            counts = [int(a or b) for a, b in counts]
            if counts[:1] != [self.frames]:
                faults.append(f"{counts[:1]} frames instead of {self.frames}")
        if self.check:
            fault = self.check(done.stdout)
            if fault:
                faults.append(fault)
        return faults, "\n".join([*done.stdout.splitlines()[:1], *errors, *warnings[:3]])


# ------------------------------------------------------------------------------------------------------------- images


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def png(width, height, bits, color, rows, compress=True):
    """@param color  0 grey, 2 RGB, 3 palette, 4 grey and alpha, 6 RGBA  @param rows  bytes of the rows, no filter"""
    header = struct.pack(">IIBBBBB", width, height, bits, color, 0, 0, 0)
    palette = chunk(b"PLTE", bytes(range(256)) * 3) if color == 3 else b""
    data = b"".join(b"\0" + row for row in rows)
    pixels = zlib.compress(data) if compress else data
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + palette + chunk(b"IDAT", pixels) + chunk(b"IEND", b"")


@functools.cache
def color_png(width=WIDTH, height=HEIGHT, number=0):
    rows = [
        bytes(value for u in range(width) for value in ((u * 3 + number) % 256, (v * 4) % 256, (u * v + 90) % 256))
        for v in range(height)
    ]
    return png(width, height, 8, 2, rows)


@functools.cache
def depth_png(value=10000, width=WIDTH, height=HEIGHT, slope=20):
    rows = [
        struct.pack(
            f">{width}H", *(min(65535, max(0, value + slope * (u + v) if slope else value)) for u in range(width))
        )
        for v in range(height)
    ]
    return png(width, height, 16, 0, rows)


def pgm(width=WIDTH, height=HEIGHT, most=65535, value=10000):
    pixel = struct.pack(">H", value) if most > 255 else bytes([value & 255])
    return f"P5\n{width} {height}\n{most}\n".encode() + pixel * (width * height)


def ppm(width=WIDTH, height=HEIGHT):
    return f"P6\n# a comment\n{width} {height}\n255\n".encode() + bytes([40, 90, 140]) * (width * height)


def bmp(width=WIDTH, height=HEIGHT):
    size = width * height * 3  # rows of 80 pixels need no padding
    header = struct.pack("<IiiHHIIiiII", 40, width, height, 1, 24, 0, size, 0, 0, 0, 0)
    return b"BM" + struct.pack("<IHHI", 54 + size, 0, 0, 54) + header + bytes([140, 90, 40]) * (width * height)


def tiff(width=WIDTH, height=HEIGHT, bits=16, values=None):
    """Grey, one strip, little-endian; 32 bits: float."""
    code = {16: "H", 32: "f"}[bits]
    data = struct.pack(f"<{width * height}{code}", *(values or [2.0 if bits == 32 else 10000] * (width * height)))
    tags = [
        (256, 3, width),
        (257, 3, height),
        (258, 3, bits),
        (259, 3, 1),
        (262, 3, 1),
        (273, 4, 8),
        (277, 3, 1),
        (278, 3, height),
        (279, 4, len(data)),
        (339, 3, 3 if bits == 32 else 1),
    ]
    entries = b"".join(
        struct.pack("<HHI", tag, kind, 1) + (struct.pack("<HH", value, 0) if kind == 3 else struct.pack("<I", value))
        for tag, kind, value in tags
    )
    return b"II*\0" + struct.pack("<I", 8 + len(data)) + data + struct.pack("<H", len(tags)) + entries + b"\0\0\0\0"


WEBP = base64.b64decode("UklGRiQAAABXRUJQVlA4TBcAAAAvT8AOAAdQraKUsf8BICH8ny9F9D+1AgA=")  # 80x60 of one colour


def exr(width=WIDTH, height=HEIGHT, metres=2.0):
    """OpenEXR: one channel of floats, scan lines, not compressed."""

    def attribute(name, kind, value):
        return name + b"\0" + kind + b"\0" + struct.pack("<I", len(value)) + value

    box = struct.pack("<4i", 0, 0, width - 1, height - 1)
    head = b"".join(
        (
            struct.pack("<II", 20000630, 2),
            attribute(b"channels", b"chlist", b"Y\0" + struct.pack("<IIii", 2, 0, 1, 1) + b"\0"),
            attribute(b"compression", b"compression", b"\0"),
            attribute(b"dataWindow", b"box2i", box),
            attribute(b"displayWindow", b"box2i", box),
            attribute(b"lineOrder", b"lineOrder", b"\0"),
            attribute(b"pixelAspectRatio", b"float", struct.pack("<f", 1)),
            attribute(b"screenWindowCenter", b"v2f", bytes(8)),
            attribute(b"screenWindowWidth", b"float", struct.pack("<f", 1)),
            b"\0",
        )
    )
    row = struct.pack(f"<{width}f", *[metres] * width)
    first = len(head) + 8 * height
    offsets = struct.pack(f"<{height}Q", *(first + v * (8 + len(row)) for v in range(height)))
    return head + offsets + b"".join(struct.pack("<iI", v, len(row)) + row for v in range(height))


def rvl(values):
    """Wilson's RVL: runs of zeros and of differences, in nibbles of which the fourth bit says that more follow."""
    nibbles = []

    def put(number):
        while True:
            low, number = number & 7, number >> 3
            nibbles.append(low | (8 if number else 0))
            if not number:
                return

    i, previous = 0, 0
    while i < len(values):
        for is_zero in (True, False):
            run = i
            while run < len(values) and (values[run] == 0) == is_zero:
                run += 1
            put(run - i)
            if not is_zero:
                for value in values[i:run]:
                    change = value - previous
                    put(2 * change if change >= 0 else -2 * change - 1)
                    previous = value
            i = run
    nibbles += [0] * (-len(nibbles) % 8)
    words = [
        sum(nibble << 4 * (7 - k) for k, nibble in enumerate(nibbles[i : i + 8])) for i in range(0, len(nibbles), 8)
    ]
    return struct.pack(f"<{len(words)}I", *words)


# --------------------------------------------------------------------------------------------------------- recordings


def camera_yaml(**changes):
    values = {**CAMERA, "depth_scale": 5000, **changes}
    return "".join(f"{key}: {value}\n" for key, value in values.items() if value is not None)


def stamp_text(i, start=1305031102.175304):
    return f"{start + i / 30:.6f}"


class Folder:
    """A TUM folder that a case spoils."""

    def __init__(self, path, frames=FRAMES, camera=True, lists=True, color=color_png, depth=depth_png, ending=".png"):
        self.path = path
        self.stamps = [stamp_text(i) for i in range(frames)]
        (path / "rgb").mkdir(parents=True)
        (path / "depth").mkdir()
        for i, stamp in enumerate(self.stamps):
            (path / f"rgb/{stamp}{ending}").write_bytes(color())
            (path / f"depth/{stamp}{ending}").write_bytes(depth())
        if camera:
            (path / "camera.yaml").write_text(camera_yaml())
        if lists:
            self.write_lists()

    def write_lists(self, stamps=None, ending=".png", encoding="utf-8", newline="\n", head="# stamp file\n", sep=" "):
        for kind in ("rgb", "depth"):
            lines = [
                f"{written}{sep}{kind}/{stamp}{ending}" for written, stamp in zip(stamps or self.stamps, self.stamps)
            ]
            (self.path / f"{kind}.txt").write_bytes((head + newline.join(lines) + newline).encode(encoding))
        return self

    def color(self, i):
        return self.path / f"rgb/{self.stamps[i]}.png"

    def depth(self, i):
        return self.path / f"depth/{self.stamps[i]}.png"


def klg(frames=FRAMES, count=None, depth=None, color=None, stamps=None, sizes=None):
    """An ElasticFusion log. @param sizes  what the frames say about the bytes of depth and colour"""
    depth = struct.pack(f"<{WIDTH * HEIGHT}H", *[2000] * (WIDTH * HEIGHT)) if depth is None else depth
    color = bytes([40, 90, 140]) * (WIDTH * HEIGHT) if color is None else color
    data = struct.pack("<i", frames if count is None else count)
    for i in range(frames):
        stamp = (stamps or [1_000_000 + k * 33_333 for k in range(frames)])[i]
        depth_bytes, color_bytes = sizes or (len(depth), len(color))
        data += struct.pack("<qii", stamp, depth_bytes, color_bytes) + depth + color
    return data


class Bag:
    """A ROS 1 bag without an index, as a recording that was cut off leaves it."""

    def __init__(self):
        self.chunk, self.topics = b"", []

    @staticmethod
    def block(data):
        return struct.pack("<I", len(data)) + data

    @classmethod
    def record(cls, fields, data):
        header = b"".join(cls.block(name.encode() + b"=" + value) for name, value in fields.items())
        return cls.block(header) + cls.block(data)

    @classmethod
    def header(cls, time, frame_id="camera"):
        seconds, nanoseconds = time
        return struct.pack("<III", 7, seconds, nanoseconds) + cls.block(frame_id.encode())

    @classmethod
    def image(cls, time, encoding, data, width=WIDTH, height=HEIGHT, frame_id="camera"):
        step = len(data) // height if height else 0
        return (
            cls.header(time, frame_id)
            + struct.pack("<II", height, width)
            + cls.block(encoding.encode())
            + struct.pack("<BI", 0, step)
            + cls.block(data)
        )

    @classmethod
    def camera_info(cls, width=WIDTH, height=HEIGHT, fx=66.8, model="plumb_bob", frame_id="camera", distortion=()):
        K = [fx, 0, width / 2 - 0.5, 0, fx, height / 2 - 0.5, 0, 0, 1]
        return (
            cls.header((1, 0), frame_id)
            + struct.pack("<II", height, width)
            + cls.block(model.encode())
            + struct.pack("<I", len(distortion))
            + struct.pack(f"<{len(distortion)}d", *distortion)
            + struct.pack("<9d", *K)
            + bytes(9 * 8 + 12 * 8 + 25)
        )

    def add(self, topic, kind, time, message):
        if topic not in self.topics:
            self.topics.append(topic)
            number = struct.pack("<I", len(self.topics) - 1)
            fields = {"op": b"\x07", "conn": number, "topic": topic.encode()}
            description = b"".join(
                self.block(name + b"=" + value)
                for name, value in ((b"topic", topic.encode()), (b"type", kind.encode()), (b"md5sum", b"*"))
            )
            self.chunk += self.record(fields, description)
        number = struct.pack("<I", self.topics.index(topic))
        self.chunk += self.record({"op": b"\x02", "conn": number, "time": struct.pack("<II", *time)}, message)

    def add_frames(
        self, color="/camera/rgb/image_color", depth="/camera/depth/image", header=None, count=FRAMES, **kinds
    ):
        """@param header  stamp in the headers of all; the times of recording are right"""
        color_kind, depth_kind = kinds.get("color_kind", "rgb8"), kinds.get("depth_kind", "16UC1")
        info = kinds.get("info", self.camera_info())
        if info:
            self.add(color.rsplit("/", 1)[0] + "/camera_info", "sensor_msgs/CameraInfo", (100, 0), info)
        depth_data = {
            "16UC1": struct.pack("<H", 2000),
            "mono16": struct.pack("<H", 2000),
            "32FC1": struct.pack("<f", 2),
            "8UC1": b"\x20",
        }.get(depth_kind, b"\0\0") * (WIDTH * HEIGHT)
        color_data = {"rgb8": bytes([40, 90, 140]), "mono8": b"\x50"}.get(color_kind, b"\1\2\3") * (WIDTH * HEIGHT)
        for i in range(count):
            time = (100, i * 33_000_000)
            self.add(color, "sensor_msgs/Image", time, self.image(header or time, color_kind, color_data))
            self.add(depth, "sensor_msgs/Image", time, self.image(header or time, depth_kind, depth_data))
        return self

    def bytes(self):
        start = self.record(
            {"op": b"\x03", "index_pos": bytes(8), "conn_count": bytes(4), "chunk_count": struct.pack("<I", 1)},
            b" " * 64,
        )
        fields = {"op": b"\x05", "compression": b"none", "size": struct.pack("<I", len(self.chunk))}
        return b"#ROSBAG V2.0\n" + start + self.record(fields, self.chunk)


# ------------------------------------------------------------------------------------------------------- trajectories


def walk(i):
    """Position and quaternion x y z w of pose i: a curve, looking around."""
    angle = 0.05 * i
    return (math.cos(angle) * 2, math.sin(angle) * 3, 0.02 * i), (0, 0, math.sin(angle / 2), math.cos(angle / 2))


def numbers(values):
    return " ".join(f"{value:.9f}" for value in values)


def tum_lines(count=40, scale=1.0, unit=1.0, start=1305031102.0, digits=6):
    lines = []
    for i in range(count):
        position, q = walk(i)
        lines.append(
            f"{(start + i / 10) * unit:.{digits}f} " + numbers([scale * p for p in position]) + " " + numbers(q)
        )
    return lines


def whole_stamps(count=40, per_second=10**9, start=1305031102):
    lines = []
    for i in range(count):
        position, q = walk(i)
        lines.append(f"{start * per_second + i * per_second // 10} " + numbers(position) + " " + numbers(q))
    return lines


def euroc_lines(count=40, columns=17):
    lines = ["#timestamp [ns],p_x,p_y,p_z,q_w [],q_x [],q_y [],q_z [],v,v,v,b,b,b,b,b,b"] if columns == 17 else []
    for i in range(count):
        position, (x, y, z, w) = walk(i)
        values = [*position, w, x, y, z] + [0.0] * (columns - 8)
        lines.append(f"{1305031102 * 10**9 + i * 10**8}," + ",".join(f"{value:.9f}" for value in values))
    return lines


def kitti_lines(count=40, rows=3):
    lines = []
    for i in range(count):
        (x, y, z), _ = walk(i)
        c, s = math.cos(0.05 * i), math.sin(0.05 * i)
        matrix = [c, -s, 0, x, s, c, 0, y, 0, 0, 1, z, 0, 0, 0, 1]
        lines.append(numbers(matrix[: 4 * rows]))
    return lines


def text(lines, newline="\n"):
    return newline.join(lines) + newline


# -------------------------------------------------------------------------------------------------------------- cases


class Cases:
    def __init__(self, temp, program):
        self.temp, self.program, self.cases, self.made = temp, program, [], 0

    def place(self, name=""):
        self.made += 1
        path = self.temp / f"{self.made:03}{name}"
        return path

    def file(self, name, content):
        path = self.place()
        path.mkdir()
        path = path / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    def add(self, name, arguments, **expected):
        self.cases.append(Case(name, arguments, **expected))

    def record(self, name, source, *more, **expected):
        """Reads a whole recording and writes it again: what `run` reads, without the method."""
        self.add(name, ["record", source, "--out", self.place("-out"), *more], **expected)

    def run_it(self, name, source, *more, **expected):
        self.add(name, ["run", source, "--out", self.place("-out"), "--no-people", "--no-report", *more], **expected)

    def folder(self, **how):
        return Folder(self.place(), **how)

    # ---- the beginning of a recording, and which frames are used

    def beginnings(self):
        def dark(count, frames=FRAMES):
            folder = self.folder(frames=frames)
            for i in range(count):
                folder.color(i).write_bytes(png(WIDTH, HEIGHT, 8, 2, [bytes(WIDTH * 3)] * HEIGHT))
            return folder.path

        for count in (1, 3, 5):
            self.run_it(f"begin: {count} dark frames", dark(count), says="colour image is black", frames=FRAMES - count)
        self.run_it(
            "begin: forty dark frames before the light goes on", dark(40, 44), says="every 100th is shown", frames=4
        )
        self.run_it("begin: all dark", dark(FRAMES), code=1, says=r"no frame of the recording can be used.*black")
        path = self.folder().path
        for start, frames in (("0", 8), ("3", 5), ("7", 1), ("0.1s", 5), ("0s", 8), ("1e-1s", 5)):
            self.record(f"begin: --start {start}", path, "--start", start, frames=frames)
        for start in ("8", "100000", "9s", "1e6s"):
            self.record(f"begin: --start {start}", path, "--start", start, code=1, says=f"--start .*leaves nothing")
        for start in ("-1", "x", "", "1.5", "-2s", "nans", "1e99s", "3 s", "99999999999999999999"):
            self.record(f"begin: --start '{start}'", path, f"--start={start}", code=2, says="--start.*frame.*seconds")
        for every, frames in (("1", 8), ("2", 4), ("3", 3), ("100", 1)):
            self.record(f"begin: --every {every}", path, "--every", every, frames=frames)
        for every in ("0", "-1", "x", "1.5", "1e9"):
            self.record(f"begin: --every {every}", path, "--every", every, code=2, says="--every")
        self.record("begin: --start and --every", path, "--start", "1", "--every", "3", frames=3)
        self.run_it(
            "begin: of a run",
            path,
            *("--start", "2", "--every", "2", "--max-frames", "2"),
            says="stable after so few frames",
            frames=2,
        )
        self.run_it("begin: none of a run", path, "--start", "8", code=1, says="leaves nothing of its 8 frames")
        self.run_it("begin: not a start", path, "--start", "soon", code=2, says="'soon'.*frame")

    # ---- depth in another unit, out of range, of another type; masks of another recording

    def depths(self):
        for scale in ("0.001", "1", "10", "100", "1000000"):
            folder = self.folder()
            (folder.path / "camera.yaml").write_text(camera_yaml(depth_scale=scale))
            self.run_it(f"depth: scale {scale}", folder.path, code=1, says=r"median depth.*depth_scale: 5000.*--camera")
        folder = self.folder(depth=lambda: depth_png(2000, slope=2))
        self.run_it(
            "depth: millimetres in TUM's units", folder.path, says="millimetres.*depth_scale: 1000", frames=FRAMES
        )
        for value in (0, 65535):
            folder = self.folder(depth=lambda: depth_png(value, slope=0))
            self.run_it(f"depth: nothing but {value}", folder.path, code=1, says="no frame.*no measurement")
        for value, what in ((60000, "beyond the range"), (700, "before the range")):
            folder = self.folder(depth=lambda: depth_png(value, slope=0))
            self.run_it(f"depth: all {what}", folder.path, code=1, says=r"no depth between 0\.3 and 5 m.*depth_scale")
        self.run_it(
            "depth: a range that holds it",
            folder.path,
            "--preprocess-depth-min",
            "0.1",
            says="millimetres",
            frames=FRAMES,
        )
        folder = self.folder()
        folder.depth(2).write_bytes(depth_png(60000, slope=0))
        self.run_it("depth: one frame beyond the range", folder.path, says=r"frame skipped.*no depth between", frames=7)
        self.run_it("depth: an empty range", folder.path, "--preprocess-depth-min", "6", code=1, says="depth_min")
        for bits, color, rows, what in (
            (8, 0, [bytes([40]) * WIDTH] * HEIGHT, "8 bits"),
            (8, 2, [bytes([40]) * WIDTH * 3] * HEIGHT, "RGB"),
            (16, 2, [bytes([40]) * WIDTH * 6] * HEIGHT, "RGB of 16 bits"),
            (8, 3, [bytes([40]) * WIDTH] * HEIGHT, "a palette"),
            (1, 0, [bytes([170]) * (WIDTH // 8)] * HEIGHT, "1 bit"),
            (8, 6, [bytes([40]) * WIDTH * 4] * HEIGHT, "RGBA"),
        ):
            folder = self.folder(depth=lambda: png(WIDTH, HEIGHT, bits, color, rows))
            self.record(f"depth: {what}", folder.path, code=1, says="depth/.*(bit|grey)")
        folder = self.folder(frames=12)
        noise = random.Random(1)
        for i in range(12):
            rows = [
                struct.pack(f">{WIDTH}H", *(noise.randrange(2500, 20000) for _ in range(WIDTH))) for _ in range(HEIGHT)
            ]
            folder.depth(i).write_bytes(png(WIDTH, HEIGHT, 16, 0, rows))
        self.run_it("depth: nothing but noise", folder.path, code=1, says="was lost in|map is empty")
        self.add(
            "depth: nothing but noise, bench", ["bench", folder.path, "--no-people"], code=1, says="was lost in|map is"
        )
        folder = self.folder()
        plain = png(WIDTH, HEIGHT, 8, 0, [bytes(WIDTH)] * HEIGHT)
        for name, masks, says in (
            ("an empty folder", {}, "holds no masks"),
            ("of another recording", {"77.0.png": plain}, f"no mask belongs to a frame.*{folder.stamps[0]}.png"),
            ("of another size", {f"{folder.stamps[0]}.png": png(9, 9, 8, 0, [bytes(9)] * 9)}, "9x9, expected 80x60"),
            ("not images", {f"{folder.stamps[0]}.png": b"no image"}, f"{folder.stamps[0]}.png"),
        ):
            path = self.place("-masks")
            path.mkdir()
            for file, content in masks.items():
                (path / file).write_bytes(content)
            self.add(f"masks: {name}", ["run", folder.path, "--out", self.place(), "--masks", path], code=1, says=says)
        self.add(
            "masks: no folder",
            ["run", folder.path, "--out", self.place(), "--masks", folder.path / "none"],
            code=1,
            says="mask folder not found",
        )

    # ---- logs and bags of which parts say something else than is there

    def logs(self):
        for count, says in ((0, "8"), (3, "8"), (100, "8"), (-5, "8"), (2**31 - 1, "8")):
            self.record(f"log: announces {count} of 8", self.log_with_camera(klg(count=count)), frames=8, says=says)
        self.record("log: in order", self.log_with_camera(klg()), frames=8)
        self.record("log: zlib", self.log_with_camera(klg(depth=zlib.compress(bytes(9600)))), frames=8)
        for size in (0, 1, 3, 4, 10, 19, 20, 30, 500):
            self.record(f"log: cut off at byte {size}", self.file("log.klg", klg()[:size]), code=1, says=r"log\.klg")
        for size, frames in ((24028 + 10, 1), (2 * 24016 + 4, 2), (5 * 24016 + 100, 5), (8 * 24016, 7)):
            self.record(f"log: cut off in frame {frames}", self.log_with_camera(klg()[:size]), frames=frames, says="8")
        for sizes in ((-1, 14400), (9600, -1), (2**31 - 1, 14400), (9600, 2**31 - 1), (9599, 14400)):
            self.record(f"log: sizes {sizes}", self.log_with_camera(klg(sizes=sizes)), code=1, says=r"log\.klg")
        self.record(
            "log: depth that is no zlib", self.log_with_camera(klg(depth=b"\x13" * 500)), code=1, says="log.*depth"
        )
        self.record(
            "log: colour that is no JPEG", self.log_with_camera(klg(color=b"\x13" * 500)), code=1, says="log.klg"
        )
        self.record("log: stamps all 0", self.log_with_camera(klg(stamps=[0] * 8)), frames=8, says="stamp")
        self.record(
            "log: stamps fall", self.log_with_camera(klg(stamps=[8 - i for i in range(8)])), frames=8, says="order"
        )
        self.record(
            "log: stamps of -2^63",
            self.log_with_camera(klg(stamps=[-(2**63)] * 8)),
            code=1,
            says="first frame is damaged",
        )
        self.record("log: no camera beside it", self.file("log.klg", klg()), code=1, says="640x480.*camera file")

    def log_with_camera(self, content):
        path = self.file("log.klg", content)
        (path.parent / "log.yaml").write_text(camera_yaml(depth_scale=1000))
        return path

    def bags(self):
        def bag(**how):
            return self.file("a.bag", Bag().add_frames(**how).bytes())

        self.record("bag: in order", bag(), frames=8)
        self.record("bag: stamps all 0", bag(header=(0, 0)), frames=8, says="stamp|times? of recording")
        self.record("bag: stamps all alike", bag(header=(77, 5)), frames=8, says="stamp|times? of recording")
        self.record("bag: float depth", bag(depth_kind="32FC1"), frames=8)
        self.record("bag: mono16 depth", bag(depth_kind="mono16", depth="/camera/depth/image"), frames=8)
        self.record("bag: 8 bit depth", bag(depth_kind="8UC1"), code=1, says="depth")
        self.record("bag: grey colour", bag(color_kind="mono8"), frames=8)
        self.record("bag: unknown colour", bag(color_kind="frog8"), code=1, says="colour|frog8")
        self.record("bag: without camera_info", bag(info=None), code=1, says="camera")
        self.record(
            "bag: fisheye",
            bag(info=Bag.camera_info(model="equidistant", distortion=(0.1,) * 4)),
            code=1,
            says="fisheye|equidistant",
        )
        self.record("bag: not calibrated", bag(info=Bag.camera_info(fx=0)), code=1, says="calibrat|fx|camera")
        self.record("bag: topics named otherwise", bag(color="/arm/eye/image_raw", depth="/arm/z/image_raw"), frames=8)
        self.record(
            "bag: a topic that is not there", bag(), "--color-topic", "/nowhere", code=1, says="/nowhere.*/camera"
        )
        self.record("bag: depth as colour", bag(), "--color-topic", "/camera/depth/image", code=1, says="16UC1|colour")
        self.record("bag: colour alone", self.only_topic("/camera/rgb/image_color", "rgb8", 3), code=1, says="depth")
        self.record("bag: depth alone", self.only_topic("/camera/depth/image", "16UC1", 2), code=1, says="colour")
        content = Bag().add_frames().bytes()
        for size in (0, 5, 13, 60, 120, 300):
            self.record(f"bag: cut off at byte {size}", self.file("a.bag", content[:size]), code=1, says=r"a\.bag")
        self.record(
            "bag: cut off in the chunk", self.file("a.bag", content[: len(content) // 2]), code=1, says=r"a\.bag"
        )
        self.record(
            "bag: version 1.2", self.file("a.bag", content.replace(b"V2.0", b"V1.2", 1)), code=1, says="1\\.2|2\\.0"
        )
        self.record("bag: not one", self.file("a.bag", b"PK\3\4" + bytes(500)), code=1, says=r"a\.bag")
        for at in (40, 130, 200, 260):
            damaged = bytearray(content)
            damaged[at : at + 4] = b"\xff\xff\xff\x7f"
            whole = at < 150  # in the header of the file, of which nothing is needed
            self.record(
                f"bag: a length of 2 GB at {at}",
                self.file("a.bag", bytes(damaged)),
                code=0 if whole else 1,
                frames=8 if whole else None,
                says=None if whole else r"a\.bag",
            )

    def bags_of_cameras(self):
        """What drivers write: patterns of colour, compressed depth, several topics of depth."""
        for kind, pixel in (
            *((f"bayer_{pattern}8", b"\x50") for pattern in ("rggb", "bggr", "gbrg", "grbg")),
            *((kind, b"\x60\x80") for kind in ("yuv422", "yuv422_yuy2", "UYVY", "YUYV", "uyvy", "yuyv")),
            *((kind, b"\1\2\3\4") for kind in ("rgba8", "bgra8")),
            *(("bgr8", b"\1\2\3"), ("8UC3", b"\1\2\3")),
        ):
            bag = Bag()
            bag.add("/c/camera_info", "sensor_msgs/CameraInfo", (100, 0), Bag.camera_info())
            for i in range(FRAMES):
                time = (100, i * 33_000_000)
                pixels = pixel * (WIDTH * HEIGHT)
                bag.add("/c/image_raw", "sensor_msgs/Image", time, Bag.image(time, kind, pixels))
                bag.add(
                    "/d/depth/image", "sensor_msgs/Image", time, Bag.image(time, "16UC1", b"\xd0\7" * (WIDTH * HEIGHT))
                )
            self.record(f"bag: colour in {kind}", self.file("a.bag", bag.bytes()), frames=8)

        millimetres = [2000 + i % 7 if i % 11 else 0 for i in range(WIDTH * HEIGHT)]
        size = struct.pack("<II", WIDTH, HEIGHT)
        whole = {
            "16UC1; compressedDepth png": bytes(12) + depth_png(),
            "16UC1; compressedDepth rvl": bytes(12) + size + rvl(millimetres),
            "32FC1; compressedDepth png": struct.pack("<Iff", 0, 1e4, 1e-3) + depth_png(value=5000, slope=0),
            "32FC1; compressedDepth rvl": struct.pack("<Iff", 0, 1e4, 1e-3) + size + rvl([5000] * (WIDTH * HEIGHT)),
        }
        for kind, data in whole.items():
            self.record(f"bag: {kind}", self.compressed_depth(kind, data), frames=8)
            for cut in (0, 5, 12, 18, len(data) // 2):
                self.record(
                    f"bag: {kind}, {cut} bytes", self.compressed_depth(kind, data[:cut]), code=1, says=r"a\.bag|depth"
                )
        lying = bytes(12) + struct.pack("<II", 2**30, 2**30) + rvl(millimetres)
        self.record(
            "bag: rvl of 2^30 pixels a side",
            self.compressed_depth("16UC1; compressedDepth rvl", lying),
            code=1,
            says="a.bag|depth",
        )
        self.record(
            "bag: depth compressed by a frog", self.compressed_depth("16UC1; frog", bytes(50)), code=1, says="depth"
        )

        for first, second, frames in (("raw", "registered", "rgb"), ("a", "b", "rgb")):
            bag = Bag().add_frames(color="/c/image", depth=f"/{first}/depth")
            for i in range(FRAMES):
                time = (100, i * 33_000_000)
                pixels = struct.pack("<H", 1500) * (WIDTH * HEIGHT)
                bag.add(f"/{second}/depth", "sensor_msgs/Image", time, Bag.image(time, "16UC1", pixels))
            self.record(
                f"bag: two depth topics, {first}, {second}", self.file("a.bag", bag.bytes()), frames=8, says="not from"
            )
        realsense = Bag()
        depth, color = "/device_0/sensor_0/Depth_0", "/device_0/sensor_1/Color_0"
        for stream in (depth, color):
            realsense.add(f"{stream}/info/camera_info", "sensor_msgs/CameraInfo", (100, 0), Bag.camera_info())
        for i in range(FRAMES):
            time = (100, i * 33_000_000)
            for stream, kind, pixel in ((depth, "mono16", b"\xd0\7"), (color, "rgb8", b"\1\2\3")):
                image = Bag.image(time, kind, pixel * (WIDTH * HEIGHT))
                realsense.add(f"{stream}/image/data", "sensor_msgs/Image", time, image)
        self.record("bag: of the RealSense viewer", self.file("a.bag", realsense.bytes()), frames=8)

    def compressed_depth(self, kind, data):
        bag = Bag()
        bag.add("/c/camera_info", "sensor_msgs/CameraInfo", (100, 0), Bag.camera_info())
        for i in range(FRAMES):
            time = (100, i * 33_000_000)
            message = Bag.header(time) + Bag.block(kind.encode()) + Bag.block(data)
            bag.add("/c/image", "sensor_msgs/Image", time, Bag.image(time, "rgb8", b"\1\2\3" * (WIDTH * HEIGHT)))
            bag.add("/d/depth/compressedDepth", "sensor_msgs/CompressedImage", time, message)
        return self.file("a.bag", bag.bytes())

    def only_topic(self, topic, kind, size):
        bag = Bag()
        for i in range(3):
            bag.add(topic, "sensor_msgs/Image", (100, i), Bag.image((100, i), kind, bytes(size * WIDTH * HEIGHT)))
        return self.file("a.bag", bag.bytes())

    # ---- time stamps of any unit, order and kind

    def stamps(self):
        def lists(stamps):
            folder = self.folder(lists=False)
            return folder.write_lists(stamps).path

        base = 1305031102
        for unit, per_second in (("ms", 10**3), ("us", 10**6), ("ns", 10**9)):
            self.record(
                f"stamps: {unit}",
                lists([str(base * per_second + i * per_second // 30) for i in range(8)]),
                frames=8,
                says=f" {unit}",
            )
        self.record("stamps: of a device in ms", lists([str(1000 + 33 * i) for i in range(8)]), frames=8, says=" ms")
        self.record("stamps: forced", lists([str(33 * i) for i in range(8)]), "--time-unit", "ms", frames=8, says="ms")
        self.record("stamps: whole seconds", lists([str(base + i) for i in range(8)]), frames=8)
        self.record("stamps: falling", lists([f"{base + 8 - i}.5" for i in range(8)]), frames=8, says="order")
        self.record(
            "stamps: some twice", lists([f"{base}.{i}" for i in (0, 0, 1, 2, 3, 4, 5, 5)]), frames=6, says="stamp"
        )
        self.record("stamps: all alike", lists(["5.0"] * 8), code=1, says="alike|stamp")
        self.record("stamps: negative", lists([f"-{8 - i}.5" for i in range(8)]), frames=8)
        self.record("stamps: exponents", lists([f"{base + i}e0" for i in range(8)]), frames=8)
        for bad in ("nan", "inf", "1e30", "-1e300", "0x10", "", "12:30:01", "1,5"):
            folder = self.folder()
            lines = (folder.path / "rgb.txt").read_text().splitlines()
            lines[2] = f"{bad} rgb/{folder.stamps[1]}.png"
            (folder.path / "rgb.txt").write_text(text(lines))
            self.record(f"stamps: one is '{bad}'", folder.path, frames=7, says="rgb.txt")
        self.record("stamps: none is one", lists(["now"] * 8), code=1, says="rgb.txt")
        folder = self.folder()
        depth = (folder.path / "depth.txt").read_text().splitlines()
        (folder.path / "depth.txt").write_text(
            text([depth[0], *(f"{i * 33 + 10**12 * 1305}" + line[17:] for i, line in enumerate(depth[1:]))])
        )
        self.record("stamps: depth in another unit", folder.path, code=1, says="depth.txt")
        folder = self.folder()
        later = (folder.path / "depth.txt").read_text().replace("13050311", "13050399")
        (folder.path / "depth.txt").write_text(later.replace("depth/13050399", "depth/13050311"))
        self.record("stamps: an hour apart", folder.path, code=1, says="within 20 ms")
        self.record("stamps: a unit that is none", folder.path, "--time-unit", "min", code=2, says="--time-unit")

    # ---- evaluate: any two files

    def evaluations(self):
        truth = self.file("truth.txt", text(tum_lines()))

        def against(name, estimate, *more, ate=None, truth=truth, estimate_name="estimate.txt", **expected):
            if isinstance(estimate, list):
                estimate = text(estimate)
            path = self.file(estimate_name, estimate)

            def check(output):
                found = json.loads(output)["ate"]["translation_m"]["rmse"]
                return None if abs(found - ate) < 1e-6 else f"ATE {found} instead of {ate}"

            if ate is not None:
                more = (*more, "--json")
                expected["check"] = check
            self.add(f"evaluate: {name}", ["evaluate", truth, path, *more], **expected)

        positions = [walk(i)[0] for i in range(40)]
        middle = [sum(p[k] for p in positions) / 40 for k in range(3)]
        spread = math.sqrt(sum(sum((p[k] - middle[k]) ** 2 for k in range(3)) for p in positions) / 40)

        against("the same", tum_lines(), ate=0)
        against("twice as large", tum_lines(scale=2), ate=spread)
        against("twice as large, scale aligned", tum_lines(scale=2), "--scale", ate=0)
        against("a tenth larger", tum_lines(scale=1.1), ate=0.1 * spread)
        for unit, per_second in (("ms", 10**3), ("us", 10**6), ("ns", 10**9)):
            against(f"stamps in {unit}", whole_stamps(per_second=per_second), ate=0)
        against("EuRoC, 17 columns", euroc_lines(), ate=0, estimate_name="estimate.csv")
        against("ASL, 8 columns", euroc_lines(columns=8), ate=0)
        against("KITTI", kitti_lines(), ate=0)
        against("matrices", kitti_lines(rows=4), ate=0)
        kitti = self.file("kitti.txt", text(kitti_lines()))
        against("KITTI with KITTI", kitti_lines(), truth=kitti, ate=0)
        against("KITTI of another length", kitti_lines(30), code=1, says="30.*40|40.*30")
        for columns in (1, 2, 3, 4, 5, 6, 7, 9, 10, 11, 13, 14, 15, 18, 20):
            lines = [" ".join(["1305031102.5"] + ["0.1"] * (columns - 1))] * 5
            against(
                f"{columns} columns",
                lines,
                code=1,
                says=rf"estimate\.txt, line 1: {columns} numbers are no pose: expected 8",
            )
        lines = tum_lines()
        against("CRLF", text(lines, "\r\n"), ate=0)
        against("commas", [line.replace(" ", ",") for line in lines], ate=0)
        against("tabs", [line.replace(" ", "\t") for line in lines], ate=0)
        against("a byte order mark", b"\xef\xbb\xbf" + text(lines).encode(), ate=0)
        against("UTF-16", text(lines).encode("utf-16"), ate=0)
        against("comments and blank lines", ["# a", "", *lines, "", "# b"], ate=0)
        against("no line end at the end", text(lines)[:-1], ate=0)
        against("semicolons", [line.replace(" ", ";") for line in lines], code=1, says="estimate.txt")
        against("decimal commas", [line.replace(".", ",") for line in lines], code=1, says="estimate.txt")
        against("falling stamps", lines[::-1], ate=0, says="not in order")
        against("each line twice", [line for line in lines for _ in (0, 1)], ate=0, says="40 of its time stamps")
        against(
            "a lost camera",
            [*lines[:5], lines[5].split()[0] + " nan" * 7, *lines[6:]],
            ate=0,
            says="estimate.txt.*(nan|NaN|finite|lost|left out)",
        )
        against("all lost", [line.split()[0] + " nan" * 7 for line in lines], code=1, says="estimate.txt")
        against(
            "a quaternion of 0",
            [*lines[:5], lines[5].split()[0] + " 0" * 7, *lines[6:]],
            code=1,
            says="estimate.txt, line 6",
        )
        against(
            "quaternions not of length 1",
            [" ".join(line.split()[:4]) + " 3 3 3 3" for line in lines],
            code=1,
            says="estimate.txt, line 1",
        )
        against(
            "a position of 1e300",
            [*lines[:5], lines[5].split()[0] + " 1e300 0 0 0 0 0 1", *lines[6:]],
            code=1,
            says="estimate.txt, line 6.*1000000000 m|estimate.txt, line 6.*from the origin",
        )
        against(
            "a word among the numbers",
            [*lines[:5], lines[5].replace("0.0", "zero", 1), *lines[6:]],
            code=1,
            says="estimate.txt, line 6",
        )
        against("one pose", lines[:1], code=1, says="fewer than two|two")
        against("empty", "", code=1, says="estimate.txt")
        against("only comments", "# nothing\n# at all\n", code=1, says="estimate.txt")
        against("binary", bytes(range(256)) * 40, code=1, says="estimate.txt")
        against("a PNG", color_png(), code=1, says="estimate.txt")
        against("an hour later", tum_lines(start=1305034702.0), code=1, says="0 of 40 estimated poses.*same recording")
        against("an hour later, offset given", tum_lines(start=1305034702.0), "--time-offset", "-3600", ate=0)
        against(
            "0.3 s later, offset sought",
            tum_lines(start=1305031102.3),
            "--time-offset",
            "auto",
            "--max-difference",
            "0.05",
            check=lambda out: None if "time offset" in out else "no offset",
        )
        against("no offset", lines, "--time-offset", "soon", code=2, says="--time-offset.*soon")
        against("nan as difference", lines, "--max-difference", "nan", code=2, says="--max-difference.*nan")
        against("a negative delta", lines, "--delta", "-1", code=2, says="--delta")
        against("an alignment that is none", lines, "--align", "sideways", code=2, says="--align.*'sideways'.*rigid")
        against("a picture that is none", lines, "--plot", self.place("-plot.txt"), code=2, says=r"--plot.*\.png")
        self.add("evaluate: a folder", ["evaluate", truth, self.temp], code=1, says="folder|directory|not")
        self.add("evaluate: nothing there", ["evaluate", truth, self.temp / "none.txt"], code=1, says="none.txt")
        self.add("evaluate: no truth there", ["evaluate", self.temp / "none.txt", truth], code=1, says="none.txt")

    # ---- image files of all kinds, whole and not

    def images(self):
        for ending, color, depth in (
            (".ppm", ppm, depth_png),
            (".bmp", bmp, depth_png),
            (".pgm", color_png, pgm),
            (".tif", color_png, tiff),
            (".tiff", color_png, lambda: tiff(bits=32, values=[10000.0] * (WIDTH * HEIGHT))),
        ):
            folder = self.folder(color=color, depth=depth, ending=ending, lists=False)
            folder.write_lists(ending=ending)
            self.record(f"image: {ending} whatever the name", folder.path, frames=8)
        good_color, good_depth = color_png(), depth_png()
        for kind, good in (("rgb", good_color), ("depth", good_depth)):
            for size in (0, 1, 7, 20, 33, 60, len(good) // 2, len(good) - 20):
                folder = self.folder()
                (folder.path / kind / f"{folder.stamps[2]}.png").write_bytes(good[:size])
                self.record(f"image: {kind} cut off at byte {size}", folder.path, frames=7, says=f"{kind}/.*png")
        for what, content in (
            ("of 0 x 0", png(0, 0, 8, 2, [])),
            ("of a billion pixels a side", png(10**9, 10**9, 8, 2, [b""])),
            ("of another size", color_png(40, 30)),
            ("turned by 90 degrees", color_png(HEIGHT, WIDTH)),
            ("of text", b"this is no image\n" * 30),
            ("that is a web page", b"<!DOCTYPE html><html><body>404</body></html>"),
            ("of JPEG's first bytes", b"\xff\xd8\xff\xe0" + bytes(50)),
            ("of GIF", b"GIF89a" + bytes(50)),
            ("without pixels", png(WIDTH, HEIGHT, 8, 2, [])),
            ("not compressed", png(WIDTH, HEIGHT, 8, 2, [bytes(WIDTH * 3)] * HEIGHT, compress=False)),
            ("with a wrong checksum", good_color[:60] + bytes([good_color[60] ^ 255]) + good_color[61:]),
            ("that is a Git LFS pointer", b"version https://git-lfs.github.com/spec/v1\noid sha256:ab\nsize 5\n"),
        ):
            folder = self.folder()
            folder.color(2).write_bytes(content)
            self.record(f"image: {what}", folder.path, frames=7, says=r"frame skipped.*rgb/.*png")
        folder = self.folder()
        folder.color(2).unlink()
        folder.color(2).mkdir()
        self.record("image: a folder of that name", folder.path, frames=7, says=r"frame skipped.*rgb/.*png")
        for ending, color, depth in ((".webp", lambda: WEBP, depth_png), (".exr", color_png, exr)):
            folder = self.folder(color=color, depth=depth, ending=ending, camera=False)
            (folder.path / "camera.yaml").write_text(camera_yaml(depth_scale=None if ending == ".exr" else 5000))
            folder.write_lists(ending=ending)
            self.record(f"image: {ending}", folder.path, frames=8)
        for size in (0, 4, 60, 400, len(exr()) - 100):
            folder = self.folder(depth=lambda: exr()[:size], camera=False)
            (folder.path / "camera.yaml").write_text(camera_yaml(depth_scale=None))
            self.record(f"image: OpenEXR cut off at byte {size}", folder.path, code=1, says="depth")
        for size in (0, 12, 30):
            folder = self.folder(color=lambda: WEBP[:size])
            self.record(f"image: WebP cut off at byte {size}", folder.path, code=1, says="rgb/|colour")
        folder = self.folder(depth=lambda: pgm(value=10000)[:-1])
        self.record("image: all a byte short", folder.path, code=1, says=r"no frame.*depth/")
        grey = lambda: png(WIDTH, HEIGHT, 8, 0, [bytes(range(60, 60 + WIDTH))] * HEIGHT)
        self.record("image: grey colour", self.folder(color=grey).path, frames=8)
        alpha = lambda: png(WIDTH, HEIGHT, 8, 6, [bytes([40, 90, 140, 255]) * WIDTH] * HEIGHT)
        self.record("image: colour with alpha", self.folder(color=alpha).path, frames=8)

    # ---- names, lists and layouts

    def layouts(self):
        for what, how in (
            ("CRLF", {"newline": "\r\n"}),
            ("UTF-16", {"encoding": "utf-16"}),
            ("a byte order mark", {"encoding": "utf-8-sig"}),
            ("tabs", {"sep": "\t"}),
            ("commas", {"sep": ","}),
            ("no comment", {"head": ""}),
            ("blank lines", {"newline": "\n\n"}),
            ("many blanks", {"sep": "      "}),
        ):
            folder = self.folder(lists=False).write_lists(**how)
            self.record(f"list: {what}", folder.path, frames=8)
        folder = self.folder()
        for kind in ("rgb", "depth"):
            (folder.path / f"{kind}.txt").write_text((folder.path / f"{kind}.txt").read_text().replace("/", "\\"))
        self.record("list: backslashes", folder.path, frames=8)
        folder = self.folder(lists=False)
        folder.write_lists()
        for kind in ("rgb", "depth"):
            (folder.path / kind).rename(folder.path / f"my {kind}")
            listed = (folder.path / f"{kind}.txt").read_text().replace(f"{kind}/", f"my {kind}/")
            (folder.path / f"{kind}.txt").write_text(listed)
        self.record("list: blanks in paths", folder.path, frames=8)
        folder = self.folder()
        with (folder.path / "rgb.txt").open("a") as listed:
            listed.write("\x01\x02\x03\n1305031103.5\n1305031104.5 rgb/none.png extra words\n")
        self.record("list: lines that are none", folder.path, frames=8, says="rgb.txt")
        for content in ("", "# nothing\n", "\n\n\n", "\0" * 500, "rgb/a.png 1.0\n"):
            folder = self.folder()
            (folder.path / "rgb.txt").write_text(content)
            self.record(f"list: rgb.txt is {content[:10]!r}", folder.path, code=1, says="rgb.txt")
        folder = self.folder()
        (folder.path / "depth.txt").unlink()
        self.record("list: depth.txt is missing", folder.path, code=1, says="rgb.txt and depth.txt")
        folder = self.folder()
        shutil.rmtree(folder.path / "depth")
        self.record("list: the depth images are missing", folder.path, code=1, says="depth/")
        folder = self.folder(lists=False)
        self.record("layout: no lists", folder.path, frames=8)
        folder = self.folder(lists=False)
        for kind in ("rgb", "depth"):
            for i, stamp in enumerate(folder.stamps):
                (folder.path / f"{kind}/{stamp}.png").rename(folder.path / f"{kind}/frame-{i:06}.png")
        self.record("layout: numbered frames", folder.path, frames=8)
        folder = self.folder(lists=False)
        (folder.path / "rgb").rename(folder.path / "color")
        self.record("layout: color/ and depth/", folder.path, frames=8)
        folder = self.folder(lists=False)
        for i, stamp in enumerate(folder.stamps):
            (folder.path / f"rgb/{stamp}.png").rename(folder.path / f"rgb/{i + 100}.png")
            (folder.path / f"depth/{stamp}.png").rename(folder.path / f"depth/{i + 500}.png")
        self.record("layout: numbers that never agree", folder.path, code=1, says="colour|depth")
        folder = self.folder(lists=False)
        shutil.rmtree(folder.path / "depth")
        self.record("layout: colour alone", folder.path, code=1, says="depth")
        empty = self.place()
        empty.mkdir()
        self.record("layout: an empty folder", empty, code=1, says="rgb.txt|no recording|holds no")
        self.record("layout: nothing there", empty / "none", code=1, says="not found")
        self.record("layout: a text file", self.file("a.txt", "hello\n"), code=1, says="not a folder")
        self.record("layout: an unknown kind", self.file("a.mp4", bytes(100)), code=1, says="not a folder")
        folder = self.folder()
        list_file = self.file("pairs.txt", "")
        self.record("list: empty --associations", folder.path, "--associations", list_file, code=1, says="pairs.txt")
        self.record("list: no --associations", folder.path, "--associations", empty / "x", code=1, says="/x")

    def layouts_of_others(self):
        """Data sets and exports as they are distributed."""
        pose = "1 0 0 0.5\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"

        def files(contents):
            path = self.place()
            for name, content in contents.items():
                (path / name).parent.mkdir(parents=True, exist_ok=True)
                (path / name).write_bytes(content if isinstance(content, bytes) else content.encode())
            return path

        color, depth = color_png(), depth_png(value=2000, slope=3)
        intrinsics = "66.8 0 39.5\n0 66.8 29.5\n0 0 1\n"
        scannet = {
            f"{kind}/{i}.{'txt' if kind == 'pose' else 'png'}": content
            for kind, content in (("color", color), ("depth", depth), ("pose", pose))
            for i in range(FRAMES)
        }
        matrix = "66.8 0 39.5 0\n0 66.8 29.5 0\n0 0 1 0\n0 0 0 1\n"
        scannet |= {f"intrinsic/intrinsic_{kind}.txt": matrix for kind in ("color", "depth")}
        self.record("layout: ScanNet", files(scannet), frames=8)
        small = {**scannet, **{f"depth/{i}.png": depth_png(2000, 40, 30, 3) for i in range(FRAMES)}}
        half = "33.4 0 19.5 0\n0 33.4 14.5 0\n0 0 1 0\n0 0 0 1\n"
        self.record("layout: ScanNet of two sizes", files({**small, "intrinsic/intrinsic_depth.txt": half}), frames=8)
        for name, content in (("two numbers", "1 2\n"), ("words", "fx fy\n"), ("nothing", ""), ("zeros", "0 " * 16)):
            spoilt = {**scannet, "intrinsic/intrinsic_color.txt": content}
            self.record(f"layout: ScanNet with {name} as its camera", files(spoilt), code=1, says="intrinsic_color.txt")
        replica = {f"results/frame{i:06}.png": color for i in range(FRAMES)}
        replica |= {f"results/depth{i:06}.png": depth for i in range(FRAMES)}
        replica |= {"traj.txt": ("1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n") * FRAMES}
        camera = {"camera": {"w": WIDTH, "h": HEIGHT, "fx": 66.8, "fy": 66.8, "cx": 39.5, "cy": 29.5, "scale": 1000}}
        self.record("layout: Replica", files({**replica, "cam_params.json": json.dumps(camera)}), frames=8)
        self.record("layout: Replica without its camera", files(replica), code=1, says="camera|size")
        cut = {**replica, "cam_params.json": json.dumps(camera)[:40]}
        self.record("layout: Replica with half a camera", files(cut), code=1, says="cam_params.json")
        for name, folder in (("SUN3D", "image"), ("Redwood", "rgb")):
            numbered = {f"{folder}/{i + 1:07}-{i * 33366:012}.png": color for i in range(FRAMES)}
            numbered |= {f"depth/{i + 1:07}-{i * 33366 + 217:012}.png": depth for i in range(FRAMES)}
            self.record(f"layout: {name}", files({**numbered, "intrinsics.txt": intrinsics}), frames=8, says="in us")
            self.record(f"layout: {name} without a camera", files(numbered), code=1, says="camera")
        lists = {
            f"{kind}.txt": "".join(f"{5127 + i / 27:.6f} {kind}/{i}.png\n" for i in range(FRAMES))
            for kind in ("rgb", "depth")
        }
        eth3d = (
            {f"rgb/{i}.png": color for i in range(FRAMES)}
            | {f"depth/{i}.png": depth_png() for i in range(FRAMES)}
            | lists
        )
        self.record("layout: ETH3D", files({**eth3d, "calibration.txt": "66.8 66.8 39.5 29.5\n"}), frames=8)
        self.record(
            "layout: ETH3D, a number short",
            files({**eth3d, "calibration.txt": "66.8 66.8 39.5\n"}),
            code=1,
            says="calibration.txt",
        )
        bonn = self.folder(camera=False)
        named = bonn.path.parent / "rgbd_bonn_balloon"
        bonn.path.rename(named)
        self.record("layout: Bonn of another size", named, code=1, says="640|size|camera")
        scenes = {"camera.yaml": camera_yaml(depth_scale=1000)}
        for i in range(FRAMES):
            name = f"frame-{i:06}"
            scenes |= {f"{name}.color.png": color, f"{name}.depth.png": depth, f"{name}.pose.txt": pose}
        self.record("layout: 7-Scenes", files(scenes), frames=8)
        folder = self.folder(depth=lambda: depth_png(10000, 40, 30))
        self.record("layout: depth of half the size", folder.path, frames=8, says="taken to be of one camera")
        folder = self.folder(depth=lambda: depth_png(10000, 50, 20))
        self.record("layout: depth of another shape", folder.path, code=1, says="50x20")

    def masks_and_turns(self):
        """Masks named in any way, and cameras held in any way."""
        static = png(WIDTH, HEIGHT, 8, 0, [bytes(WIDTH)] * HEIGHT)
        person = png(WIDTH, HEIGHT, 8, 0, [bytes([1] * 20 + [0] * (WIDTH - 20))] * HEIGHT)

        def masked(name, names, content=static, **expected):
            folder, masks = self.folder(), self.place("masks")
            masks.mkdir()
            for file in names(folder.stamps):
                (masks / file).write_bytes(content)
            self.add(
                f"masks: {name}",
                ["run", folder.path, "--out", self.place("-out"), "--masks", masks, "--no-report"],
                **expected,
            )

        for name, names in (
            ("by stamps", lambda stamps: [f"{stamp}.png" for stamp in stamps]),
            ("by stamps in microseconds", lambda stamps: [stamp.replace(".", "") + ".png" for stamp in stamps]),
            ("by numbers from 0", lambda stamps: [f"{i}.png" for i in range(FRAMES)]),
            ("by numbers from 1", lambda stamps: [f"{i + 1:05}.png" for i in range(FRAMES)]),
        ):
            masked(name, names, frames=8, says="stable")
            masked(f"{name}, of a person", names, person, frames=8, says="stable")
        by_number = lambda stamps: [f"{i}.png" for i in range(FRAMES)]
        masked("none of that name", lambda stamps: ["mask.png"], code=1, says="mask")
        masked("no files", lambda stamps: [], code=1, says="mask")
        masked("of another size", by_number, png(40, 30, 8, 0, [bytes(40)] * 30), code=1, says="40x30|size")
        masked("that are no images", by_number, b"mask\n" * 20, code=1, says="mask|0.png")
        for turn in ("0", "90", "180", "270", "auto"):
            self.run_it(f"rotate: {turn}", self.folder().path, "--rotate", turn, frames=8, says="stable")
        for turn in ("45", "-90", "left", ""):
            self.run_it(f"rotate: {turn!r}", self.folder().path, f"--rotate={turn}", code=2, says="--rotate")

    # ---- camera files of any program

    def cameras(self):
        def camera(name, content, **expected):
            if expected.get("code") == 1:
                expected.setdefault("says", r"camera\.\w+")
            path = self.file("camera.yaml", content)
            self.record(f"camera: {name}", self.plain, "--camera", path, **expected)

        self.plain = self.folder().path
        good = camera_yaml()
        camera("in order", good, frames=8)
        camera("numbers alone", "66.8 66.8 39.5 29.5\n", frames=8)
        camera("a matrix", "66.8 0 39.5\n0 66.8 29.5\n0 0 1\n", frames=8)
        camera(
            "Open3D",
            json.dumps({"width": 80, "height": 60, "intrinsic_matrix": [66.8, 0, 0, 0, 66.8, 0, 39.5, 29.5, 1]}),
            frames=8,
        )
        orb = "%YAML:1.0\nCamera.fx: 66.8\nCamera.fy: 66.8\nCamera.cx: 39.5\nCamera.cy: 29.5\nCamera.width: 80\n"
        camera("ORB-SLAM", orb + "Camera.height: 60\nDepthMapFactor: 5000.0\n", frames=8)
        ros = (
            "image_width: 80\nimage_height: 60\ncamera_name: a\ncamera_matrix:\n  rows: 3\n  cols: 3\n"
            "  data: [66.8, 0, 39.5, 0, 66.8, 29.5, 0, 0, 1]\ndistortion_model: plumb_bob\n"
            "distortion_coefficients:\n  rows: 1\n  cols: 5\n  data: [0, 0, 0, 0, 0]\n"
        )
        camera("ROS", ros, frames=8)
        camera(
            "ROS, fisheye",
            ros.replace("plumb_bob", "equidistant").replace("[0, 0, 0, 0, 0]", "[0.1, 0, 0, 0, 0]"),
            code=1,
            says="fisheye|equidistant",
        )
        for key in ("fx", "fy", "cx", "cy"):
            camera(f"{key} is missing", camera_yaml(**{key: None}), code=1, says=rf"camera\.yaml.*{key}")
        for key, values in (
            ("fx", ("0", "-5", "nan", "inf", "1e30", "wide", "[1, 2]", "")),
            ("width", ("0", "-80", "1e9", "80.5", "eighty")),
            ("height", ("61", "0")),
            ("cx", ("1000", "nan")),
            ("depth_scale", ("0", "-1", "nan", "inf", "metres")),
            ("k1", ("nan", "x")),
        ):
            for value in values:
                camera(f"{key}: {value}", camera_yaml(**{key: value}), code=1, says=rf"camera\.yaml.*|60|61")
        camera("a misspelt key", good + "depth_scal: 1000\n", code=1, says="depth_scal.*depth_scale")
        camera("a key twice", good + "fx: 70\n", code=1, says="fx.*twice|twice.*fx")
        camera("fisheye", good + "model: fisheye\n", code=1, says="fisheye|model")
        camera("the rational model", good + "".join(f"k{i}: 0.01\n" for i in range(1, 7)), frames=8)
        camera("broken YAML", "fx: [1\nfy: {", code=1)
        camera("empty", "", code=1)
        camera("binary", bytes(range(256)), code=1)
        camera("very deep", "[" * 2000, code=1)
        camera("an image", color_png(), code=1)
        camera("a list", "- 1\n- 2\n", code=1)
        camera("of Windows", good.replace("\n", "\r\n"), frames=8)
        camera("with a byte order mark", "\ufeff" + good, frames=8)
        self.record("camera: nothing there", self.plain, "--camera", self.temp / "none.yaml", code=1, says="none.yaml")
        self.record("camera: a folder", self.plain, "--camera", self.temp, code=1, says="folder|directory|not")
        self.record("camera: not known", self.folder(camera=False).path, code=1, says="--camera")

    # ---- results that would replace something

    def outputs(self):
        folder = self.folder()
        self.add("out: the recording itself", ["record", folder.path, "--out", folder.path], code=1, says="already")
        self.add(
            "out: a run into a recording",
            ["run", folder.path, "--out", folder.path, "--no-people"],
            code=1,
            says="recording",
        )
        self.add(
            "out: synth into a recording",
            ["synth", "--out", folder.path, "--frames", "2"],
            code=1,
            says="already|holds",
        )
        log = self.log_with_camera(klg())
        self.add("out: the log itself", ["record", log, "--out", log], code=1, says="already")
        blocked = self.file("file", "in the way")
        for out in (blocked, blocked / "deeper", "/proc/none/out"):
            self.add(
                f"out: {out.name if isinstance(out, Path) else out}", ["record", folder.path, "--out", out], code=1
            )
        self.add(
            "out: a name of 300 letters", ["record", folder.path, "--out", self.temp / ("a" * 300)], code=1, says="aaaa"
        )
        self.add("out: none", ["record", folder.path], code=2, says="--out")
        self.add("out: an empty name", ["record", folder.path, "--out", ""], code=2, says="--out.*empty")
        self.add("out: an empty name of a run", ["run", folder.path, "--out", ""], code=1, says="--out is empty")

    # ---- the command line

    def command_lines(self):
        path = self.folder().path
        for option, values in (
            ("--scale", ("0", "nan", "inf", "-1", "2", "1e-9", "half", "0,5", "")),
            ("--max-frames", ("-1", "1.5", "many", "1e99", "")),
            ("--pose-every", ("0", "-3", "x")),
            ("--preprocess-depth-max", ("nan", "-1", "1e30")),
            ("--tracking-iterations", ("1,2", "1,2,3,4", "a,b,c", "-1,0,0", "")),
            ("--segmentation-mode", ("fast", "")),
            ("--map-max-capacity", ("-1", "0", "1e20")),
            ("--classes", ("person", "1;2", "-1")),
            ("--checkpoint-every", ("-1", "x")),
        ):
            for value in values:
                self.run_it(f"option: {option} '{value}'", path, f"{option}={value}", code=2, says=option)
        self.run_it("option: misspelt", path, "--sclae", "0.5", code=2, says="--sclae")
        self.run_it("option: twice", path, "--scale", "0.5", "--scale", "0.25", code=2, says="--scale")
        self.run_it("option: no steps at all", path, "--tracking-iterations", "0,0,0", code=1, says="iterations")
        self.run_it("option: neither term", path, "--no-tracking-icp", "--no-tracking-photometric", code=1, says="icp")
        self.run_it("option: a scale that leaves nothing", path, "--scale", "0.05", code=1, says="80x60|scale")
        for content, says in (
            ("scale: two\n", "scale"),
            ("sclae: 1\n", "sclae.*scale"),
            ("scale: [1\n", "yaml"),
            ("- 1\n", "yaml"),
            ("tracking: 5\n", "tracking"),
            ("scale: 0.5\nscale: 0.25\n", "scale"),
            (bytes(range(256)), "yaml"),
        ):
            self.run_it(
                f"options file: {content[:12]!r}", path, "--config", self.file("my.yaml", content), code=1, says=says
            )
        self.run_it("options file: nothing there", path, "--config", self.temp / "none.yaml", code=1, says="none.yaml")
        self.add("command: none", [], code=2, says="run.*evaluate")
        self.add("command: unknown", ["fly"], code=2, says="fly.*run")
        for name, content in (("a.pfmap", b"x" * 100), ("map.ply", b"ply\nformat ascii"), ("map.ply", b"")):
            self.add(
                f"export: {content[:9]!r} as {name}",
                ["export", self.file(name, content), "--mesh", self.place("-mesh.ply")],
                code=1,
                says=name,
            )

    def all(self):
        self.beginnings()
        self.depths()
        self.logs()
        self.bags()
        self.bags_of_cameras()
        self.stamps()
        self.evaluations()
        self.images()
        self.layouts()
        self.layouts_of_others()
        self.masks_and_turns()
        self.cameras()
        self.outputs()
        self.command_lines()
        return self.cases


def main():
    program, names = sys.argv[1], sys.argv[2:]
    with tempfile.TemporaryDirectory(prefix="posefusion_odd_") as temp:
        cases = Cases(Path(temp), program).all()
        print(len(cases), "cases")
        if names:
            cases = [case for case in cases if any(name in case.name for name in names)]
        elif len(cases) < ENOUGH_CASES:
            sys.exit(f"fewer than {ENOUGH_CASES} cases")
        failed = 0
        with concurrent.futures.ThreadPoolExecutor(max_workers=min(4, os.cpu_count() or 1)) as pool:
            for case, (faults, said) in zip(cases, pool.map(lambda case: case.run(program), cases)):
                failed += bool(faults)
                if faults or names:
                    print(f"{case.name}: {', '.join(faults) or 'as expected'}\n  {said.strip()}".replace(temp, "TEMP"))
        print(failed, "failed")
        sys.exit(failed > 0)


if __name__ == "__main__":
    main()
