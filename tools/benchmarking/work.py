"""A piece of work of a benchmark: one recording, one variant, one seed. It has a folder of its own, in which its result
is kept, and is complete when it finished with the same program, recording and options."""
import fcntl
import hashlib
import json
import os
import re
import subprocess
import sys
import time
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from pathlib import Path

RESULT = "benchmark.json"


@dataclass
class Work:
    name: str  # of the recording, in the table
    variant: str
    seed: int
    recording: str  # its folder
    options: list  # of `posefusion run`
    folder: str  # where the run goes
    posefusion: str  # the programs
    evaluate_map: str
    timeout: float  # seconds
    key: dict  # what must be the same for a result to count
    synth: list = field(
        default_factory=list
    )  # options of `posefusion synth` that make the recording; empty: it is there

    @property
    def result_file(self):
        return Path(self.folder) / RESULT

    def label(self):
        return f"{self.name}, {self.variant}" + (f", seed {self.seed}" if self.seed > 1 else "")


def checksum(file):
    return hashlib.sha256(file.read_bytes()).hexdigest()


def write_whole(file, text):
    """A reader sees the old file or the new one, whatever happens in between."""
    temporary = file.with_suffix(".tmp")
    temporary.write_text(text)
    temporary.replace(file)


def write_list(file, works):
    write_whole(file, json.dumps([asdict(work) for work in works], indent=1))


def read_list(file):
    return [Work(**entry) for entry in json.loads(file.read_text())]


def outcome(work):
    """What the last attempt came to; None if there was none with this program, recording and options."""
    try:
        known = json.loads(work.result_file.read_text())
    except (OSError, ValueError):
        return None
    return known if known.get("key") == work.key else None


def complete(work):
    """The result of a finished run, None if it has to be run."""
    known = outcome(work)
    return known if known and "error" not in known else None


def failure(work, error):
    return {"key": work.key, "recording": work.name, "variant": work.variant, "seed": work.seed, "error": error}


def execute(command, log, timeout):
    """Runs a command. Returns (exit status, seconds, peak resident bytes)."""
    start = time.monotonic()
    with open(log, "wb") as out:
        process = subprocess.Popen(command, stdout=out, stderr=subprocess.STDOUT)
        try:
            while True:
                pid, status, usage = os.wait4(process.pid, os.WNOHANG)
                if pid:
                    break
                if time.monotonic() - start > timeout:
                    process.kill()
                time.sleep(0.05)
        except KeyboardInterrupt:  # the child has got it as well and saves what it has
            os.waitpid(process.pid, 0)
            raise
    return os.waitstatus_to_exitcode(status), time.monotonic() - start, usage.ru_maxrss * 1024


def last_line(log):
    lines = re.split(r"[\r\n]", log.read_text(errors="replace"))
    lines = [re.sub(r"\x1b\[[0-9;]*[A-Za-z]", "", line).strip() for line in lines]
    return next((line for line in reversed(lines) if line), "")


def json_of(*command):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    if done.returncode != 0:
        return {"error": done.stderr.strip().split("\n")[-1]}
    return json.loads(done.stdout)


@contextmanager
def alone(file):
    """Others that want the same file wait; on other machines of a cluster, too."""
    file.parent.mkdir(parents=True, exist_ok=True)
    with open(file, "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def make_recording(work):
    """@return the error, empty if the recording is there"""
    folder = Path(work.recording)
    with alone(folder.with_name(folder.name + ".lock")):
        if folder.is_dir():
            return ""
        part = folder.with_name(folder.name + ".part")
        command = [work.posefusion, "synth", "--out", str(part), *work.synth]
        log = folder.with_name(folder.name + ".log")
        status, _, _ = execute(command, log, work.timeout)
        if status != 0:
            return last_line(log) or f"synth: exit status {status}"
        part.rename(folder)
        return ""


def measured(work, status, seconds, peak):
    folder, recording = Path(work.folder), Path(work.recording)
    result = {
        "key": work.key,
        "recording": work.name,
        "variant": work.variant,
        "seed": work.seed,
        "status": status,
        "seconds": seconds,
        "peak_bytes": peak,
    }
    if status != 0:
        return {**result, "error": last_line(folder / "log.txt") or f"exit status {status}"}
    stats = json.loads((folder / "stats.json").read_text())
    result["summary"] = stats["summary"]
    result["device"] = stats["device"]["name"]
    truth = recording / "groundtruth.txt"
    if truth.exists():
        result["evaluation"] = json_of(work.posefusion, "evaluate", truth, folder / "trajectory.txt", "--json")
        if (recording / "masks").is_dir():
            result["map"] = json_of(work.evaluate_map, recording, folder, "--json")
    return result


def do(work):
    """Does what is missing and keeps its result, that of a failure as well: it is tried again next time."""
    known = complete(work)
    if known:
        return known
    print(f"benchmark: {work.label()} ...", file=sys.stderr, flush=True)
    folder = Path(work.folder)
    folder.mkdir(parents=True, exist_ok=True)
    work.result_file.unlink(missing_ok=True)
    error = make_recording(work) if work.synth else ""
    if error:
        result = failure(work, error)
    else:
        command = [work.posefusion, "run", work.recording, "--out", work.folder, *work.options]
        result = measured(work, *execute(command, folder / "log.txt", work.timeout))
    write_whole(work.result_file, json.dumps(result, indent=1))
    return result
