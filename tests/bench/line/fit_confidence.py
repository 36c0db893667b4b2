#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Fits ConfidenceModel (host/bite_line/place/confidence.hpp) to the points of bench_line_confidence --points FILE.

    fit_confidence.py FILE... [--test FILE...]

What share of bridged points of written lines lies within 0.3 mm, at each of a few spreads: `shares`, straight in
between over the spread's logarithm, by maximum likelihood.  Then each class is left out in turn, and the tenths of all
its points are told as the others' fit claims them; shoes are drawn anew for the interval.  With --test, the fit's
claims are told for the shoes of other files, too.  Shoes with a missing sector (--fault sector) have nearly all
bridged points.
"""
import argparse
import csv
import math
import random
import sys
from collections import defaultdict

WITHIN_MM = 0.3
# As in ConfidenceModel: read off the likelihood, which hardly changes about them.
CORNER, LEAST_MM, JUMP_MM, LINE_DOUBT, FLAT_HELD = 0.1, 0.05, 0.8, 0.25, 0.4
SPREADS_MM = (0.1, 0.35, 0.55, 0.75, 1.05, 1.3, 1.75, 2.3, 4.5)
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
    return LEAST_MM + CORNER * point["corner_mm"] + math.hypot(point["tried_out_mm"], point["tried_up_mm"])


def between(spread_mm):
    """Index of the spread below, and how far the place is on the way to the next one."""
    if spread_mm <= SPREADS_MM[0]:
        return 0, 0.0
    low = max(i for i, at in enumerate(SPREADS_MM[:-1]) if at < spread_mm)
    return low, math.log(spread_mm / SPREADS_MM[low]) / math.log(SPREADS_MM[low + 1] / SPREADS_MM[low])


def fit(points):
    """Shares at SPREADS_MM: a point between two of them is one of either's, as likely as its outcome says (EM)."""
    # Layers and flat places have figures of their own.
    bridged = [(*between(p["spread"]), p["held"], line_held(p)) for p in points
               if p["doubt"] > 0 and p["hold"] > 0.9 and p["sharp"] > 0.9 and p["spread"] <= SPREADS_MM[-1]]
    line = sum(of_line for _, _, _, of_line in bridged) / len(bridged)
    shares = [0.9 - 0.8 * i / len(SPREADS_MM) for i in range(len(SPREADS_MM))]
    for _ in range(60):
        held, all_of_it = [1e-3] * len(shares), [2e-3] * len(shares)
        for low, way, is_held, of_line in bridged:
            chances = [of_line * shares[low + k] if is_held else 1 - of_line * shares[low + k] for k in (0, 1)]
            here, there = (1 - way) * chances[0], way * chances[1]
            for k, weight in ((0, here / (here + there)), (1, there / (here + there))):
                held[low + k] += weight * is_held
                all_of_it[low + k] += weight
        shares = [min(0.999, h / n / line) for h, n in zip(held, all_of_it)]
    # A wider bridge holds no more.
    for i in range(1, len(shares)):
        shares[i] = min(shares[i], shares[i - 1])
    return shares


def line_held(point):
    return 1 - LINE_DOUBT * (1 - point["of_line"])


def confidence(point, shares):
    if point["doubt"] > 0:
        low, way = between(point["spread"])
        within = shares[low] + way * (shares[low + 1] - shares[low])
        if point["spread"] > SPREADS_MM[-1]:
            within = shares[-1] * (SPREADS_MM[-1] / point["spread"]) ** 2
    else:
        within = 1 / (1 + (point["jump_mm"] / JUMP_MM) ** 2)
    return line_held(point) * point["hold"] * max(point["sharp"], FLAT_HELD) * within


def interval(of_tenth, shoes):
    """Middle 95 % of held minus claimed over draws of as many shoes."""
    sums = defaultdict(lambda: (0, 0.0))
    for claim, held, shoe in of_tenth:
        points, more = sums[shoe]
        sums[shoe] = points + 1, more + held - claim
    drawn, rng = [], random.Random(1)
    for _ in range(500):
        draw = [sums[shoe] for shoe in rng.choices(shoes, k=len(shoes)) if shoe in sums]
        if draw:
            drawn.append(sum(more for _, more in draw) / sum(points for points, _ in draw))
    drawn.sort()
    return drawn[int(0.025 * len(drawn))], drawn[int(0.975 * len(drawn))]


def tell(what, claims, shoes):
    """`claims`: what each point claims, whether it holds, and its shoe."""
    tenths = defaultdict(list)
    for one in claims:
        tenths[min(9, int(10 * one[0]))].append(one)
    print(what)
    for _, of_it in sorted(tenths.items()):
        claimed, held = (sum(one[k] for one in of_it) / len(of_it) for k in (0, 1))
        print("  claimed %.3f  held %.3f  difference %+.3f (%+.3f to %+.3f)  points %6d  shoes %4d" %
              (claimed, held, held - claimed, *interval(of_it, shoes), len(of_it), len({s for _, _, s in of_it})))


def claims_of(points, shares):
    return [(confidence(p, shares), p["held"], p["shoe"]) for p in points]


def shoes_of(points):
    return sorted({p["shoe"] for p in points})


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="+")
    parser.add_argument("--test", nargs="+", default=[])
    asked = parser.parse_args()
    points = read(asked.files)
    fitted = fit(points)
    print("%d shoes; shares %s" % (len(shoes_of(points)), "  ".join(
        "%.2f mm %.4f" % pair for pair in zip(SPREADS_MM, fitted))))
    left_out = []
    for kind in sorted({p["class"] for p in points}):
        shares = fit([p for p in points if p["class"] != kind])
        left_out += claims_of([p for p in points if p["class"] == kind], shares)
    tell("classes left out in turn:", left_out, shoes_of(points))
    if asked.test:
        others = read(asked.test)
        tell("%d other shoes:" % len(shoes_of(others)), claims_of(others, fitted), shoes_of(others))


if __name__ == "__main__":
    main()
