"""Stand-ins for the programs that tools/benchmark calls, and recordings for them."""
import subprocess
import sys

from support import TOOLS, ProgramFolder

# Writes what a run writes; fails for recordings whose name says so, and waits for the file `go` where the name says so.
# Every call is noted in calls.txt beside it. The error of a run grows with the frames that it leaves out.
POSEFUSION = """#!{python}
import json, pathlib, sys, time
beside = pathlib.Path(__file__).parent
with open(beside / "calls.txt", "a") as calls:
    calls.write(" ".join(sys.argv[1:]) + "\\n")
if sys.argv[1] == "evaluate":
    error = float(pathlib.Path(sys.argv[3]).read_text())
    statistics = {{"rmse": error}}
    print(json.dumps({{"ate": {{"translation_m": statistics}}, "rpe": {{"translation_m_per_s": statistics,
          "rotation_deg_per_s": {{"rmse": 0.5}}}}, "max_distance_from_start_m": 0.25}}))
    sys.exit(0)
out = pathlib.Path(sys.argv[sys.argv.index("--out") + 1])
if sys.argv[1] == "synth":
    out.mkdir()
    (out / "groundtruth.txt").write_text("")
    sys.exit(0)
if "broken" in sys.argv[2]:
    sys.exit("error: the recording | is broken")
while "slow" in sys.argv[2] and not (beside / "go").exists():
    time.sleep(0.02)
skipped = int(sys.argv[sys.argv.index("--start") + 1]) if "--start" in sys.argv else 0
(out / "trajectory.txt").write_text(str(0.0123 + 0.01 * skipped))
summary = {{"frames": 42, "tracking_failures": 1, "stable_surfels": 1000, "frame_time": {{"median_ms": 123.4}}}}
(out / "stats.json").write_text(json.dumps({{"device": {{"name": "stand-in"}}, "summary": summary}}))
"""

EVALUATE_MAP = """#!{python}
import json
print(json.dumps({{"by_first_pose": {{"fraction": 0.00123}}}}))
"""


class WithPrograms(ProgramFolder):
    programs = {"build/posefusion": POSEFUSION, "build/tools/evaluate_map/evaluate_map": EVALUATE_MAP}

    def recording(self, name, masks=False, truth=True):
        folder = self.root / name
        folder.mkdir(parents=True)
        (folder / "rgb.txt").write_text("")
        (folder / "depth.txt").write_text("")
        if masks:
            (folder / "masks").mkdir()
        if truth:
            (folder / "groundtruth.txt").write_text("")

    def command(self, *options):
        fixed = ("--out", self.root / "out", "--build", self.root / "build")
        return [str(part) for part in (sys.executable, TOOLS / "benchmark", *fixed, *options)]

    def benchmark(self, *options):
        """On the recordings in data."""
        return self.run_tool("--data", self.root / "data", *options)

    def run_tool(self, *options):
        return subprocess.run(self.command(*options), capture_output=True, text=True)

    def calls(self, of):
        calls = self.root / "build/calls.txt"
        return [c for c in calls.read_text().splitlines() if c.startswith(of + " ")] if calls.exists() else []

    def runs(self):
        return self.calls("run")

    def cells(self, table, *beginning):
        for line in table.splitlines():
            cells = [c.strip() for c in line.strip("|").split(" | ")]
            if cells[: len(beginning)] == list(beginning):
                return cells
        self.fail(f"no row for {beginning} in\n{table}")
