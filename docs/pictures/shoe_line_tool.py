#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""shoe_line_tool.py RESULT PLAN >FILE.svg: a shoe's scan, its line, and the tool that goes along it as planned.

RESULT is the folder of `biteline replay` or `extract` (cloud.ply, line.csv), PLAN that of `biteline plan`.
Everything is in the robot's base frame, mm; the picture is a parallel projection from above at the shoe's side.
The tool moves along the line in the planned time, over and over.  Without animation it stands where the work begins.
"""

import csv
import sys
from pathlib import Path

import numpy as np

ELEVATION_DEG = 40.0
PX_PER_MM, MARGIN_PX = 2.0, 20
POINTS, SHADES = 9000, 6
TOOL_MM = 70.0
FRAMES = 100


def read_cloud(file):
    """Points of a binary PLY file, n x 3, mm."""
    kinds = {"float": "<f4", "double": "<f8", "ushort": "<u2", "uint": "<u4", "uchar": "u1", "int": "<i4", "short": "<i2"}
    data = file.read_bytes()
    head, body = data.split(b"end_header\n", 1)
    fields, count = [], 0
    for words in (line.split() for line in head.decode().splitlines()):
        if words[:2] == ["element", "vertex"]:
            count = int(words[2])
        elif words[0] == "property":
            fields.append((words[2], kinds[words[1]]))
    rows = np.frombuffer(body, np.dtype(fields), count)
    return np.stack([rows["x"], rows["y"], rows["z"]], axis=1).astype(float)


def read_table(file):
    """Rows of a table of a result, each as a dict of its column's first word."""
    with file.open() as stream:
        names = [name.lstrip("#").split(" ")[0] for name in next(csv.reader([stream.readline()]))]
        return [dict(zip(names, row)) for row in csv.reader(stream)]


def columns(rows, *names):
    return np.array([[float(row[name]) for name in names] for row in rows])


class View:
    """Parallel projection: right is the shoe's length, up leans away by the elevation."""

    def __init__(self, line):
        flat = (line - line.mean(axis=0))[:, :2]
        along = np.linalg.svd(flat, full_matrices=False)[2][0]
        tilt = np.radians(ELEVATION_DEG)
        self.right = np.array([along[0], along[1], 0.0])
        away = np.cross([0.0, 0.0, 1.0], self.right)
        self.up = np.sin(tilt) * away + np.cos(tilt) * np.array([0.0, 0.0, 1.0])
        self.to_eye = np.cross(self.right, self.up)
        self.low = np.zeros(2)

    def px(self, points):
        flat = np.stack([points @ self.right, -points @ self.up], axis=1)
        return flat * PX_PER_MM - self.low


def far_side(view, points, line, normals):
    """Which points lie on the side of the shoe that the eye does not see: by the normal of the line's nearest point."""
    steps = points[:, None, :2] - line[None, ::8, :2]
    nearest = np.argmin((steps**2).sum(axis=2), axis=1) * 8
    return (normals[nearest][:, :2] @ view.to_eye[:2]) < 0


def surface(view, cloud, line, normals):
    """Dots of the scan, a path for each shade: near is dark, and the far side stands behind it, pale."""
    some = cloud[np.random.default_rng(1).permutation(len(cloud))[:POINTS]]
    far = far_side(view, some, line, normals)
    depth = some @ view.to_eye
    shade = np.clip((depth - depth.min()) / np.ptp(depth) * SHADES, 0, SHADES - 1).astype(int)
    layers = [(far, 215)] + [(~far & (shade == number), 170 - 16 * number) for number in range(SHADES)]
    for which, grey in layers:
        dots = "".join(f"M{x:.0f} {y:.0f}h0" for x, y in view.px(some[which]))
        yield f'<path d="{dots}" stroke="rgb({grey},{grey},{grey})" stroke-width="4" stroke-linecap="round"/>'


def curve(view, line, normals):
    """The line; where the upper's normal turns away from the eye it is behind the shoe, and thin."""
    ends = view.px(np.stack([line, np.roll(line, -1, axis=0)], axis=1).reshape(-1, 3)).reshape(-1, 2, 2)
    hidden = normals @ view.to_eye < 0
    for which, width in ((hidden, 1.5), (~hidden, 5)):
        steps = "".join(f"M{a[0]:.1f} {a[1]:.1f}L{b[0]:.1f} {b[1]:.1f}" for a, b in ends[which])
        yield f'<path d="{steps}" stroke="#0a9d3c" stroke-width="{width}" stroke-linecap="round"/>'


def tool_ends(rows):
    """Times (s), tips and far ends of the tool (mm), at FRAMES equal times."""
    time = columns(rows, "time")[:, 0]
    tip = columns(rows, "p_x", "p_y", "p_z")
    w, x, y, z = columns(rows, "q_w", "q_x", "q_y", "q_z").T
    into = np.stack([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)], axis=1)
    at = np.linspace(time[0], time[-1], FRAMES)
    even = lambda values: np.stack([np.interp(at, time, column) for column in values.T], axis=1)
    return time[-1] - time[0], even(tip), even(tip - TOOL_MM * into)


def tool(view, duration_s, tips, ends):
    tips, ends = view.px(tips), view.px(ends)
    moves = ""
    for name, values in (("x1", tips[:, 0]), ("y1", tips[:, 1]), ("x2", ends[:, 0]), ("y2", ends[:, 1])):
        steps = ";".join(f"{value:.1f}" for value in values)
        moves += f'<animate attributeName="{name}" dur="{duration_s:.2f}s" repeatCount="indefinite" values="{steps}"/>'
    place = f'x1="{tips[0, 0]:.1f}" y1="{tips[0, 1]:.1f}" x2="{ends[0, 0]:.1f}" y2="{ends[0, 1]:.1f}"'
    yield f'<line {place} stroke="#1d4fb8" stroke-width="9" stroke-linecap="round">{moves}</line>'


def main():
    result, plan = (Path(word) for word in sys.argv[1:3])
    cloud = read_cloud(result / "cloud.ply")
    rows = read_table(result / "line.csv")
    line, normals = columns(rows, "x", "y", "z"), columns(rows, "nx", "ny", "nz")
    work = [row for row in read_table(plan / "path.csv") if row["segment"] == "line"]
    duration_s, tips, ends = tool_ends(work)
    view = View(line)
    shown = view.px(np.concatenate([cloud, tips, ends]))
    view.low = shown.min(axis=0) - MARGIN_PX
    width, height = np.ptp(shown, axis=0) + 2 * MARGIN_PX
    print(f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.0f} {height:.0f}" fill="none">')
    print('<rect width="100%" height="100%" fill="#fff"/>')
    drawn = (
        *surface(view, cloud, line, normals),
        *curve(view, line, normals),
        *tool(view, duration_s, tips, ends),
    )
    for part in drawn:
        print(part)
    print("</svg>")


main()
