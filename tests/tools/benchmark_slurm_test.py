"""tools/benchmark --slurm on a Slurm of one node, which the test starts; skipped where Slurm is not installed."""
import getpass
import os
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

sys.dont_write_bytecode = True
from benchmark_programs import WithPrograms

os.environ["PATH"] += ":/usr/sbin:/sbin"  # where Debian has the daemons
DAEMONS = ("munged", "slurmctld", "slurmd")
MISSING = [program for program in (*DAEMONS, "sbatch", "squeue", "scontrol") if not shutil.which(program)]
PATIENCE = 30  # seconds

CONFIGURATION = """ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={controller_port}
SlurmdPort={node_port}
AuthInfo=socket={folder}/munge.socket
SlurmUser={user}
SlurmdUser={user}
StateSaveLocation={folder}
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=sched_min_interval=0
NodeName={host} NodeAddr=127.0.0.1 CPUs={processors} State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES State=UP
"""


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def wait_until(condition):
    deadline = time.monotonic() + PATIENCE
    while not condition():
        if time.monotonic() > deadline:
            return False
        time.sleep(0.1)
    return True


class Cluster:
    """Of this machine alone, with keys and ports of its own."""

    def __init__(self):
        self.folder = tempfile.TemporaryDirectory()
        self.daemons = []

    def start(self):
        """@return the fault, empty if jobs can be sent"""
        folder = Path(self.folder.name)
        key = folder / "munge.key"
        key.write_bytes(os.urandom(1024))
        key.chmod(0o400)
        configuration = folder / "slurm.conf"
        configuration.write_text(
            CONFIGURATION.format(
                host=socket.gethostname().split(".")[0],
                controller_port=free_port(),
                node_port=free_port(),
                folder=folder,
                user=getpass.getuser(),
                processors=os.cpu_count(),
            )
        )
        os.environ["SLURM_CONF"] = str(configuration)
        files = {"key-file": key, "socket": folder / "munge.socket", "pid-file": folder / "munged.pid"}
        files |= {"log-file": folder / "munged.log", "seed-file": folder / "munged.seed"}
        self.run("munged", "--foreground", "--force", *(f"--{name}={file}" for name, file in files.items()))
        if not wait_until((folder / "munge.socket").exists):
            return "munged does not start"
        self.run("slurmctld", "-D")
        self.run("slurmd", "-D")
        states = ("sinfo", "--noheader", "--format", "%t")
        ready = lambda: subprocess.run(states, capture_output=True, text=True).stdout.strip() == "idle"
        return "" if wait_until(ready) else "the node does not become idle"

    def run(self, *command):
        log = open(Path(self.folder.name) / f"{command[0]}.out", "w")
        with log:
            self.daemons.append(subprocess.Popen(command, stdout=log, stderr=log, start_new_session=True))

    def stop(self):
        for daemon in reversed(self.daemons):
            daemon.terminate()
            daemon.wait()
        self.folder.cleanup()


@unittest.skipIf(MISSING, f"{', '.join(MISSING)}: not installed (Debian's slurm-wlm)")
class Slurm(WithPrograms):
    @classmethod
    def setUpClass(cls):
        cls.cluster = Cluster()
        cls.addClassCleanup(cls.cluster.stop)
        fault = cls.cluster.start()
        if fault:
            raise unittest.SkipTest(f"Slurm cannot be started here: {fault}")

    def test_runs_are_tasks_of_an_array_and_what_is_missing_is_sent_again(self):
        self.recording("data/walk", masks=True)
        self.recording("data/broken")
        done = self.benchmark("--slurm=--time=5", "--variants", "default", "masks", "--seeds", "2")
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("6 of 6 runs", done.stderr)
        self.assertEqual(len(self.runs()), 6)
        self.assertEqual(self.cells(done.stdout, "walk", "masks")[2:5], ["2", "0", "1.73"])
        self.assertIn(
            "failed: broken, default, seed 2: error: the recording / is broken", done.stdout.replace("|", "/")
        )
        again = self.benchmark("--slurm", "--variants", "default", "masks", "--seeds", "2")
        self.assertIn("2 of 6 runs", again.stderr)
        self.assertEqual(len([run for run in self.runs() if "broken" in run]), 4)
        self.assertEqual(len(self.runs()), 8)

    def test_jobs_of_an_interrupted_call_are_waited_for(self):
        self.recording("data/slow_walk")
        options = ("--data", self.root / "data", "--slurm", "--variants", "default")
        first = subprocess.Popen(self.command(*options), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.assertTrue(wait_until(self.runs), "the job does not start")
        first.send_signal(signal.SIGINT)
        self.assertIn("jobs of Slurm go on", first.communicate()[1])
        self.assertEqual(first.returncode, 130)
        again = subprocess.Popen(self.command(*options), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.assertIn("of an earlier call", again.stderr.readline())
        (self.root / "build/go").write_text("")
        out, err = again.communicate()
        self.assertEqual(again.returncode, 0, err)
        self.assertEqual(self.cells(out, "slow_walk", "default")[2], "42")
        self.assertEqual(len(self.runs()), 1)

    def test_what_slurm_does_not_take_is_told(self):
        self.recording("data/walk")
        done = self.benchmark("--slurm=--partition=none")
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, "benchmark: sbatch: error: .*partition")


if __name__ == "__main__":
    unittest.main()
