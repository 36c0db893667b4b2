# SPDX-License-Identifier: MIT
"""recording.py SCAN.btln: what a recorded scan holds."""
import sys

import biteline

scan = biteline.read_recording(sys.argv[1])
usable = sum(profile.usable for profile in scan.profiles)
print(f"{len(scan.profiles)} profiles, {usable} usable, {len(scan.cloud)} points")
print(f"from {scan.cloud.points_mm.min(axis=0)} to {scan.cloud.points_mm.max(axis=0)} mm")
if scan.lacks:
    print("not whole:", scan.lacks)
