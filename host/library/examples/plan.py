# SPDX-License-Identifier: MIT
"""plan.py LINE PROCESS.yaml OUT.csv: a checked path of a UR10e that stands some 600 mm beside the line."""
import sys

import biteline
import numpy as np

line = biteline.read_line(sys.argv[1])
T_line_base = np.eye(4)
T_line_base[:2, 3] = np.round(line.positions_mm.mean(axis=0)[:2]) - [0, 600]
path = biteline.plan(line, sys.argv[2], "UR10e", T_line_base)
path.write_csv(sys.argv[3])
on_line = np.array(path.segment) == "line"
print(f"{len(path)} waypoints, {path.duration_s:.1f} s, {on_line.sum()} of them on the line")
