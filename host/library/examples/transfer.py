# SPDX-License-Identifier: MIT
"""transfer.py SAMPLE UPPER OUT.csv: a sample's line (a folder with cloud.ply and line.csv) on the next upper."""
import sys

import biteline

sample = biteline.read_sample(sys.argv[1])
carried = biteline.transfer_line(sample, biteline.read_cloud(sys.argv[2]))
biteline.write_line(sys.argv[3], carried.line)
print(f"carried, within {carried.bound_mm:.2f} mm; the surfaces agree to {carried.shape_rms_mm:.3f} mm")
