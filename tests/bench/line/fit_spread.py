#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Fits SpreadModel (host/bite_line/place/point_spread.hpp) to the points of bench_line_u95 --exact --points FILE.

    fit_spread.py FILE [--check FILE]

The model's 95 % limit is fitted to the errors' own (pinball loss at 0.95), on the seen points.  Then each class is left out in turn, and told how many of its points the
others' fit holds.  --check: another file, of other seeds.
"""
import csv
import math
import sys

SHARE = 0.95
# The circle that holds 95 % of a normal distribution with deviations a > b in a plane has about the radius
# sqrt(3.84 a^2 + 2.15 b^2): exact for b = 0 and for b = a.
MAJOR, MINOR = 3.841, 2.150
START = {"scatter": 0.5, "outward": 1.0}


def read(path):
    with open(path, newline="") as file:
        return [{k: (v if k == "class" else float(v)) for k, v in row.items()} for row in csv.DictReader(file)]


def limit_mm(row, model):
    height = (model["scatter"] * row["scatter_mm"]) ** 2
    anywhere = (model["outward"] * row["outward_mm"]) ** 2
    return math.sqrt(MAJOR * (height * (1 + row["slope"] ** 2) + anywhere) + MINOR * anywhere)


def error_mm(row):
    return math.hypot(row["error_out_mm"], row["error_up_mm"])


def loss(rows, model):
    total = 0.0
    for row in rows:
        over = error_mm(row) - limit_mm(row, model)
        total += SHARE * over if over > 0 else (SHARE - 1) * over
    return total / len(rows)


def coverage(rows, model):
    return sum(error_mm(r) <= limit_mm(r, model) for r in rows) / max(1, len(rows))


def descend(rows, model, free):
    """Coordinate search, each step halved when nothing gets better."""
    best, step = loss(rows, model), 0.5
    while step > 0.02:
        moved = False
        for name in free:
            for factor in (1 + step, 1 / (1 + step)):
                trial = dict(model, **{name: model[name] * factor})
                value = loss(rows, trial)
                if value < best - 1e-9:
                    best, model, moved = value, trial, True
        if not moved:
            step /= 2
    return model


def fit(rows):
    plain = [r for r in rows if r["sharp"] > 0.9 and r["hold"] > 0.9 and r["doubt"] == 0]
    return descend(plain, START, tuple(START))


def main():
    rows = read(sys.argv[1])
    model = fit(rows)
    print("  ".join("%s %.4g" % item for item in model.items()))
    for name in sorted({r["class"] for r in rows}):
        inside = [r for r in rows if r["class"] == name]
        print("%-10s left out: %.3f held, with it %.3f" %
              (name, coverage(inside, fit([r for r in rows if r["class"] != name])), coverage(inside, model)))
    others = read(sys.argv[3]) if len(sys.argv) > 3 and sys.argv[2] == "--check" else rows
    seen = [r for r in others if r["doubt"] == 0]
    print("%d seen points, %.3f held" % (len(seen), coverage(seen, model)))


if __name__ == "__main__":
    main()
