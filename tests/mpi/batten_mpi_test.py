# SPDX-License-Identifier: MIT
"""Laws of batten-mpi: the answer of one process, the same bytes for the same number, nothing written when one dies.
Usage: batten_mpi_test.py BATTEN BATTEN_MPI MPIRUN"""
import array
import json
import math
import os
import random
import signal
import subprocess
import sys
import tempfile
import time

BATTEN, BATTEN_MPI, MPIRUN = sys.argv[1:4]
POINTS = 160000  # more than --memory 34MB holds
MEMORY = ["--memory", "34MB", "--trim", "none", "--threads", "1"]
TILES = ["--tiles", "2x2", "--tile-faces", "one", "--trim", "none", "--threads", "1"]


def write_cloud(path, points, seed):
    draw = random.Random(seed)
    header = f"ply\nformat binary_little_endian 1.0\nelement vertex {points}\n" \
             "property double x\nproperty double y\nproperty double z\nend_header\n"
    numbers = array.array("d")
    for _ in range(points):
        x, y = 10 * draw.random(), 6 * draw.random()
        numbers.extend((x, y, math.sin(0.7 * x) + 0.5 * math.cos(0.9 * y) + 0.01 * draw.gauss(0, 1)))
    with open(path, "wb") as file:
        file.write(header.encode())
        numbers.tofile(file)


ENVIRONMENT = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1",
                   OMPI_MCA_rmaps_base_oversubscribe="1", OMPI_MCA_btl_vader_single_copy_mechanism="none")


def shared(processes, words, **more):
    return subprocess.run([MPIRUN, "-n", str(processes), BATTEN_MPI] + words, env=ENVIRONMENT, capture_output=True, text=True,
                          timeout=200, **more)


def killed(processes, words, when):
    """The job, one of whose processes is killed when `when` says so; None where it was done before."""
    job = subprocess.Popen([MPIRUN, "-n", str(processes), BATTEN_MPI] + words, env=ENVIRONMENT, stdout=subprocess.PIPE,
                           stderr=subprocess.PIPE, text=True)
    while job.poll() is None and not when():
        time.sleep(0.005)
    children = subprocess.run(["ps", "--ppid", str(job.pid), "-o", "pid="], capture_output=True, text=True).stdout.split()
    hit = job.poll() is None and bool(children)
    if hit:
        os.kill(int(children[-1]), signal.SIGKILL)
    job.communicate(timeout=60)
    return job.returncode if hit else None


def net(path):
    entry = json.load(open(path))["shape"]["data"][0]
    return [x for point in entry["control_points"]["points"] for x in point] + entry["knotvector_u"] + entry["knotvector_v"]


def require(condition, what):
    if not condition:
        sys.exit("failed: " + what)


def main():
    with tempfile.TemporaryDirectory() as folder:
        parts = [os.path.join(folder, f"part-{k}.ply") for k in range(3)]
        for k, part in enumerate(parts):
            write_cloud(part, POINTS // 3, k)
        out = lambda name: os.path.join(folder, name)
        alone = subprocess.run([BATTEN, "fit", "surface", *parts, "-o", out("alone.json"), *MEMORY], capture_output=True, text=True)
        require(alone.returncode == 0, "one process: " + alone.stderr)
        for processes, files in ((2, parts), (3, parts), (4, parts)):  # files for each, and pieces of the same
            for name in ("first", "second"):
                run = shared(processes, ["fit", "surface", *files, "-o", out(f"{name}.json"), "--report", out(f"{name}.rep.json"), *MEMORY])
                require(run.returncode == 0, f"{processes} processes: {run.stderr}")
                require(run.stdout.count("control points") == 1, "the first process alone speaks: " + run.stdout)
            first, second = open(out("first.json")).read(), open(out("second.json")).read()
            require(first == second, f"{processes} processes give the same bytes each time")
            a, b = net(out("alone.json")), net(out("first.json"))
            require(len(a) == len(b), "as many control points")
            worst = max(abs(x - y) for x, y in zip(a, b))
            require(worst < 1e-11, f"{processes} processes differ from one by {worst}")  # 1e-12 of the size
            report = json.load(open(out("first.rep.json")))
            require(report["input"]["points"] == 3 * (POINTS // 3), "all points are counted")
            print(f"{processes} processes: largest difference from one {worst:.2g}")
        # One of the files is cut short: the job ends, and nothing is written.
        os.truncate(parts[1], os.path.getsize(parts[1]) - 100000)
        run = shared(3, ["fit", "surface", *parts, "-o", out("never.json"), *MEMORY])
        require(run.returncode != 0 and "part-1.ply" in run.stderr, "a file cut short ends the job: " + run.stderr)
        require(not os.path.exists(out("never.json")), "nothing is written")
        write_cloud(parts[1], POINTS // 3, 1)
        # A process that is killed ends the job.
        begin = time.monotonic()
        ended = killed(2, ["fit", "surface", *parts, "-o", out("never.json"), *MEMORY], lambda: time.monotonic() > begin + 0.7)
        if ended is not None:
            require(ended != 0, "a process that dies ends the job")
            left = [name for name in os.listdir(folder) if "never" in name]
            require(not left, f"nothing half-written is left: {left}")
        # With --checkpoint it goes on after the last finished pass, to the bytes of a job that was never killed.
        for flags, name in ((MEMORY, "second"), (TILES, "tiles")):
            job = ["fit", "surface", *parts, *flags]
            run = shared(2, [*job, "-o", out(f"{name}.json")])
            require(run.returncode == 0, f"two processes: {run.stderr}")
            words = [*job, "-o", out("resumed.json"), "--checkpoint", out("passes")]
            ended = killed(2, words, lambda: os.path.exists(out("passes/pass-2")))
            require(ended is None or ended != 0, "a process that dies ends the job")
            run = shared(2, words)
            require(run.returncode == 0, f"a job that goes on: {run.stderr}")
            require(ended is None or "finished passes" in run.stderr, "it says that it goes on: " + run.stderr)
            require(open(out("resumed.json")).read() == open(out(f"{name}.json")).read(), f"{name}: the same bytes after a kill")
            require(not os.path.exists(out("passes")), "finished passes are removed when the job is done")
            run = shared(3, [*job, "-o", out("other.json")])
            require(run.returncode == 0, f"three processes: {run.stderr}")
            a, b = net(out("other.json")), net(out(f"{name}.json"))
            require(len(a) == len(b) and max(abs(x - y) for x, y in zip(a, b)) < 1e-9, f"{name}: two processes are as three")


main()
