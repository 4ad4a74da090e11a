# SPDX-License-Identifier: MIT
"""Every test of tests/slow_tests.txt is there, and carries the label `slow`.
Usage: slow_tests_test.py CTEST BUILD ROOT"""
import re
import subprocess
import sys
import tempfile

ctest, build, root = sys.argv[1:]
with tempfile.TemporaryDirectory() as folder:  # in the build's own folder it would write over the log of the run that it is of
    with open(folder + "/CTestTestfile.cmake", "w", encoding="utf-8") as f:
        f.write(f'subdirs("{build}/tests")\n')
    listed = subprocess.run([ctest, "--test-dir", folder, "-N", "-L", "slow"], capture_output=True, text=True, check=True).stdout
there = set(re.findall(r"Test +#\d+: (\S+)", listed))
with open(root + "/tests/slow_tests.txt", encoding="utf-8") as f:
    named = {line.strip() for line in f if line.strip() and not line.startswith("#")}
# What this machine can't build is not there.
built = {name.split("/")[0] for name in there}
for name in sorted(named - there):
    if name.split("/")[0] in built:
        print(name + ": in slow_tests.txt and no test")
        sys.exit(1)
print(len(there), "slow tests")
