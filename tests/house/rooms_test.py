# SPDX-License-Identifier: MIT
"""The laws of the house, read off the includes: docs/architecture.md lists the rooms in one total order, lowest first.
 1. Every source stands in a listed room; a room holds at most 40 units (x.h and x.cc are one).
 2. A unit includes units of its own room and of rooms above it in the list, no others.
 3. Units form no cycle.
 4. A public header (include/batten) includes public headers, Eigen and the standard library only.
 5. Everything that is not public stands in namespace batten::internal.
 6. No type is defined in two headers: one name, one thing.
 7. No object file is tracked.
 8. <batten/batten.h> includes every other public header but <batten/pcl.h>, which alone may include PCL.
Usage: rooms_test.py ROOT"""
import collections
import os
import re
import subprocess
import sys

LARGEST_ROOM = 40
PCL_HEADER, ALL_HEADERS = "include/batten/pcl.h", "include/batten/batten.h"
EIGEN_AND_STANDARD = re.compile(r"(Eigen/\w+|[a-z_]+)$")


def rooms_in_order(root):
    text = open(os.path.join(root, "docs/architecture.md"), encoding="utf-8").read()
    return re.findall(r"^\| `((?:geometry|fitting|io|cli)/\w+)/?` \|", text, re.M)


def sources(root):
    for top in ("include/batten", "geometry", "fitting", "io", "cli"):
        for folder, _, names in os.walk(os.path.join(root, top)):
            for name in names:
                if name.endswith((".h", ".cc")):
                    yield os.path.relpath(os.path.join(folder, name), root)


def strong_components(edges):
    """Tarjan's algorithm (1972): the groups of more than one unit that include one another."""
    index, low, stack, on_stack, groups = {}, {}, [], set(), []
    sys.setrecursionlimit(10000)

    def visit(unit):
        index[unit] = low[unit] = len(index)
        stack.append(unit)
        on_stack.add(unit)
        for other in sorted(edges[unit]):
            if other not in index:
                visit(other)
                low[unit] = min(low[unit], low[other])
            elif other in on_stack:
                low[unit] = min(low[unit], index[other])
        if low[unit] == index[unit]:
            group = []
            while not group or group[-1] != unit:
                group.append(stack.pop())
                on_stack.discard(group[-1])
            if len(group) > 1:
                groups.append(sorted(group))

    for unit in sorted(edges):
        if unit not in index:
            visit(unit)
    return groups


def main():
    root = sys.argv[1]
    broken = []
    order = rooms_in_order(root)
    place = {room: k for k, room in enumerate(order)}
    if len(order) < 30 or len(place) != len(order):
        broken.append(f"docs/architecture.md lists {len(order)} rooms, {len(place)} of them different")
    files = sorted(sources(root))
    # A public header belongs to the room of the source of its name; one without a source to the lowest room that
    # any of its includes allows: it is checked by what it includes alone.
    home = {}
    for path in files:
        if path.endswith(".cc"):
            home.setdefault((path.split("/")[0], os.path.basename(path)[:-3]), []).append(os.path.dirname(path))

    def unit_of(path):
        stem = re.sub(r"\.(h|cc)$", "", path)
        if not path.startswith("include/"):
            return stem
        top, name = path.split("/")[2], os.path.basename(stem)
        found = home.get((top, name), [])
        return f"{found[0]}/{name}" if len(found) == 1 else f"{top}/public/{name}"

    known = set(files)
    edges = collections.defaultdict(set)
    units = collections.defaultdict(set)
    types = collections.defaultdict(set)
    for path in files:
        text = open(os.path.join(root, path), encoding="utf-8").read()
        unit = unit_of(path)
        room = os.path.dirname(unit)
        units[room].add(unit)
        edges[unit]
        public = path.startswith("include/")
        if room not in place and not room.endswith("/public") and path not in ("cli/main.cc",):
            broken.append(f"{path}: {room} is not a room of docs/architecture.md")
        if path.endswith(".h"):
            for name in re.findall(r"^(?:struct|class) (\w+)(?: final)?(?: :[^;{]*)? \{", text, re.M):
                types[name].add(path)
        own = re.findall(r"^namespace (batten[\w:]*)", text, re.M)
        if not public and path.endswith(".h") and own and not any(n.startswith("batten::internal") for n in own):
            broken.append(f"{path}: {own} where batten::internal is asked for")
        for mark, name in re.findall(r'^ *#include ([<"])([^>"]+)[>"]', text, re.M):
            other = "include/" + name if name.startswith("batten/") else name
            if other in known:
                if public and not other.startswith("include/"):
                    broken.append(f"{path} is public and includes {name}, which is not")
                if unit_of(other) != unit:
                    edges[unit].add(unit_of(other))
            elif mark == '"':
                broken.append(f"{path}: {name} is no file of the tree")
            elif public and not EIGEN_AND_STANDARD.match(name) and not (path == PCL_HEADER and name.startswith("pcl/")):
                broken.append(f"{path} is public and includes <{name}>")
    listed = set(re.findall(r'^#include "([^"]+)"', open(os.path.join(root, ALL_HEADERS), encoding="utf-8").read(), re.M))
    meant = {f[len("include/"):] for f in files if f.startswith("include/") and f not in (PCL_HEADER, ALL_HEADERS)}
    broken += [f"{name}: <batten/batten.h> does not include it, or should not" for name in sorted(meant ^ listed)]
    for unit, others in sorted(edges.items()):
        room = os.path.dirname(unit)
        for other in sorted(others):
            there = os.path.dirname(other)
            if room in place and there in place and place[there] > place[room]:
                broken.append(f"{unit} includes {other}, of a room behind its own")
    broken += [f"{name} is defined in {' and in '.join(sorted(t))}" for name, t in sorted(types.items()) if len(t) > 1]
    for group in strong_components(edges):
        broken.append("units that include one another: " + ", ".join(group))
    for room, members in sorted(units.items()):
        if len(members) > LARGEST_ROOM and not room.endswith("/public"):
            broken.append(f"{room} holds {len(members)} units, more than {LARGEST_ROOM}")
    if os.path.isdir(os.path.join(root, ".git")):
        tracked = subprocess.run(["git", "ls-files"], cwd=root, capture_output=True, text=True).stdout.split("\n")
        broken += [f"{f}: a product of the build is tracked" for f in tracked if re.search(r"\.(o|a|so|gch|pyc)$", f)]
    if broken:
        sys.exit("laws of the house that do not hold:\n" + "\n".join(broken))
    print(f"{len(order)} rooms, {len(edges)} units: the laws of the house hold")


if __name__ == "__main__":
    main()
