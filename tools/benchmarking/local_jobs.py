"""Pieces of work on this machine, several at a time."""
import os
from concurrent.futures import ThreadPoolExecutor

from benchmarking.work import do, outcome


def run_here(works, jobs):
    """@param jobs  runs at a time, which share the processors
    @return results in the order of the works. After an interruption nothing new is begun, and KeyboardInterrupt is
    raised when what was running has saved what it has."""
    if jobs > 1:  # the software driver takes all processors otherwise, once per run
        os.environ.setdefault("LP_NUM_THREADS", str(max(1, (os.cpu_count() or 1) // jobs)))
    pool = ThreadPoolExecutor(max_workers=jobs)
    try:
        return list(pool.map(do, works))
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def what_is_there(works):
    """Results of those works that have one."""
    return [result for result in map(outcome, works) if result]
