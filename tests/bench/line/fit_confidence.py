#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Fits ConfidenceModel (host/bite_line/place/confidence.hpp) to the points of bench_line_confidence --points FILE.

    fit_confidence.py FILE

One map that rises, straight between its places: least squares of "within 0.3 mm" on what points of written lines claim
that jump or are bridged.  Then each class is left out in turn, and the tenths of all points are told as the others'
maps claim them.
"""
import csv
import sys
from collections import defaultdict

CLAIMED = (0.0, 0.2, 0.4, 0.5, 0.6, 0.8, 0.95, 1.0)
WITHIN_MM = 0.3
LINE_DOUBT = 0.25  # ConfidenceModel::line_doubt_ratio
NUMBERS = ("of_line", "hold", "sharp", "claimed", "error_mm")


def read(path):
    points = []
    with open(path, newline="") as file:
        for row in csv.DictReader(file):
            if row["class"] == "shape" or row["written"] != "1":
                continue
            point = {name: float(row[name]) for name in NUMBERS}
            point.update(kind=row["class"], shoe=row["seed"], held=point["error_mm"] <= WITHIN_MM)
            points.append(point)
    return points


def places(claimed):
    """The two places of the map about it, and their weights."""
    claimed = min(max(claimed, CLAIMED[0]), CLAIMED[-1])
    i = max(k for k in range(len(CLAIMED) - 1) if claimed >= CLAIMED[k])
    share = (claimed - CLAIMED[i]) / (CLAIMED[i + 1] - CLAIMED[i])
    return (i, 1 - share), (i + 1, share)


def solve(A, b):
    n = len(b)
    rows = [A[i][:] + [b[i]] for i in range(n)]
    for i in range(n):
        pivot = max(range(i, n), key=lambda k: abs(rows[k][i]))
        rows[i], rows[pivot] = rows[pivot], rows[i]
        for k in range(n):
            if k != i:
                factor = rows[k][i] / rows[i][i]
                rows[k] = [v - factor * w for v, w in zip(rows[k], rows[i])]
    return [rows[i][n] / rows[i][i] for i in range(n)]


def fit(points):
    n = len(CLAIMED) - 1  # what is certain stays so, and what claims nothing holds nothing
    A = [[1e-6 if i == j else 0.0 for j in range(n)] for i in range(n)]
    b = [0.0] * n
    for p in points:
        # Layers and flat places have figures of their own, and plain points would drown the others.
        if p["hold"] < 0.9 or p["sharp"] < 0.9 or p["claimed"] > 0.97:
            continue
        two = places(p["claimed"])
        left = float(p["held"]) - sum(weight for i, weight in two if i == n)
        for i, weight in two:
            if i == n:
                continue
            b[i] += weight * left
            for j, other in two:
                if j < n:
                    A[i][j] += weight * other
    held = [0.0] + solve([row[1:] for row in A[1:]], b[1:]) + [1.0]
    for i in range(1, len(held)):
        held[i] = min(max(held[i], held[i - 1]), 1.0)
    return held


def confidence(point, held):
    of_map = sum(weight * held[i] for i, weight in places(point["claimed"]))
    return (1 - LINE_DOUBT * (1 - point["of_line"])) * point["hold"] * point["sharp"] * of_map


def main():
    points = read(sys.argv[1])
    print("%d shoes, held{%s}" % (len({p["shoe"] for p in points}), ", ".join("%.3f" % h for h in fit(points))))
    tenths = defaultdict(list)
    for kind in sorted({p["kind"] for p in points}):
        held = fit([p for p in points if p["kind"] != kind])
        for p in points:
            if p["kind"] == kind:
                claim = confidence(p, held)
                tenths[min(9, int(10 * claim))].append((claim, p["held"], p["shoe"]))
    print("classes left out in turn:")
    for tenth, of_it in sorted(tenths.items()):
        print("  claimed %.3f  held %.3f  points %6d  shoes %4d" %
              (sum(c for c, _, _ in of_it) / len(of_it), sum(h for _, h, _ in of_it) / len(of_it), len(of_it),
               len({s for _, _, s in of_it})))


if __name__ == "__main__":
    main()
