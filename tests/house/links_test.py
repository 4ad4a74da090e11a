# SPDX-License-Identifier: MIT
"""Every link of the documents leads to a file that is there and, with #, to a heading of it.
Usage: links_test.py ROOT"""
import glob
import os
import re
import sys

root = os.path.abspath(sys.argv[1])


def prose(path):
    with open(path, encoding="utf-8") as f:
        return re.sub(r"^```.*?^```", "", f.read(), flags=re.S | re.M)


def anchors(path):
    """As GitHub makes them of headings."""
    heads = re.findall(r"^#+ (.*)$", prose(path), re.M)
    return {re.sub(r"[^\w\- ]", "", head.lower()).strip().replace(" ", "-") for head in heads}


broken, count = [], 0
for page in sorted(glob.glob(root + "/*.md") + glob.glob(root + "/docs/**/*.md", recursive=True) + glob.glob(root + "/*/README.md")):
    for target in re.findall(r"\]\(([^)\s]+)\)", prose(page)):
        if re.match(r"\w+:", target):
            continue
        count += 1
        path, _, anchor = target.partition("#")
        file = os.path.join(os.path.dirname(page), path) if path else page
        if not os.path.exists(file):
            broken.append(f"{os.path.relpath(page, root)}: {target} is not there")
        elif anchor and anchor not in anchors(file):
            broken.append(f"{os.path.relpath(page, root)}: {target} has no such heading")
if broken or count < 50:
    sys.exit("\n".join(broken) or f"only {count} links found")
print(f"{count} links")
