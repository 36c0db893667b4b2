# SPDX-License-Identifier: MIT
"""A stranger's ten lines: how high does the line of this cloud lie, and how long is it?"""
import sys

import biteline

line = biteline.find_line(biteline.read_cloud(sys.argv[1])).line
print(f"{line.positions_mm[:, 2].mean():.9f} {line.length_mm:.9f}")
