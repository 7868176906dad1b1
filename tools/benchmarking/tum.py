"""The recordings of the TUM RGB-D benchmark that the paper uses, and the tables of the paper beside ours."""
import json
import statistics
from pathlib import Path

from benchmarking.tables import ate, groups, markdown, rpe, shown, values_of

RUNS = 5  # of which the median is shown
ADDRESS = "https://cvg.cit.tum.de/rgbd/dataset"
PUBLISHED = json.loads((Path(__file__).parent / "published.json").read_text())
OF_THE_PAPER = tuple(PUBLISHED["sequences"])  # of its Tables 1 and 2
STATIC = tuple(PUBLISHED["static_sequences"])


def full_name(name):
    return f"rgbd_dataset_{name}"


def find(folder, only):
    """@return ({full name: folder} of the recordings that are there, at any depth; full names of those that are not)"""
    wanted = [full_name(name) for name in (*OF_THE_PAPER, *STATIC)]
    wanted = [name for name in wanted if not only or name in only or name.removeprefix("rgbd_dataset_") in only]
    there = {
        path.name: path.resolve() for path in sorted(folder.rglob("rgbd_dataset_*")) if (path / "rgb.txt").exists()
    }
    return {name: there[name] for name in wanted if name in there}, [name for name in wanted if name not in there]


def where_to_get(missing):
    """@param missing  full names"""
    lines = []
    for name in missing:
        camera = name.split("_")[2]
        lines.append(f"\nnot there: {name} ({ADDRESS}/{camera}/{name}.tgz)")
    return "".join(lines) + ("\n" if lines else "")


def middle(runs, measure):
    """Median in cm with smallest and largest."""
    values = [100 * value for value in values_of(runs, measure)]
    if not values:
        return "-"
    spread = f" ({min(values):.2f} to {max(values):.2f})" if len(values) > 1 else ""
    return f"{statistics.median(values):.2f}{spread}"


def best(entries, at):
    """The smallest figure published for the sequence of this number and whose it is, "-" where there is none."""
    known = [(entry["values"][at], entry["system"]) for entry in entries if entry["values"][at] is not None]
    if not known:
        return "-"
    figure, system = min(known)
    return f"{figure:g} {system}"


def table(title, published, measure, sequences, runs_of):
    """@param published  {"paper": the columns of the paper's table, "others": what else is published}"""
    columns = [
        "sequence",
        *(f"{entry['system']} (paper)" for entry in published["paper"]),
        "**ours**",
        "best published dense",
        "best published",
    ]
    rows = []
    for at, sequence in enumerate(sequences):
        if sequence not in runs_of:
            continue
        figures = [shown(entry["values"][at]) for entry in published["paper"]]
        others = published["paper"] + published["others"]
        dense = [entry for entry in others if entry["kind"] == "dense"]
        rows.append([sequence, *figures, middle(runs_of[sequence], measure), best(dense, at), best(others, at)])
    return f"{title}\n\n" + markdown(columns, rows, 1) if rows else ""


def tables(results):
    """Of the runs with the default options."""
    runs_of = {
        recording.removeprefix("rgbd_dataset_"): runs
        for (recording, variant), runs in groups(results).items()
        if variant == "default"
    }
    counted = max((len(runs) for runs in runs_of.values()), default=0)
    ours = f"ours: median of {counted} runs" + (" (smallest to largest)" if counted > 1 else "")
    parts = [
        table(f"Table 1: ATE RMSE in cm; {ours}", PUBLISHED["ate_cm"], ate, OF_THE_PAPER, runs_of),
        table(f"Table 2: RPE RMSE in cm/s; {ours}", PUBLISHED["rpe_cm_per_s"], rpe, OF_THE_PAPER, runs_of),
        table(f"Static rooms: ATE RMSE in cm; {ours}", PUBLISHED["static_ate_cm"], ate, STATIC, runs_of),
    ]
    return "\n".join(part for part in parts if part)
