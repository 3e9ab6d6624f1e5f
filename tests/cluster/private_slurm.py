"""A Slurm of its own on one machine: munged, slurmctld and slurmd in a private folder, on private ports of loopback.

Run by itself, it starts one and a shell in which sbatch, squeue, sinfo … speak to it:  private_slurm.py [COMMAND…]
"""

import os
import pathlib
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time

NEEDED = ("munged", "slurmctld", "slurmd", "sbatch", "squeue", "scancel", "scontrol")


def missing():
    """The programs that are not there, and root, who alone can start all of them."""
    path = os.environ.get("PATH", "") + ":/usr/sbin:/sbin"
    lacking = [name for name in NEEDED if shutil.which(name, path=path) is None]
    return lacking + ([] if os.geteuid() == 0 else ["root"])


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    for one in sockets:
        one.bind(("127.0.0.1", 0))
    ports = [one.getsockname()[1] for one in sockets]
    for one in sockets:
        one.close()
    return ports


class PrivateSlurm:
    """With it, `environment` is what its commands need. Daemons end with it."""

    def __init__(self, cpus=2, memory_mb=4000, max_array=1001, settings=""):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="slurm-"))
        self.cpus, self.memory_mb, self.max_array, self.settings = cpus, memory_mb, max_array, settings
        self.daemons = {}
        self.host = socket.gethostname().split(".")[0]
        self.environment = dict(os.environ, SLURM_CONF=str(self.folder / "slurm.conf"))
        self.environment["PATH"] += ":/usr/sbin:/sbin"

    def __enter__(self):
        try:
            self.start()
        except BaseException:
            self.stop()
            raise
        return self

    def __exit__(self, *_):
        self.stop()

    def write_settings(self):
        controller, node = free_ports(2)
        host = self.host
        for name in ("munge", "state", "spool"):
            (self.folder / name).mkdir()
        self.folder.chmod(0o755)
        (self.folder / "munge").chmod(0o755)
        key = self.folder / "munge" / "key"
        key.write_bytes(os.urandom(1024))
        key.chmod(0o400)
        (self.folder / "slurm.conf").write_text(f"""
ClusterName=private
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={controller}
SlurmdPort={node}
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket={self.folder}/munge/socket
CredType=cred/munge
StateSaveLocation={self.folder}/state
SlurmdSpoolDir={self.folder}/spool
SlurmctldPidFile={self.folder}/slurmctld.pid
SlurmdPidFile={self.folder}/slurmd.pid
SlurmctldLogFile={self.folder}/slurmctld.log
SlurmdLogFile={self.folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
JobCompType=jobcomp/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU_Memory
SchedulerType=sched/backfill
SchedulerParameters=batch_sched_delay=0,sched_interval=1,bf_interval=1
MaxArraySize={self.max_array}
MaxJobCount=20000
MinJobAge=300
ReturnToService=2
KillWait=1
SlurmdTimeout=30
InactiveLimit=0
DefMemPerCPU=256
{self.settings}
NodeName={host} NodeAddr=127.0.0.1 CPUs={self.cpus} RealMemory={self.memory_mb} State=UNKNOWN
PartitionName=all Nodes={host} Default=YES MaxTime=INFINITE State=UP
PartitionName=other Nodes={host} MaxTime=INFINITE State=UP
""", encoding="utf-8")

    def start(self):
        self.write_settings()
        munge = self.folder / "munge"
        self.run_daemon("munged", ["munged", "--foreground", "--force", f"--key-file={munge}/key",
                                   f"--socket={munge}/socket", f"--pid-file={munge}/pid",
                                   f"--log-file={munge}/log", f"--seed-file={munge}/seed", "--num-threads=2"])
        self.wait_until(lambda: (munge / "socket").exists(), "munged does not answer")
        self.start_controller()
        self.start_node()
        self.wait_until(lambda: self.state() in ("idle", "mixed"), "the node does not come up")

    def run_daemon(self, name, command):
        with open(self.folder / f"{name}.out", "ab") as out:
            self.daemons[name] = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=out, stderr=out,
                                                  env=self.environment, start_new_session=True)

    def start_controller(self):
        self.run_daemon("slurmctld", ["slurmctld", "-D", "-f", str(self.folder / "slurm.conf")])

    def start_node(self):
        self.run_daemon("slurmd", ["slurmd", "-D", "-f", str(self.folder / "slurm.conf")])

    def end_daemon(self, name, how=signal.SIGTERM):
        daemon = self.daemons.pop(name, None)
        if daemon is None:
            return
        daemon.send_signal(how)
        try:
            daemon.wait(20)
        except subprocess.TimeoutExpired:
            daemon.kill()
            daemon.wait()

    def state(self):
        return self.say("sinfo", "-h", "-o", "%T").split("\n")[0].rstrip("*").strip()

    def say(self, *command):
        return subprocess.run(command, env=self.environment, capture_output=True, text=True, check=False).stdout

    def wait_until(self, holds, otherwise, longest=40):
        end = time.monotonic() + longest
        while time.monotonic() < end:
            if holds():
                return
            time.sleep(0.1)
        logs = "\n".join(f"--- {log.name}\n{log.read_text(errors='replace')[-2000:]}"
                         for log in (*self.folder.glob("*.log"), *self.folder.glob("*.out")))
        raise RuntimeError(f"{otherwise}\n{logs}")

    def stop(self):
        if "slurmctld" in self.daemons:
            self.say("scancel", "--user=root")
            end = time.monotonic() + 10
            while self.say("squeue", "-h").strip() and time.monotonic() < end:
                time.sleep(0.2)
        for name in ("slurmd", "slurmctld", "munged"):
            self.end_daemon(name)
        shutil.rmtree(self.folder, ignore_errors=True)


if __name__ == "__main__":
    if missing():
        sys.exit(f"not there: {', '.join(missing())}")
    with PrivateSlurm() as slurm:
        sys.exit(subprocess.run(sys.argv[1:] or ["bash"], env=slurm.environment, check=False).returncode)
