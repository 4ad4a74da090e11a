# SPDX-License-Identifier: MIT
"""docs/report.md names every field of real reports, and no field under a heading that none of them has.
Usage: report_page_test.py BATTEN ROOT"""
import json
import os
import re
import subprocess
import sys
import tempfile

batten, root = map(os.path.abspath, sys.argv[1:3])
RUNS = (
    "fit surface {data}/panel.ply -o a.json --tolerance 0.3 --thin 10",
    "fit surface {data}/panel.ply -o b.json --part all",
    "fit surface {data}/panel.ply -o f.json --tiles 2x2",
    "fit primitive cloud.xyz -o c.json --kind sphere",
    "fit curve rows.csv -o d.json --parameterization given --columns u=1,x=2,y=3 --control-points 6",
    "compare two.json cloud.xyz --tolerance 1 --certify --align best --profile 1",
    "fit surface {data}/panel.ply -o e.stl --uncertainty --certify",
    "fit solid box.obj -o g.step --faces 24",
)


def pages():
    """Heading → names in code style below it, first column of tables and the text around them."""
    with open(os.path.join(root, "docs/report.md"), encoding="utf-8") as f:
        text = f.read()
    fields = text[text.index("## The JSON"):text.index("## Why a fit ended")]
    top, *rest = re.split(r"^### `(\w+)`\n", fields, flags=re.M)
    return top, dict(zip(rest[::2], rest[1::2]))


def names(text):
    return set(re.findall(r"`(\w+)`", text))


def rows(text):
    """The names in the first column."""
    return {n for line in re.findall(r"^\| (`[^|]*) \|", text, re.M) for n in names(line)}


def box(n):
    """A cube of n × n squares a side."""
    places, faces = {}, []
    for axis in range(3):
        for side in (0, n):
            for i in range(n):
                for j in range(n):
                    square = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)][::1 if side else -1]
                    corners = [((side, u, v) * 2)[3 - axis : 6 - axis] for u, v in square]
                    faces.append([places.setdefault(corner, len(places) + 1) for corner in corners])
    return "".join(f"v {x} {y} {z}\n" for x, y, z in places) + "".join(f"f {a} {b} {c} {d}\n" for a, b, c, d in faces)


def reports(folder):
    def run(line):
        done = subprocess.run([batten, *line.format(data=os.path.join(root, "data")).split(), "--quiet"], cwd=folder,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        if done.returncode not in (0, 3):
            sys.exit(f"batten {line}: {done.stderr}")
        return done.stdout

    run("make sphere -o ball.json --radius 20")
    run("make plane -o plane.json --center 0,0,40 --size 10,10")
    run("sample ball.json -o cloud.xyz --count 800 --noise 0.01 --seed 1")
    both = {"shape": {"type": "surface", "count": 2, "data": []}}
    for name in ("ball.json", "plane.json"):
        with open(os.path.join(folder, name), encoding="utf-8") as f:
            both["shape"]["data"] += json.load(f)["shape"]["data"]
    with open(os.path.join(folder, "two.json"), "w", encoding="utf-8") as f:
        json.dump(both, f)
    with open(os.path.join(folder, "box.obj"), "w", encoding="utf-8") as f:
        f.write(box(4))
    with open(os.path.join(folder, "rows.csv"), "w", encoding="utf-8") as f:
        f.writelines(f"{u / 50},{u},{(u - 25) ** 2 / 50}\n" for u in range(51))
    return [json.loads(run(line + " --json")) for line in RUNS]


top, sections = pages()
broken, seen = [], {}
with tempfile.TemporaryDirectory() as folder:
    for report, line in zip(reports(folder), RUNS):
        for field, value in report.items():
            seen.setdefault(field, set())
            if field not in sections and field not in names(top + sections["error"]):
                broken.append(f"{field} (batten {line})")
            for entry in value if isinstance(value, list) else [value]:
                if isinstance(entry, dict):
                    seen[field] |= set(entry)
                    where = sections["error"] if field in ("error_all", "parameter_error") else sections.get(field, "")
                    if field == "parts":
                        where += sections["error"]
                    broken += [f"{field}.{name} (batten {line})" for name in entry if name not in names(where)]
for field, text in sections.items():
    broken += [f"{field}.{name} is on the page and in no report" for name in sorted(rows(text) - seen.get(field, set()) - {"refused"})]
broken += [f"{name} is on the page and in no report" for name in sorted(rows(top) - set(seen))]
if broken:
    sys.exit("docs/report.md and the reports differ:\n" + "\n".join(sorted(set(broken))))
print(f"{len(seen)} fields, {sum(map(len, seen.values()))} below them: all on the page")
