"""Pieces of work as an array job of Slurm, one task each."""
import json
import re
import shlex
import subprocess
import sys
import time
from pathlib import Path

from benchmarking.work import complete, do, failure, outcome, read_list, write_list, write_whole

LONGEST_PAUSE = 15  # seconds between two questions to the controller
PATIENCE = 600  # seconds without an answer after which it is given up
USUAL_ARRAY_SIZE = 1001  # Slurm's MaxArraySize, where the controller does not tell
PROGRAM = Path(__file__).resolve().parents[1] / "benchmark"


class SlurmError(RuntimeError):
    pass


def say(text):
    print(f"benchmark: {text}", file=sys.stderr, flush=True)


def call(*command):
    try:
        return subprocess.run([str(part) for part in command], capture_output=True, text=True)
    except FileNotFoundError as error:
        raise SlurmError(
            f"{command[0]}: not found; Slurm's programs have to be installed where --slurm is used"
        ) from error


def array_size():
    found = re.search(r"MaxArraySize\s*=\s*(\d+)", call("scontrol", "show", "config").stdout)
    return int(found[1]) if found else USUAL_ARRAY_SIZE


def is_over(job):
    """Whether nothing of the job waits or runs. None: the controller does not answer."""
    asked = call("squeue", "--noheader", "--jobs", job, "--format", "%i")
    if asked.returncode == 0:
        return not asked.stdout.strip()
    return True if "Invalid job id" in asked.stderr else None


def wait_for(job):
    pause, answered = 0.5, time.monotonic()
    while True:
        over = is_over(job)
        if over:
            return
        if over is not None:
            answered = time.monotonic()
        elif time.monotonic() - answered > PATIENCE:
            raise SlurmError(f"Slurm's controller does not answer; job {job} goes on, and the same command collects it")
        time.sleep(pause)
        pause = min(1.5 * pause, LONGEST_PAUSE)


def submit(works, options, folder):
    """@return the number of the job. Its task i does the works i, i + size, i + 2 size, ... of the list."""
    for work in works:
        work.result_file.unlink(missing_ok=True)
    size = min(len(works), array_size())
    works_file, script = folder / "works.json", folder / "job.sh"
    write_list(works_file, works)
    command = [sys.executable, PROGRAM, "--do", works_file]
    script.write_text(
        "#!/bin/sh\n# written by tools/benchmark --slurm\n"
        f"exec {shlex.join(str(part) for part in command)} $SLURM_ARRAY_TASK_ID {size}\n"
    )
    sent = call(
        "sbatch",
        "--parsable",
        "--job-name=posefusion",
        f"--array=0-{size - 1}",
        f"--output={folder}/%A_%a.log",
        *shlex.split(options),
        script,
    )
    if sent.returncode != 0:
        raise SlurmError((sent.stderr.strip() or "sbatch failed").splitlines()[-1])
    return sent.stdout.strip().split(";")[0]


def do_share(works_file, first, step):
    """What a task of the array does.  @return exit status"""
    works = read_list(Path(works_file))[first::step]
    return 1 if any("error" in do(work) for work in works) else 0


def run_on_cluster(works, options, folder):
    """@param options  of sbatch, as one string
    @return results in the order of the works. Jobs of an earlier call that still wait or run are waited for."""
    folder.mkdir(parents=True, exist_ok=True)
    job_file = folder / "job.json"
    if job_file.exists():
        job = json.loads(job_file.read_text())["job"]
        if is_over(job) is not True:
            say(f"waiting for job {job} of an earlier call")
            wait_for(job)
    missing = [work for work in works if not complete(work)]
    job = None
    if missing:
        job = submit(missing, options, folder)
        write_whole(job_file, json.dumps({"job": job}))
        say(f"job {job}: {len(missing)} of {len(works)} runs; scancel {job} stops it, squeue shows it")
        wait_for(job)
    return [outcome(work) or failure(work, f"no result; see {folder}/{job}_*.log") for work in works]
