# SPDX-License-Identifier: MIT
"""stripe.py SENSOR.yaml: a made picture of a stripe on a plane, found and triangulated.

The plane stands square to the camera, where the laser meets the middle of the picture; the stripe is a Gauss curve.
"""
import sys

import biteline
import numpy as np

head = biteline.read_head(sys.argv[1])
columns = np.arange(head.width_px)
z = head.triangulate([head.width_px / 2], [head.height_px / 2])[0, 2]
n, d = head.laser_normal_cam, head.laser_distance_mm
# Where the laser's plane meets the other one: n_x x + n_y y = d - n_z z.
pixels = np.array([head.project((x, (d - n[2] * z - n[0] * x) / n[1], z)) for x in np.linspace(-0.4 * z, 0.4 * z, 2001)])
order = np.argsort(pixels[:, 0])
rows = np.interp(columns, pixels[order, 0], pixels[order, 1])
picture = np.round(10 + 180 * np.exp(-0.5 * ((np.arange(head.height_px)[:, None] - rows) / 1.7) ** 2)).astype(np.uint8)

stripe = biteline.find_stripe(picture)
found = head.triangulate(stripe["column_px"], stripe["row_px"])[:, 2]
print(f"{len(found)} columns, plane at {z:.4f} mm, found at {found.mean():.4f} mm")
print(f"largest error {abs(found - z).max():.5f} mm; a row's stated standard deviation {stripe['sigma_row_px'].mean():.5f} px")
