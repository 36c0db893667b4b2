# SPDX-License-Identifier: MIT
"""A recorded session as if an encoder were the pose: pose0/encoder.csv, and what each exposure's count is to be."""
import bisect
import fractions
import pathlib
import re
import shutil

OFFSET_NS = 700_000  # pose clock minus camera clock: exposures fall between the poses


def stamps_of(table):
    return [int(line.split(",")[0]) for line in table.read_text().splitlines() if line and not line.startswith("#")]


def counted(session, folder):
    """A copy of the session with counts, uneven and falling; the poses about one exposure have none.  And the counts by stamp."""
    copy = pathlib.Path(folder, "counted")
    shutil.copytree(session, copy)
    head = copy / "cam0" / "sensor.yaml"
    text, changed = re.subn(r"^pose_clock_offset_ns: .*$", f"pose_clock_offset_ns: {OFFSET_NS}", head.read_text(), flags=re.M)
    assert changed == 1
    head.write_text(text)
    stamps, exposures = stamps_of(copy / "pose0" / "data.csv"), stamps_of(copy / "cam0" / "data.csv")
    counts = {stamp: -(2**40) - 7 * i * i for i, stamp in enumerate(stamps)}
    after = bisect.bisect_left(stamps, exposures[len(exposures) // 2] + OFFSET_NS)
    for stamp in stamps[after - 1 : after + 1]:
        del counts[stamp]
    rows = "".join(f"{stamp},{ticks}\n" for stamp, ticks in counts.items())
    (copy / "pose0" / "encoder.csv").write_text("#timestamp [ns],encoder [ticks]\n" + rows)
    return copy, counts


def allowed(counts, stamps, exposure_ns):
    """What the count may be: linear between the two poses about the exposure, to the nearest tick; {None}: there is none."""
    at = exposure_ns + OFFSET_NS
    i = bisect.bisect_left(stamps, at)
    assert 0 < i < len(stamps) and stamps[i] != at, "an exposure between two poses"
    if stamps[i - 1] not in counts or stamps[i] not in counts:
        return {None}
    before, after = counts[stamps[i - 1]], counts[stamps[i]]
    exact = before + fractions.Fraction((after - before) * (at - stamps[i - 1]), stamps[i] - stamps[i - 1])
    return {n for n in range(int(exact) - 2, int(exact) + 3) if abs(n - exact) <= fractions.Fraction(500_001, 1_000_000)}


def check(copy, counts, profiles):
    """Each profile (exposure_mid_ns, encoder_ticks) has the count that its poses give; how many have one."""
    stamps, having = stamps_of(copy / "pose0" / "data.csv"), 0
    for profile in profiles:
        assert profile["encoder_ticks"] in allowed(counts, stamps, profile["exposure_mid_ns"]), profile
        having += profile["encoder_ticks"] is not None
    assert having == len(profiles) - 1 > 3, (having, len(profiles))
    return having
