"""Where programs and data of a benchmark are: in a checkout of the sources, or in what `cmake --install` laid down."""
import json
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]  # of a checkout
INSTALLED = HERE / "installed.json"  # only an installation has it: its folders, relative to this one


@dataclass(frozen=True)
class Programs:
    posefusion: Path
    evaluate_map: Path


@dataclass(frozen=True)
class Places:
    programs: Programs
    out: Path  # where the runs go
    data: list  # folders with recordings; empty: the user has to name them
    chart_library: Path
    hint: str  # what to do where the program is missing


def programs_of_build(build):
    return Programs(build / "posefusion", build / "tools/evaluate_map/evaluate_map")


def places():
    """The defaults of the options."""
    if INSTALLED.exists():
        folders = {name: (HERE / folder).resolve() for name, folder in json.loads(INSTALLED.read_text()).items()}
        return Places(
            programs=Programs(folders["bin"] / "posefusion", folders["libexec"] / "evaluate_map"),
            out=Path("benchmark"),
            data=[],
            chart_library=folders["data"] / "chart.umd.js",
            hint="not there; install PoseFusion again, or give --build",
        )
    return Places(
        programs=programs_of_build(ROOT / "build"),
        out=ROOT / "build/benchmark",
        data=[ROOT / "../shared/data/house", ROOT / "../shared/data/real"],
        chart_library=ROOT / ".deps/chartjs/chart.umd.js",
        hint="not built; run ./tools/demo or cmake first, or give --build",
    )
