#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Fits ShoeOutlines (host/bite_line/shoe/plan_shape.hpp) to what bench_line_outline writes.

    fit_outline.py FILE [--check FILE]

Mean and covariance are those of made shoes and shapes, each lot half.  Limit and softness are a logistic regression
of "a shoe" on the distance; things count ten times.  Then each class of shoes, each shape and each class of things is left out in turn.
--check: what the fit says of another file, of other seeds.
"""
import csv
import math
import sys

MEASURES = ("broadest_at", "end_breadth", "heel_breadth")
# Shoes and things lie apart: without it the softness would go to nothing.
RIDGE = 1e-3
# What a missing sector at an end does to each measure: few scans have one, so their covariance says too little.
MISSING = (0.01, 0.05, 0.03)
# A thing taken counts as so many shoes refused.
THING_TAKEN = 10.0


def read(path):
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    for row in rows:
        row["x"] = [float(row[name]) for name in MEASURES]
    return rows


def lower_inverse(C):
    """W, lower triangle, with W C W^T = 1."""
    n = len(C)
    L = [[0.0] * n for _ in range(n)]
    for i in range(n):
        for j in range(i + 1):
            left = C[i][j] - sum(L[i][k] * L[j][k] for k in range(j))
            L[i][j] = math.sqrt(left) if i == j else left / L[j][j]
    W = [[0.0] * n for _ in range(n)]
    for i in range(n):
        W[i][i] = 1 / L[i][i]
        for j in range(i):
            W[i][j] = -sum(L[i][k] * W[k][j] for k in range(j, i)) / L[i][i]
    return W


def spread(rows):
    lots = [[r["x"] for r in rows if r["kind"] == kind] for kind in ("made", "shape")]
    weighted = [(1 / len(lot), x) for lot in lots if lot for x in lot]
    total = sum(w for w, _ in weighted)
    n = range(len(MEASURES))
    mean = [sum(w * x[i] for w, x in weighted) / total for i in n]
    C = [[sum(w * (x[i] - mean[i]) * (x[j] - mean[j]) for w, x in weighted) / total for j in n] for i in n]
    for i in n:
        C[i][i] += MISSING[i] ** 2
    return mean, lower_inverse(C)


def distance(x, mean, W):
    e = [a - b for a, b in zip(x, mean)]
    return math.hypot(*(sum(w * v for w, v in zip(row, e)) for row in W))


def chance(d, limit, softness):
    return 1 / (1 + math.exp(max(-50.0, min(50.0, (d - limit) / softness))))


def fit(rows):
    mean, W = spread(rows)
    shoes = [r for r in rows if r["kind"] != "thing"]
    points = [(distance(r["x"], mean, W), r["kind"] != "thing",
               (1 / len(shoes) if r["kind"] != "thing" else THING_TAKEN / (len(rows) - len(shoes))) /
               (1 + THING_TAKEN)) for r in rows]
    a, b = 5.0, -1.0  # chance = 1 / (1 + exp(-(a + b d)))
    for _ in range(200):
        ga, gb, haa, hab, hbb = 0.0, -RIDGE * b, 1e-9, 0.0, RIDGE
        for d, shoe, weight in points:
            p = 1 / (1 + math.exp(max(-50.0, min(50.0, -(a + b * d)))))
            g, h = weight * (shoe - p), weight * p * (1 - p)
            ga, gb = ga + g, gb + g * d
            haa, hab, hbb = haa + h, hab + h * d, hbb + h * d * d
        det = haa * hbb - hab * hab
        da, db = (ga * hbb - gb * hab) / det, (haa * gb - hab * ga) / det
        step = min(1.0, 1.0 / max(abs(da), abs(db), 1e-9))
        a, b = a + step * da, b + step * db
        if max(abs(da), abs(db)) < 1e-6:
            break
    return mean, W, -a / b, -1 / b


def told(name, rows, model):
    mean, W, limit, softness = model
    values = sorted(distance(r["x"], mean, W) for r in rows)
    wrong = sum((chance(d, limit, softness) >= 0.5) != (r["kind"] != "thing")
                for r, d in ((r, distance(r["x"], mean, W)) for r in rows))
    print("%-36s %4d outlines, distance %5.2f to %5.2f, limit %.2f, %d on the wrong side" %
          (name, len(rows), values[0], values[-1], limit, wrong))


def main():
    rows = read(sys.argv[1])
    mean, W, limit, softness = model = fit(rows)
    print("mean{%s}" % ", ".join("%.4f" % m for m in mean))
    print("whiten{%s}" % ", ".join("%.3f" % W[i][j] for i in range(len(W)) for j in range(i + 1)))
    print("limit{%.3f}  softness{%.3f}" % (limit, softness))
    for kind, name in sorted({(r["kind"], r["class"]) for r in rows}):
        of_it = [r for r in rows if (r["kind"], r["class"]) == (kind, name)]
        told(kind + " " + name + " left out", of_it, fit([r for r in rows if r not in of_it]))
    if len(sys.argv) > 3 and sys.argv[2] == "--check":
        others = read(sys.argv[3])
        for kind in ("made", "shape", "thing"):
            told("other seeds: " + kind, [r for r in others if r["kind"] == kind], model)


if __name__ == "__main__":
    main()
