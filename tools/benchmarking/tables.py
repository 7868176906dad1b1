"""Results as tables in Markdown: a row a run, or a row for all seeds of a recording and variant."""
import statistics

from benchmarking.confidence import interval


def value(result, *path):
    for key in path:
        if not isinstance(result, dict) or result.get(key) is None:
            return None
        result = result[key]
    return result


def shown(number, factor=1.0, digits=2):
    return "-" if number is None else f"{factor * number:.{digits}f}"


def ate(result):
    return value(result, "evaluation", "ate", "translation_m", "rmse")


def rpe(result):
    return value(result, "evaluation", "rpe", "translation_m_per_s", "rmse")


def markdown(columns, rows, texts):
    """@param texts  number of columns at the left that are text"""
    lines = [
        "| " + " | ".join(columns) + " |",
        "|" + "|".join(["---"] * texts + ["---:"] * (len(columns) - texts)) + "|",
    ]
    lines += ["| " + " | ".join(cell.replace("|", "/") for cell in row) + " |" for row in rows]
    return "\n".join(lines) + "\n"


COLUMNS = (
    "recording",
    "variant",
    "frames",
    "ATE RMSE cm",
    "of true masks",
    "RPE cm/s",
    "RPE deg/s",
    "from start cm",
    "ghosts %",
    "lost",
    "ms/frame",
    "peak MiB",
    "surfels",
)


def row(result, with_masks):
    if "error" in result:
        return [result["recording"], result["variant"], f"failed: {result['error']}"] + ["-"] * (len(COLUMNS) - 3)
    reference = ate(with_masks) if with_masks else None
    return [
        result["recording"],
        result["variant"],
        str(result["summary"]["frames"]),
        shown(ate(result), 100),
        shown(ate(result) / reference) if ate(result) is not None and reference else "-",
        shown(rpe(result), 100),
        shown(value(result, "evaluation", "rpe", "rotation_deg_per_s", "rmse")),
        shown(value(result, "evaluation", "max_distance_from_start_m"), 100),
        shown(value(result, "map", "by_first_pose", "fraction"), 100, 3),
        str(result["summary"]["tracking_failures"]),
        shown(value(result, "summary", "frame_time", "median_ms"), 1, 0),
        shown(result["peak_bytes"], 1 / 2**20, 0),
        str(result["summary"]["stable_surfels"]),
    ]


def table_of_runs(results):
    masks = {r["recording"]: r for r in results if r["variant"] == "masks"}
    return markdown(COLUMNS, [row(r, masks.get(r["recording"])) for r in results], 2)


# What is compared over seeds: (heading, factor, digits, value of a result).
MEASURES = (
    ("ATE RMSE cm", 100, 2, ate),
    ("RPE cm/s", 100, 2, rpe),
    ("RPE deg/s", 1, 2, lambda r: value(r, "evaluation", "rpe", "rotation_deg_per_s", "rmse")),
    ("ghosts %", 100, 3, lambda r: value(r, "map", "by_first_pose", "fraction")),
    ("ms/frame", 1, 0, lambda r: value(r, "summary", "frame_time", "median_ms")),
)


def groups(results):
    """{(recording, variant): results of all its seeds}, in the order of the results."""
    found = {}
    for result in results:
        found.setdefault((result["recording"], result["variant"]), []).append(result)
    return found


def values_of(runs, measure):
    return [number for number in (measure(run) for run in runs if "error" not in run) if number is not None]


def with_interval(values, factor, digits):
    mean, half = interval(values)
    return shown(mean, factor, digits) + (f" ± {shown(half, factor, digits)}" if half is not None else "")


def table_over_seeds(results):
    """Means with their 95 % intervals, and the median of the ATE: one lost run moves a mean far."""
    columns = ["recording", "variant", "runs", "failed", "median ATE cm", *(measure[0] for measure in MEASURES)]
    rows = []
    for (recording, variant), runs in groups(results).items():
        ates = values_of(runs, ate)
        rows.append(
            [
                recording,
                variant,
                str(len(runs)),
                str(sum(1 for run in runs if "error" in run)),
                shown(statistics.median(ates) if ates else None, 100),
                *(with_interval(values_of(runs, of), factor, digits) for _, factor, digits, of in MEASURES),
            ]
        )
    failures = [run for run in results if "error" in run]
    text = markdown(columns, rows, 2)
    return text + "".join(
        f"\nfailed: {run['recording']}, {run['variant']}, seed {run['seed']}: {run['error']}\n" for run in failures
    )
