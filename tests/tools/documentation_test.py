#!/usr/bin/python3
"""README.md, CONTRIBUTING.md and docs/*.md are true: every command in them runs, every option exists, every link leads
somewhere, every file, kernel and function that is named exists, every error message that is quoted is one of the
program's.

usage: documentation_test.py SOURCE BUILD SCRATCH [unittest options]

A page's `sh` blocks run one after the other in a folder of its own, in which the names that the page uses stand for
small synthetic recordings (see Page.prepare). Commands are run as they stand, but for
  view               which gets a display that nobody sees and a script that ends it,
  synth              which makes few and small images,
  --checkpoint-every which is less than the frames that the recordings here have,
  benchmark          which is told the build folder,
and but for NOT_RUN: those that need the network, packages or hardware, each with the reason and what is checked
instead.
"""
import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
import tarfile
import unittest
from pathlib import Path

SOURCE, BUILD, SCRATCH = (Path(argument).resolve() for argument in sys.argv[1:4])
PAGES = [file for file in (SOURCE / "README.md", SOURCE / "CONTRIBUTING.md") if file.exists()]
PAGES += sorted((SOURCE / "docs").glob("*.md"))
PROGRAM = BUILD / "posefusion"
LONGEST_BLOCK = 120  # seconds

# ---------------------------------------------------------------------------------------------------------------------
# Commands that are not run, and what is checked instead: (pattern of the line, reason, check: line -> fault or "").


def is_a_tool(line):
    tool = SOURCE / line.split()[0]
    if not os.access(tool, os.X_OK):
        return f"{tool} is no program"
    return subprocess.run(["bash", "-n", tool], capture_output=True, text=True).stderr


def tested_by(name):
    def check(_):
        lists = (SOURCE / "tests").rglob("CMakeLists.txt")
        places = re.compile(rf"add_test\(NAME {name} |foreach\(tool .*\b{name.removeprefix('tools.')}\b")
        return "" if any(places.search(file.read_text()) for file in lists) else f"there is no test {name}"

    return check


def fetches_what_is_unpacked(line):
    """Its archive is made by prepare(); here only the address can be looked at."""
    return "" if re.search(r"^wget https://\S+/(\S+)\.tgz$", line) else "is not the address of a .tgz"


def with_a_dummy(line):
    """Run with the camera that OpenNI2 brings along for tests (320 x 240, nothing to be seen), where it does; else the
    options must be right and the fault the missing camera."""
    folder = SCRATCH / "camera" / str(sum(1 for _ in (SCRATCH / "camera").iterdir()))
    folder.mkdir()
    (folder / "camera.yaml").write_text("fx: 300\nfy: 300\ncx: 160\ncy: 120\nwidth: 320\nheight: 240\n")
    line = adapted(line.replace("openni2:", "openni2:Dummy", 1)) + " --max-frames 2"
    if "--camera" not in line:
        line += " --camera camera.yaml"
    if " record " not in line:
        line += " --no-people"  # there is not even a picture
    result = run(line, folder)
    absent = re.search(r"^posefusion: openni2:.*(no such camera|without OpenNI2|cannot be started).*\n$", result.stderr)
    return "" if result.returncode == 0 or absent else f"exit code {result.returncode}: {result.stderr[-1000:]}"


NOT_RUN = [
    (r"^\./tools/(demo|test)\b", "installs packages and builds everything", is_a_tool),
    (
        r"^\./tools/setup && cmake -S \. -B build -G Ninja && cmake --build build$",
        "installs packages and builds everything",
        is_a_tool,
    ),
    (r"^cmake --install build --prefix PREFIX$", "is a test of its own", tested_by("Library.Install")),
    (r"^cd build && cpack$", "is a test of its own", tested_by("Package.Debian")),
    (r"^cmake --build build --target wheel$", "is a test of its own", tested_by("Package.Wheel")),
    (r"^/usr/bin/python3 -m venv venv$", "is a test of its own", tested_by("Package.Wheel")),
    (r"^venv/bin/(pip|python) ", "is a test of its own", tested_by("Package.Wheel")),
    (r"^tools/cross_arm64$", "fetches packages and builds everything", is_a_tool),
    (r"^posefusion run RECORDING --web$", "its port may be in use", tested_by("Program.LivePage")),
    (r"^posefusion web DIR$", "goes on until Ctrl-C", tested_by("Program.WebServer")),
    (r"^tools/benchmark .*--(tum|synth) ", "runs for long", tested_by("tools.benchmark")),
    (r"^tools/benchmark .*--slurm", "needs a cluster", tested_by("tools.benchmark_slurm")),
    (r"^wget ", "needs the network", fetches_what_is_unpacked),
    (r"^posefusion \w+ openni2:", "needs a camera", with_a_dummy),
]

# ---------------------------------------------------------------------------------------------------------------------
# Reading pages.

CODE_BLOCK = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
INLINE_CODE = re.compile(r"`([^`\n]+(?:\n[^`\n]+)?)`")
OPTION = re.compile(r"(?<![\w-])--([a-z][a-z0-9-]*)(\*?)")


def text_without_blocks(page):
    return CODE_BLOCK.sub("", page.read_text())


def lines_of(block):
    """Commands of a block, one a line: comments and continued lines undone."""
    lines = []
    for line in block.replace("\\\n", " ").splitlines():
        words = shlex.split(line, comments=True, posix=False)
        if words:
            lines.append(" ".join(words))
    return lines


def sh_blocks(page):
    return [lines_of(text) for language, text in CODE_BLOCK.findall(page.read_text()) if language == "sh"]


# ---------------------------------------------------------------------------------------------------------------------
# Running.


def environment():
    return {
        **os.environ,
        "PATH": f"{SCRATCH / 'bin'}:{os.environ['PATH']}",
        "LP_NUM_THREADS": "1",
        "LC_ALL": "C.UTF-8",
        "MESA_SHADER_CACHE_DIR": str(BUILD / "shader-cache"),
        "PYTHONDONTWRITEBYTECODE": "1",
    }


def run(script, folder):
    command = ["bash", "-c", "set -euo pipefail\n" + script]
    process = subprocess.Popen(
        command,
        cwd=folder,
        env=environment(),
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    try:
        out, err = process.communicate(timeout=LONGEST_BLOCK)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)  # what the shell has started, too
        out, err = process.communicate()
        err += f"not done after {LONGEST_BLOCK} s"
    return subprocess.CompletedProcess(command, process.returncode, out, err)


class Display:
    """That nobody sees."""

    def __enter__(self):
        read, write = os.pipe()
        command = ["Xvfb", "-displayfd", str(write), "-screen", "0", "1400x900x24", "-nolisten", "tcp"]
        self.server = subprocess.Popen(command, pass_fds=[write], stderr=subprocess.DEVNULL)
        os.close(write)
        with os.fdopen(read) as number:
            os.environ["DISPLAY"] = ":" + number.readline().strip()
        return self

    def __exit__(self, *_):
        del os.environ["DISPLAY"]
        self.server.terminate()
        self.server.wait()


def adapted(line):
    """A command as it is run here."""
    line = re.sub(r"--checkpoint-every \d+", "--checkpoint-every 4", line)
    words = line.split()
    if words[:2] == ["posefusion", "synth"] and "--frames" not in words:
        return f"{line} --frames 4 --width 160 --height 120"
    if words[:2] == ["posefusion", "view"] and "--script" not in words:
        return f"{line} --script {SCRATCH / 'view.txt'}"
    if words[0].endswith("tools/benchmark"):
        return re.sub(r"tools/benchmark\b", f"tools/benchmark --build {BUILD}", line)
    return line


class Page:
    """A folder with what the commands of a page need."""

    def __init__(self, page):
        self.page = page
        self.folder = SCRATCH / "pages" / page.stem
        self.folder.mkdir(parents=True)

    def link(self, name, target):
        place = self.folder / name
        place.parent.mkdir(parents=True, exist_ok=True)
        place.symlink_to(target)

    def prepare(self):
        text = self.page.read_text()
        self.link("build", BUILD)
        self.link("tools", SOURCE / "tools")
        self.link("docs", SOURCE / "docs")
        self.link("RECORDING", SCRATCH / "recording")
        self.link("SOURCE", SCRATCH / "recording")
        self.link("DIR", SCRATCH / "result")  # of a run: map.ply, and masks/ for --masks DIR
        self.link("PREFIX/lib/python3/dist-packages", BUILD / "python")
        self.link("FOLDER/walk", SCRATCH / "recording") if self.page.stem == "tum" else None
        self.link("mask_rcnn.onnx", SCRATCH / "mask_rcnn.onnx")
        self.link("openpose.onnx", SCRATCH / "openpose.onnx")
        shutil.copy(SCRATCH / "recording/camera.yaml", self.folder)
        if self.page.stem in ("camera", "raw_stream"):  # as if openni2: had been recorded
            self.link("recording", SCRATCH / "recording")
        for name in set(re.findall(r"python3 (\w+\.py)", text)):  # the program that the page shows
            shown = [code for language, code in CODE_BLOCK.findall(text) if language == "python"]
            (self.folder / name).write_text(shown[0])
        for name in set(re.findall(r"/(\w+)\.tgz", text)):  # as if it had been fetched
            with tarfile.open(self.folder / f"{name}.tgz", "w:gz") as archive:
                archive.add(SCRATCH / "recording", name)

    def run(self):
        """Faults, one a command at most."""
        faults = []
        for block in sh_blocks(self.page):
            script = []
            for line in block:
                entry = next((entry for entry in NOT_RUN if re.search(entry[0], line)), None)
                fault = entry[2](line) if entry else ""
                if fault:
                    faults.append(f"{line}: {fault}")
                if not entry:
                    script.append(f"echo {shlex.quote(line)} >&3; {adapted(line)}")
            if not script:
                continue
            log = self.folder / "commands.log"
            result = run(f"exec 3>{log}\n" + "\n".join(script), self.folder)
            if result.returncode != 0:
                command = log.read_text().splitlines()[-1]
                faults.append(f"{command}: exit code {result.returncode}: {result.stderr[-1000:]}")
        return faults


def write_networks():
    """Networks that find nobody, in the two forms that the pages tell of."""
    import onnx
    from onnx import TensorProto, helper

    def save(name, nodes, initializers, image, outputs, opset):
        inputs = [floats("image", image)]
        graph = helper.make_graph(nodes, name, inputs, outputs, initializers)
        model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", opset)], ir_version=6)
        onnx.checker.check_model(model)
        onnx.save(model, SCRATCH / f"{name}.onnx")

    def floats(name, shape):
        return helper.make_tensor_value_info(name, TensorProto.FLOAT, shape)

    def tensor(name, shape, values):
        return helper.make_tensor(name, TensorProto.FLOAT, shape, values)

    maps, background = 57, 18
    save(
        "openpose",
        [
            helper.make_node("AveragePool", ["image"], ["small"], kernel_shape=[8, 8], strides=[8, 8]),
            helper.make_node("Conv", ["small", "weights", "bias"], ["maps"], kernel_shape=[1, 1]),
        ],
        [
            tensor("weights", [maps, 3, 1, 1], [0.0] * (3 * maps)),
            tensor("bias", [maps], [float(i == background) for i in range(maps)]),
        ],
        [1, 3, 120, 160],
        [floats("maps", [1, maps, 15, 20])],
        11,
    )
    save(
        "mask_rcnn",
        [
            helper.make_node("Constant", [], ["labels"], value=helper.make_tensor("l", TensorProto.INT64, [1], [1])),
            helper.make_node("Constant", [], ["scores"], value=tensor("s", [1], [0.1])),
            helper.make_node("Slice", ["image", "first", "end", "channels"], ["masks"]),
        ],
        [
            helper.make_tensor(name, TensorProto.INT64, [1], [value])
            for name, value in (("first", 0), ("end", 1), ("channels", 1))
        ],
        [1, 3, 120, 160],
        [
            helper.make_tensor_value_info("labels", TensorProto.INT64, [1]),
            floats("scores", [1]),
            floats("masks", [1, 1, 120, 160]),
        ],
        11,
    )


def setUpModule():
    shutil.rmtree(SCRATCH, ignore_errors=True)
    (SCRATCH / "bin").mkdir(parents=True)
    (SCRATCH / "bin/posefusion").symlink_to(PROGRAM)
    (SCRATCH / "view.txt").write_text("step 2\n")
    (SCRATCH / "camera").mkdir()
    size = "--width 160 --height 120 --people 1"
    setup = run(
        f"posefusion synth --out recording --frames 8 {size}\n"
        f"posefusion synth --out longer --frames 40 --still-camera --static {size}\n"
        "posefusion run longer --out result --no-people --no-report\n"
        "ln -s ../recording/masks result/masks",
        SCRATCH,
    )
    assert setup.returncode == 0, setup.stderr
    write_networks()


# ---------------------------------------------------------------------------------------------------------------------


class Commands(unittest.TestCase):
    """One test per page is added below."""

    def test_none_hides_in_a_block_of_another_kind(self):
        for page in PAGES:
            for language, text in CODE_BLOCK.findall(page.read_text()):
                if language != "sh":
                    self.assertNotRegex(
                        text,
                        r"(?m)^(\$ |(\./)?(build/)?posefusion |\./tools/|sudo |apt )",
                        f"{page.name}: a block of commands is marked ```sh",
                    )

    def test_the_script_of_the_viewer(self):
        blocks = CODE_BLOCK.findall((SOURCE / "docs/viewer.md").read_text())
        scripts = [text for language, text in blocks if not language and text.startswith("step ")]
        self.assertEqual(len(scripts), 1)
        folder = SCRATCH / "script"
        folder.mkdir()
        (folder / "steps.txt").write_text(scripts[0])
        with Display():
            result = run(f"posefusion view {SCRATCH / 'longer'} --no-people --script steps.txt", folder)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertTrue(list(folder.rglob("normal.png")), "no picture")

    def test_all_that_are_not_run_are_there(self):
        lines = [line for page in PAGES for block in sh_blocks(page) for line in block]
        for pattern, _, _ in NOT_RUN:
            self.assertTrue(
                any(re.search(pattern, line) for line in lines), f"no page has a command like {pattern} any more"
            )


def add_page(page):
    def test(self):
        prepared = Page(page)
        prepared.prepare()
        with Display():
            self.assertEqual(prepared.run(), [])

    setattr(Commands, f"test_{page.stem}", test)


for each in PAGES:
    add_page(each)


class Options(unittest.TestCase):
    OF_OTHERS = {"install", "build", "prefix", "target"} | {"partition", "gres"}  # cmake, sbatch

    @classmethod
    def setUpClass(cls):
        commands = re.findall(r"(?m)^  (\w+)  ", run("posefusion --help", SCRATCH).stdout.split("Subcommands:")[1])
        cls.of = {
            command: cls.options_in(run(f"posefusion {command} --help-all", SCRATCH).stdout) for command in commands
        }
        of_developers = ("benchmark", "benchmark_loops", "check", "gpu_check/pack", "soak")
        tools = "\n".join(run(f"{SOURCE}/tools/{tool} --help", SCRATCH).stdout for tool in of_developers)
        cls.all = set().union(*cls.of.values(), cls.options_in(tools), cls.OF_OTHERS, {"version"})

    @staticmethod
    def options_in(text):
        return {name for name, _ in OPTION.findall(text)}

    def test_exist(self):
        self.assertGreater(len(self.all), 100)
        for page in PAGES:
            code = INLINE_CODE.findall(text_without_blocks(page))
            code += [line for block in sh_blocks(page) for line in block]
            for text in code:
                command = re.match(r"(?:build/)?posefusion (\w+)", text)
                if command:
                    self.assertIn(command[1], self.of, f"{page.name}: `{text}`")
                known = self.of[command[1]] if command else self.all
                for name, wildcard in OPTION.findall(text):
                    fits = any(option.startswith(name) for option in known) if wildcard else name in known
                    self.assertTrue(fits, f"{page.name}: `{text}`: there is no --{name}")

    def test_take_the_values_given(self):
        """Values are looked at before the recording."""
        tried = 0
        for page in PAGES:
            for text in INLINE_CODE.findall(text_without_blocks(page)):
                value = re.match(r"--([a-z0-9-]+) [a-z0-9.,]+$", text)
                if value and value[1] in self.of["run"]:
                    tried += 1
                    result = run(f"posefusion run nowhere {text}", SCRATCH)
                    self.assertIn("recording not found", result.stderr, f"{page.name}: `{text}`")
        self.assertGreater(tried, 20)

    def test_of_the_build_exist(self):
        lists = "\n".join(file.read_text() for file in SOURCE.rglob("CMakeLists.txt") if BUILD not in file.parents)
        for page in PAGES:
            for name in re.findall(r"-D(POSEFUSION_\w+)", page.read_text()):
                self.assertRegex(lists, rf"(option\(|set\(|find_program\(|PATH ){name}\b", f"{page.name}: -D{name}")


class Links(unittest.TestCase):
    def test_lead_somewhere(self):
        for page in PAGES:
            for target in re.findall(r"\]\(([^)\s]+)\)", text_without_blocks(page)):
                if re.match(r"https?://", target):
                    continue
                path, _, heading = target.partition("#")
                file = page.parent / path if path else page
                self.assertTrue(file.exists(), f"{page.name}: {target}")
                if heading:
                    headings = [
                        re.sub(r"[^\w -]", "", title.lower()).replace(" ", "-")
                        for title in re.findall(r"(?m)^#+ (.*)$", file.read_text())
                    ]
                    self.assertIn(heading, headings, f"{page.name}: {target}")

    def test_every_page_is_linked_from_the_first(self):
        readme = (SOURCE / "README.md").read_text()
        for page in PAGES[1:]:
            self.assertIn(f"]({page.relative_to(SOURCE)})", readme)


class Source(unittest.TestCase):
    """What pages name of the source is there; words in capitals stand for names."""

    FOLDERS = ("engine", "hosts", "pose", "segmentation", "shaders", "tests", "tools")

    @classmethod
    def setUpClass(cls):
        cls.files = [file for folder in cls.FOLDERS for file in (SOURCE / folder).rglob("*") if file.is_file()]
        code = [file for file in cls.files if file.suffix in (".cpp", ".hpp", ".h", ".comp", ".glsl", ".py")]
        cls.text = "\n".join(file.read_text() for file in code)
        cls.scopes = set(re.findall(r"\b(?:class|struct|namespace|enum)\s+(\w+)", cls.text))
        cls.functions = set(re.findall(r"\b(\w+)\(", cls.text))

    def named(self, pattern):
        """Pairs of page and match in the page's inline code."""
        return [
            (page, found)
            for page in PAGES
            for code in INLINE_CODE.findall(text_without_blocks(page))
            for found in re.findall(pattern, code)
        ]

    def test_paths(self):
        """From the top, or as kernels are named, from shaders/."""
        paths = self.named(
            r"(?<![\w/.])" r"(?:\.ci|hosts|engine|pose|segmentation|shaders|tests|tools|docs)/[\w./]+(?![\w*<{])"
        )
        paths += self.named(r"(?<![\w/.])[\w./]+/[\w.]+\.(?:cpp|hpp|comp|vert|frag|glsl)\b")
        self.assertGreater(len(paths), 20)
        for page, path in paths:
            if re.search(r"/[A-Z]+\b", path) and not re.search(r"/README|/CMakeLists", path):
                path = re.split(r"/[A-Z]+\b", path)[0]
            places = [SOURCE, SOURCE / "shaders"]
            if path.startswith("posefusion/"):  # as installed
                path, places = path.removeprefix("posefusion/"), [SOURCE, SOURCE / "hosts/library"]
            self.assertTrue(any((place / path).exists() for place in places), f"{page.name}: `{path}`")

    def test_names_of_files(self):
        names = {file.name for file in self.files}
        for page, name in self.named(r"^[\w.]+\.(?:cpp|hpp|comp|vert|frag|glsl)$"):
            self.assertIn(name, names, f"{page.name}: `{name}`")

    def test_functions(self):
        for page, name in self.named(r"\b([A-Za-z_][\w:]*)\(\)"):
            *scopes, function = name.split("::")
            self.assertIn(function, self.functions, f"{page.name}: `{name}()`")
            for scope in scopes:
                self.assertIn(scope, self.scopes, f"{page.name}: `{name}()`")

    def test_tests(self):
        tests = {f"{suite}.{name}" for suite, name in re.findall(r"\bTEST(?:_F|_P)?\((\w+),\s*(\w+)\)", self.text)}
        for page, name in self.named(r"^[A-Z]\w+\.[A-Z]\w+$"):
            self.assertIn(name, tests, page.name)


class Messages(unittest.TestCase):
    """Tables with a column `line` quote the program; ... stands for what changes."""

    def test_are_the_programs(self):
        folders = ("engine", "hosts", "pose", "segmentation")
        source = "".join(file.read_text() for folder in folders for file in sorted((SOURCE / folder).rglob("*.cpp")))
        source += "".join(file.read_text() for folder in folders for file in sorted((SOURCE / folder).rglob("*.hpp")))
        literals = re.sub(r'"\s*"', "", source)
        quoted = 0
        page = SOURCE / "docs/troubleshooting.md"
        for table in re.findall(r"(?m)^\| line \|.*\n\|.*\n((?:\|.*\n)+)", page.read_text()):
            for row in table.splitlines():
                for message in INLINE_CODE.findall(row.split("|")[1]):
                    quoted += 1
                    for part in filter(None, (part.strip() for part in message.split("..."))):
                        self.assertIn(part, literals, f"{page.name}: `{message}` is no message of the program")
        self.assertGreater(quoted, 20)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
