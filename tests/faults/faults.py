#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Faults from outside lose nothing: old outputs stay or are replaced whole, one sentence says why.

    faults.py BATTEN SOURCE [TestCase.test ...]

BATTEN is the program, SOURCE the project. Some minutes. What the machine does not allow is skipped."""
import json
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

BATTEN = SOURCE = ""
OLD = b"what stood there before\n"
LINE_LIMIT = 400  # characters of a sentence that can be read at a glance


class Fault(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="batten-faults-")
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        self.panel = os.path.join(SOURCE, "data/panel.ply")

    def path(self, name):
        return os.path.join(self.folder, name)

    def run_program(self, *arguments, limits=(), **options):
        def prepare():
            for what, most in limits:
                resource.setrlimit(what, (most, most))

        return subprocess.run([BATTEN, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                              cwd=self.folder, preexec_fn=prepare if limits else None, timeout=300, **options)

    def old_outputs(self, *names):
        for name in names:
            with open(self.path(name), "wb") as file:
                file.write(OLD)

    def read(self, name):
        with open(self.path(name), "rb") as file:
            return file.read()

    def assert_old(self, *names):
        for name in names:
            self.assertEqual(self.read(name), OLD, name)

    def assert_one_sentence(self, done, code):
        lines = [line for line in done.stderr.splitlines() if line.strip()]
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertEqual(len(lines), 1, done.stderr)
        self.assertLess(len(lines[0]), LINE_LIMIT)

    def assert_nothing_left(self, besides=()):
        left = [name for name in os.listdir(self.folder) if name.startswith(".batten-") and name not in besides]
        self.assertEqual(left, [], "temporary files")


class KilledTest(Fault):
    """At moments spread over the whole run, the writing of all files among them."""

    OUTPUTS = ("part.json", "report.json", "report.html", "points.csv", "proof.json", "sigma.csv")
    STEADY = ("part.json", "points.csv", "proof.json", "sigma.csv")  # without times in them

    def command(self):
        return ["fit", "surface", self.panel, "-o", "part.json", "--report", "report.json", "--report", "report.html",
                "--residuals", "points.csv", "--certificate", "proof.json", "--uncertainty-map", "sigma.csv", "--quiet",
                "--threads", "1"]

    def kill_at(self, seconds, how):
        """The exit code; negative: by the signal."""
        child = subprocess.Popen([BATTEN, *self.command()], cwd=self.folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        try:
            child.wait(seconds)
        except subprocess.TimeoutExpired:
            child.send_signal(how)
        _, error = child.communicate(timeout=120)
        return child.returncode, error

    def test_outputs_are_old_or_new_and_whole(self):
        begin = time.monotonic()
        done = self.run_program(*self.command())
        whole = time.monotonic() - begin
        self.assertEqual(done.returncode, 0, done.stderr)
        new = {name: self.read(name) for name in self.STEADY}
        chance = random.Random(7)
        replaced = 0
        for k in range(60):
            how = (signal.SIGTERM, signal.SIGINT, signal.SIGKILL)[k % 3]
            self.old_outputs(*self.OUTPUTS)
            before = set(os.listdir(self.folder))
            # Half of the moments where files are written.
            at = whole * (chance.uniform(0, 1.05) if k % 2 else chance.uniform(0.6, 1.02))
            code, error = self.kill_at(at, how)
            with self.subTest(at=at, how=how):
                self.assertIn(code, (0, 130, 143, -signal.SIGTERM, -signal.SIGINT, -signal.SIGKILL), error)
                for name in self.OUTPUTS:
                    text = self.read(name)
                    if text == OLD:
                        self.assertNotEqual(code, 0, f"{name}: done, but not written")
                        continue
                    replaced += 1
                    if name in self.STEADY:
                        self.assertEqual(text, new[name], name)
                    elif name.endswith(".json"):
                        json.loads(text)
                    else:
                        self.assertTrue(text.rstrip().endswith(b"</html>"), name)
                if how != signal.SIGKILL:
                    self.assertEqual(set(os.listdir(self.folder)), before)
            for name in set(os.listdir(self.folder)) - before:
                os.unlink(self.path(name))
        print(f"60 kills over {whole:.1f} s: {replaced} of {60 * len(self.OUTPUTS)} files were replaced", flush=True)


class DiskTest(Fault):
    def test_no_room_for_a_file_keeps_the_old_one(self):
        self.old_outputs("part.json", "points.csv", "report.json")
        done = self.run_program("fit", "surface", self.panel, "-o", "part.json", "--residuals", "points.csv", "--report",
                                "report.json", "--quiet", limits=[(resource.RLIMIT_FSIZE, 20000)])
        self.assert_one_sentence(done, 1)
        self.assert_old("part.json", "points.csv", "report.json")
        self.assert_nothing_left()

    def test_a_full_disk_keeps_the_old_files(self):
        disk = self.path("disk")
        os.mkdir(disk)
        mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64k", "none", disk], stderr=subprocess.PIPE, text=True)
        if mounted.returncode != 0:
            self.skipTest(mounted.stderr.strip())
        self.addCleanup(subprocess.run, ["umount", disk], check=False)
        self.old_outputs("disk/part.json", "disk/points.csv")
        done = self.run_program("fit", "surface", self.panel, "-o", "disk/part.json", "--residuals", "disk/points.csv", "--quiet")
        self.assert_one_sentence(done, 1)
        self.assert_old("disk/part.json", "disk/points.csv")

    def test_a_device_without_room_is_told(self):
        for name in ("part.json", "points.csv", "report.html"):
            os.symlink("/dev/full", self.path(name))
        for arguments in (("-o", "part.json"), ("-o", "x.json", "--residuals", "points.csv"), ("-o", "x.json", "--report", "report.html")):
            done = self.run_program("fit", "surface", self.panel, *arguments, "--quiet", "--control-points", "8,8")
            self.assert_one_sentence(done, 1)
        with open("/dev/full", "w", encoding="utf-8") as full:
            done = subprocess.run([BATTEN, "fit", "surface", self.panel, "-o", "-", "--output-format", "json", "--quiet", "--control-points", "8,8"], stdout=full,
                                  stderr=subprocess.PIPE, text=True, timeout=100)
        self.assert_one_sentence(done, 1)

    def test_the_folder_is_removed_meanwhile(self):
        os.mkdir(self.path("out"))
        child = subprocess.Popen([BATTEN, "fit", "surface", self.panel, "-o", "out/part.json", "--report", "out/report.html", "--quiet"],
                                 cwd=self.folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        time.sleep(0.15)
        shutil.rmtree(self.path("out"))
        _, error = child.communicate(timeout=120)
        self.assertEqual(child.returncode, 1, error)
        self.assertEqual(len(error.strip().splitlines()), 1, error)
        self.assertIn("out/", error)

    def test_a_folder_of_very_many_files(self):
        os.mkdir(self.path("many"))
        for k in range(1000000):
            os.close(os.open(self.path(f"many/{k}"), os.O_CREAT | os.O_WRONLY))
        begin = time.monotonic()
        done = self.run_program("fit", "surface", self.panel, "-o", "many/part.json", "--report", "many/report.json", "--quiet",
                                "--control-points", "8,8")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertLess(time.monotonic() - begin, 30)


class ReadTest(Fault):
    def test_a_file_that_ends_early(self):
        with open(self.panel, "rb") as file:
            text = file.read()
        for share in (0.999, 0.5, 0.03, 0):
            with open(self.path("cut.ply"), "wb") as file:
                file.write(text[: int(share * len(text))])
            self.old_outputs("part.json")
            done = self.run_program("fit", "surface", "cut.ply", "-o", "part.json", "--quiet")
            self.assert_one_sentence(done, 1)
            self.assertIn("cut.ply", done.stderr)
            self.assert_old("part.json")

    def test_a_device_that_fails_in_the_middle(self):
        # Reading a process's memory from zero on is an input/output error.
        for name in ("cloud.xyz", "cloud.ply", "cloud.pcd", "part.json", "part.step"):
            os.symlink("/proc/self/mem", self.path(name))
        for arguments in (("info", "cloud.xyz"), ("info", "cloud.ply"), ("info", "cloud.pcd"), ("analyze", "part.json"),
                          ("analyze", "part.step")):
            self.assert_one_sentence(self.run_program(*arguments), 1)

    def test_a_pipe_that_breaks_off(self):
        os.mkfifo(self.path("pipe.ply"))
        child = subprocess.Popen([BATTEN, "fit", "surface", "pipe.ply", "-o", "part.json", "--quiet"], cwd=self.folder,
                                 stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        with open(self.panel, "rb") as file, open(self.path("pipe.ply"), "wb") as pipe:
            pipe.write(file.read(30000))
        _, error = child.communicate(timeout=60)
        self.assertEqual(child.returncode, 1, error)
        self.assertIn("pipe.ply", error)
        self.assertFalse(os.path.exists(self.path("part.json")))


class MemoryTest(Fault):
    def test_little_memory_is_told(self):
        self.old_outputs("part.json")
        found = set()
        for most in (80, 120, 160, 200, 240, 280, 320, 400, 600):
            done = self.run_program("fit", "surface", self.panel, "-o", "part.json", "--threads", "1", "--quiet",
                                    limits=[(resource.RLIMIT_AS, most << 20)])
            found.add(done.returncode)
            with self.subTest(megabytes=most):
                if done.returncode == 127:
                    continue  # the system's loader had no room for the libraries
                self.assertIn(done.returncode, (0, 1), done.stderr)
                if done.returncode == 1:
                    self.assert_one_sentence(done, 1)
                    self.assert_old("part.json")
                    self.assert_nothing_left()
        self.assertIn(0, found)


# Wall clocks that are set back and forth by twenty years between any two looks at them.
JUMPING_CLOCK = """
#define _GNU_SOURCE
#include <sys/syscall.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>
static long Jump(void) { static long looks; return (__sync_add_and_fetch(&looks, 1) % 3 - 1) * 630720000L; }
int clock_gettime(clockid_t clock, struct timespec* now) {
  int failed = (int)syscall(SYS_clock_gettime, clock, now);
  if (!failed && clock == CLOCK_REALTIME) now->tv_sec += Jump();
  return failed;
}
int gettimeofday(struct timeval* restrict now, void* restrict zone) {
  int failed = (int)syscall(SYS_gettimeofday, now, zone);
  if (!failed) now->tv_sec += Jump();
  return failed;
}
time_t time(time_t* place) {
  struct timespec now;
  clock_gettime(CLOCK_REALTIME, &now);
  if (place) *place = now.tv_sec;
  return now.tv_sec;
}
"""


class ClockTest(Fault):
    def test_jumps_of_the_clock_change_nothing(self):
        with open(self.path("jump.c"), "w", encoding="ascii") as file:
            file.write(JUMPING_CLOCK)
        made = subprocess.run(["cc", "-shared", "-fPIC", "-O1", "-o", "jump.so", "jump.c"], cwd=self.folder, stderr=subprocess.PIPE, text=True)
        if made.returncode != 0:
            self.skipTest(made.stderr.strip())
        command = ["fit", "surface", self.panel, "--time-limit", "200", "--threads", "2", "--report", "report.html"]
        steady = self.run_program(*command, "-o", "steady.json", "--report", "steady-report.json")
        begin = time.monotonic()
        jumping = self.run_program(*command, "-o", "jumping.json", "--report", "jumping-report.json",
                                   env={**os.environ, "LD_PRELOAD": self.path("jump.so")})
        whole = time.monotonic() - begin
        self.assertEqual((steady.returncode, jumping.returncode), (0, 0), steady.stderr + jumping.stderr)
        self.assertEqual(self.read("jumping.json"), self.read("steady.json"))
        seconds = json.loads(self.read("jumping-report.json"))["seconds"]
        self.assertTrue(all(0 <= value <= whole for value in seconds.values()), seconds)


if __name__ == "__main__":
    BATTEN, SOURCE = (os.path.abspath(path) for path in sys.argv[1:3])
    unittest.main(argv=sys.argv[:1] + sys.argv[3:], verbosity=2)
