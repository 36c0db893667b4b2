#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""slurm_rows.py BATCH COUNT SLURM_S LOCAL_S SHARDS_BEFORE_THE_KILLS: rows of bench_batch_slurm, from what the batch left.

Leaves with a line when a recording is missing or there twice.
"""
import glob
import json
import os
import statistics
import sys

NODES = 2


def shard_times(batch, shard):
    """When a shard's first recording began and its last one was written, the longest pause between two, and the seconds of the
    recordings alone."""
    spans = []
    for result in shard["results"]:
        file = f"{batch}/store/{result['key'][:2]}/{result['key']}/cost.json"
        wall_s = json.load(open(file))["wall_s"]
        end = os.stat(file).st_mtime
        spans.append((end - wall_s, end))
    spans.sort()
    pause = max([after[0] - before[1] for before, after in zip(spans, spans[1:])], default=0)
    return spans[0][0], spans[-1][1], pause, sum(end - begin for begin, end in spans)


def gaps(times):
    """Between the end of a shard and the begin of the next one on the same node: nodes take them in turn."""
    begins = sorted(begin for begin, _, _, _ in times)
    ends = sorted(end for _, end, _, _ in times)
    return [begin - end for begin, end in zip(begins[NODES:], ends)]


def row(what, ours, unit, **more):
    print(json.dumps({"bench": "batch.slurm", "what": what, "ours": round(ours, 4), "unit": unit, **more}))


def main():
    batch, count, slurm_s, local_s, before = sys.argv[1], *map(float, sys.argv[2:])
    shards = [json.load(open(file)) for file in glob.glob(f"{batch}/runs/*/shards/*.json")]
    names = [result["name"] for shard in shards for result in shard["results"]]
    stored = glob.glob(f"{batch}/store/??/*/result.json")
    if not len(names) == len(set(names)) == len(stored) == count:
        sys.exit(f"{len(names)} results of {len(set(names))} recordings, {len(stored)} in the store")
    verdicts = [result["verdict"] for shard in shards for result in shard["results"]]
    times = [shard_times(batch, shard) for shard in shards]
    work_s = sum(work for *_, work in times)
    # The lost one stands still until Slurm takes it up again.
    whole = [one for one in times if one[2] < 0.5 * (one[1] - one[0])]
    between = gaps(whole)
    row(f"{len(names)} recordings, {len(shards)} shards, {NODES} nodes; a step and a slurmd killed after {before:.0f}", slurm_s, "s",
        peer=f"{NODES} processes of this machine", peer_value=round(local_s, 2), ratio=round(slurm_s / local_s, 3))
    row("answers", verdicts.count("ok") + verdicts.count("refused"), "recordings", ok=verdicts.count("ok"))
    row("a recording, by its own process", work_s / count, "s")
    row("between two shards of a node, median", statistics.median(between), "s", most=round(max(between), 2))
    row("within a shard, beside a recording's process", sum(end - begin - work for begin, end, _, work in whole) / count, "s",
        interrupted=len(times) - len(whole))


main()
