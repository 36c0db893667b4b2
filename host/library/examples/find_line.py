# SPDX-License-Identifier: MIT
"""find_line.py CLOUD OUT.csv: the bite line of a shoe's cloud."""
import sys

import biteline

try:
    found = biteline.find_line(biteline.read_cloud(sys.argv[1]))
except biteline.Refused as refused:
    sys.exit(f"{refused.reason_code}: {refused}; {refused.next_step}")
biteline.write_line(sys.argv[2], found.line)
print(f"{len(found.line)} points, {found.line.length_mm:.1f} mm, confidence {found.confidence:.2f}")
