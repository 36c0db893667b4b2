#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Fits ConfidenceModel (host/bite_line/place/confidence.hpp) to the points of bench_line_confidence --points FILE.

    fit_confidence.py FILE...

What share of bridged points of written lines lies within 0.3 mm, over their bridge's spread: `power` and `half_mm` by
maximum likelihood.  Then each class is left out in turn, and the tenths of all its points are told as the others' fit
claims them.  Shoes with a missing sector (--fault sector) have nearly all bridged points.
"""
import csv
import math
import sys
from collections import defaultdict

WITHIN_MM = 0.3
# As in ConfidenceModel: read off the likelihood, which hardly changes about them.
CORNER, DOUBT_MM, LEAST_MM, JUMP_MM, LINE_DOUBT = 0.2, 0.15, 0.05, 0.8, 0.25
TEXTS = ("class", "decoy", "fault", "seed")


def read(paths):
    points = []
    for path in paths:
        with open(path, newline="", encoding="utf-8") as file:
            for row in csv.DictReader(file):
                if row["class"] == "shape" or row["written"] != "1":
                    continue
                point = {name: text if name in TEXTS else float(text) for name, text in row.items()}
                point.update(shoe=(path, row["seed"]), held=point["error_mm"] <= WITHIN_MM, spread=spread(point))
                points.append(point)
    return points


def spread(point):
    parts = (CORNER * point["corner_mm"], point["tried_out_mm"], point["tried_up_mm"], DOUBT_MM * point["doubt"])
    return LEAST_MM + math.sqrt(sum(part * part for part in parts))


def fit(points):
    """Logistic regression of `held` on the spread's logarithm, by Newton's steps: power, half_mm."""
    # Layers and flat places have figures of their own.
    bridged = [p for p in points if p["doubt"] > 0 and p["hold"] > 0.9 and p["sharp"] > 0.9]
    level, slope = 0.0, -1.0
    for _ in range(30):
        g0 = g1 = h00 = h01 = h11 = 0.0
        for p in bridged:
            x = math.log(p["spread"])
            chance = 1 / (1 + math.exp(-(level + slope * x)))
            off, weight = p["held"] - chance, chance * (1 - chance)
            g0, g1 = g0 + off, g1 + off * x
            h00, h01, h11 = h00 + weight, h01 + weight * x, h11 + weight * x * x
        determinant = h00 * h11 - h01 * h01
        level += (h11 * g0 - h01 * g1) / determinant
        slope += (h00 * g1 - h01 * g0) / determinant
    return -slope, math.exp(-level / slope)


def confidence(point, power, half_mm):
    if point["doubt"] > 0:
        within = 1 / (1 + (point["spread"] / half_mm) ** power)
    else:
        within = 1 / (1 + (point["jump_mm"] / JUMP_MM) ** 2)
    return (1 - LINE_DOUBT * (1 - point["of_line"])) * point["hold"] * point["sharp"] * within


def main():
    points = read(sys.argv[1:])
    print("%d shoes, power %.3f, half_mm %.3f" % (len({p["shoe"] for p in points}), *fit(points)))
    tenths = defaultdict(list)
    for kind in sorted({p["class"] for p in points}):
        model = fit([p for p in points if p["class"] != kind])
        for p in points:
            if p["class"] == kind:
                claim = confidence(p, *model)
                tenths[min(9, int(10 * claim))].append((claim, p["held"], p["shoe"]))
    print("classes left out in turn:")
    for _, of_it in sorted(tenths.items()):
        print("  claimed %.3f  held %.3f  points %6d  shoes %4d" %
              (sum(c for c, _, _ in of_it) / len(of_it), sum(h for _, h, _ in of_it) / len(of_it), len(of_it),
               len({s for _, _, s in of_it})))


if __name__ == "__main__":
    main()
