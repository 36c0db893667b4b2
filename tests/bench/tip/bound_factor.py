#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The tool's bound of bench_tip's rows: its factor by split-conformal over shoes, and what it is worth on
classes that it was not made of.

bench_tip --shoes 60 --own --budget 0 --rows rows.csv; bound_factor.py rows.csv
A shoe's nonconformity is the largest of its processes' true distance over the stated sum. The factor is the
ceil((n + 1) 0.95)-th smallest of n shoes (Vovk, Gammerman, Shafer 2005). k_bound_factor, k_mean_ratio and
k_ratio_sigma of host/robot/path/tip_bound.hpp are its words.
"""
import csv
import math
import statistics
import sys
from collections import defaultdict

COVERAGE = 0.95


def factor(ratios):
    """Of one ratio a shoe; nothing where so few shoes say nothing of one in twenty."""
    ratios = sorted(ratios)
    rank = math.ceil((len(ratios) + 1) * COVERAGE)
    return ratios[rank - 1] if rank <= len(ratios) else None


def main():
    by_shoe = defaultdict(list)
    for name in sys.argv[1:]:
        with open(name, newline="", encoding="utf-8") as file:
            for row in csv.DictReader(file):
                sent = row["table"] == "class" and not row["refused"] and row["waits"] == "0"
                if sent and float(row["sum_mm"]) > 0:
                    by_shoe[(row["class"], row["shoe"])].append((float(row["sum_mm"]), float(row["max_mm"])))
    ratios = {key: max(most / total for total, most in rows) for key, rows in by_shoe.items()}
    each = [most / total for rows in by_shoe.values() for total, most in rows]
    print(f"shoes {len(ratios)}, paths {len(each)}")
    print(f"k_bound_factor {factor(ratios.values()):.3f}")
    print(f"k_mean_ratio {statistics.mean(each):.3f}, k_ratio_sigma {statistics.stdev(each):.3f}")
    held, shoes, bounds, truths, paths = 0, 0, [], [], 0
    held_paths = 0
    for left_out in sorted({key[0] for key in ratios}):
        made = factor(value for key, value in ratios.items() if key[0] != left_out)
        for key, rows in by_shoe.items():
            if key[0] != left_out:
                continue
            shoes += 1
            held += ratios[key] <= made
            for total, most in rows:
                paths += 1
                held_paths += most <= made * total
                bounds.append(made * total)
                truths.append(most)
    print(f"class left out: true of {held} of {shoes} shoes ({100 * held / shoes:.1f} %), "
          f"{held_paths} of {paths} paths ({100 * held_paths / paths:.1f} %)")
    print(f"mean bound {statistics.mean(bounds):.3f} mm, mean largest distance {statistics.mean(truths):.3f} mm, "
          f"ratio {statistics.mean(bounds) / statistics.mean(truths):.2f}, largest bound {max(bounds):.2f} mm")


if __name__ == "__main__":
    main()
