#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""stops_test.py HOST WEB SENSOR CELL PROCESSES [MOMENTS]: a stop stays a stop.

First the orders that once took one back: said before it and carried out after it, a start for the next shoe, a word about a scan
that waits.  Then a stop in MOMENTS random moments of scan, working-out, sending and following, behind each load, through each door:
nothing moves later, the tool is off.  MOMENTS of 200 takes long; some show that the rest works.
"""
import random
import sys
import threading
import time

from stop_cell import PATIENCE_S, Cell, ControlEnd, Doors, Load, comes_true

# From the press to an arm at rest, but for its braking: a stop is noticed within 20 ms and 100 ms more is the sensor's turn.
AT_ONCE_S = 0.3
# stopj(2.0): from 1 rad/s, the speed of a joint on its way to a path's beginning.
BRAKING_S = 0.5
# A thread of this test that wakes so late says that the machine stood still: no word about the stop then.
LATE_S = 0.025


class Lateness:
    """How late a thread that asks to be woken each 5 ms is, at worst, since begin()."""

    def __init__(self):
        self.worst_s = 0.0
        threading.Thread(target=self.run, daemon=True).start()

    def run(self):
        while True:
            asleep = time.monotonic()
            time.sleep(0.005)
            self.worst_s = max(self.worst_s, time.monotonic() - asleep - 0.005)

    def begin(self):
        self.worst_s = 0.0


def accept_of_before_is_over(cell, doors):
    """24 passwords are looked at, Accept waits behind them, Stop does not."""
    scan = cell.held()
    end = ControlEnd(cell.control)
    assert end.ask("GET", "/state", token=cell.token)[0] == 200
    for _ in range(24):
        end.say("PATCH", "/users/vic", {"password": "x" * 12, "old_password": "wrong wrong"}, cell.viewer)
    time.sleep(0.3)
    answers = {}

    def accept():
        answers["accept"] = (*cell.call("POST", f"/scans/{scan}/accept", {}, cell.token), time.monotonic())

    person = threading.Thread(target=accept, daemon=True)
    person.start()
    time.sleep(0.15)
    since, lines = time.monotonic(), len(cell.host.lines)
    doors.stop("page")
    stopped = time.monotonic()
    person.join(PATIENCE_S)
    status, body, answered = answers["accept"]
    print(f"accept answered {answered - since:.3f} s, stop {stopped - since:.3f} s after the press: {status} {body}", flush=True)
    assert answered > stopped, "the accept waited for nothing: this test shows nothing"
    assert status == 409, (status, body)
    ended(cell, scan, since, lines)


def ended(cell, scan, since, lines):
    cell.is_stopped()
    cell.stands(since)
    comes_true(lambda: cell.row(scan)["reason_code"] == "stopped_by_a_person", "the row says so")
    assert not cell.said("sends the path", lines), cell.host.lines[lines:]
    assert cell.state()["held"] is None and cell.arm.moved_after(since) is None
    status, body = cell.call("POST", f"/scans/{scan}/accept", {}, cell.token)
    assert status == 409 and "was stopped" in body["error"]["message"], body
    row = cell.row(scan)
    assert row["sent"] is False and row["next_step"] and row["decision"] in ("open", "accepted"), row


def word_after_a_stop_moves_nothing(cell, doors, names):
    for door in names:
        scan = cell.held()
        since, lines = time.monotonic(), len(cell.host.lines)
        doors.stop(door)
        for order in ("accept", "send", "air"):
            assert cell.call("POST", f"/scans/{scan}/{order}", {}, cell.token)[0] == 409, (door, order)
        ended(cell, scan, since, lines)


def start_after_a_stop_is_for_the_next_shoe(cell, doors):
    """Stopped while it is worked out; the start comes as soon as one is taken."""
    before, lines = cell.newest(), cell.start()
    comes_true(lambda: cell.said("takes in scan", lines), "the scan comes in")
    comes_true(lambda: cell.state()["phase"] in ("working", "following"), "it is worked out")
    since = time.monotonic()
    doors.stop("session")
    comes_true(lambda: cell.newest() > before, "its row")
    stopped = cell.newest()
    again = cell.start(hold=True)
    comes_true(lambda: cell.newest() > stopped, "the next scan")
    assert len(cell.said("takes in scan", again)) == 1
    paths = cell.said("sends the path", lines)
    assert len(paths) <= 1, paths
    cell.stands(since)
    row = cell.row(stopped)
    assert row["reason_code"] is not None and not row["followed"], row
    doors.stop("page")
    cell.is_stopped()


def of_many_words_one_counts(cell, doors):
    scan = cell.held()
    since = time.monotonic()
    answers = []

    def say(word):
        body = {} if word == "accept" else {"why": "no"}
        answers.append((word, cell.call("POST", f"/scans/{scan}/{word}", body, cell.token)[0]))

    people = [threading.Thread(target=say, args=("accept" if i % 2 else "reject",), daemon=True) for i in range(10)]
    for one in people:
        one.start()
    for one in people:
        one.join(PATIENCE_S)
    taken = [word for word, status in answers if status == 200]
    assert len(taken) == 1 and all(status in (200, 409) for _, status in answers), answers
    decision = cell.row(scan)["decision"]
    assert decision == taken[0] + "ed", (decision, answers)
    if taken == ["accept"]:
        status, body = cell.call("POST", f"/scans/{scan}/reject", {"why": "no"}, cell.token)
        assert status == 409 and "stop" in body["error"]["message"], body
    doors.stop("page")
    cell.stands(since)


def begun(cell, phase):
    """A scan in this phase, and the number of lines before it; the made scan's rays are far apart, so now and then there is no path."""
    for _ in range(8):
        before, lines = cell.newest(), cell.start()
        comes_true(lambda: cell.said("takes in scan", lines), "the scan comes in")
        if phase == "scan":
            return lines
        comes_true(lambda: cell.state()["phase"] != "scanning", "the scan is in")
        if phase == "working":
            return lines

        # A row may be there before the path is planned.
        def decided():
            return cell.said("sends the path", lines) or (cell.state()["phase"] == "waiting" and cell.newest() > before)

        if comes_true(decided, "the path, or the end of the work without one") is not True:
            return lines
    raise AssertionError("no scan of eight has a path")


def moment(cell, doors, door, load, phase, rng, lateness):
    """How long the press took until its answer, and until the arm stood."""
    lines = begun(cell, phase)
    with Load(cell, load):
        time.sleep(rng.random() * {"scan": 1.0, "working": 1.0, "sending": 0.3, "following": 4.0}[phase])
        lateness.begin()
        paths, since = len(cell.said("sends the path", lines)), time.monotonic()
        moving = cell.arm.moved_after(since - 0.1) is not None
        doors.stop(door)
        answered = time.monotonic()
        moved = cell.stands(since)
        late_s = lateness.worst_s
        # A path that left before the press was answered is followed no more; none leaves afterwards.
        left = len(cell.said("sends the path", lines))
        time.sleep(1)
        assert len(cell.said("sends the path", lines)) == left <= paths + 1, cell.host.lines[lines:]
    assert cell.arm.moved_after(answered + AT_ONCE_S + BRAKING_S + late_s) is None, (door, load, phase)
    cell.is_stopped()
    return answered - since, (moved or since) - since, late_s, moving


def random_moments(cell, doors, count, seed):
    rng, lateness = random.Random(seed), Lateness()
    longest = {}
    judged = arm_moved = 0
    plan = [(load, door, phase) for load in Load.NAMES for door in doors.NAMES
            for phase in ("scan", "working", "sending", "following")]
    rng.shuffle(plan)
    for number in range(count):
        load, door, phase = plan[number % len(plan)]
        answer_s, rest_s, late_s, moving = moment(cell, doors, door, load, phase, rng, lateness)
        best = longest.setdefault((load, door), [0, 0.0, 0.0, 0.0])
        best[0] += 1
        best[1:] = [max(a, b) for a, b in zip(best[1:], (answer_s, rest_s, late_s))]
        arm_moved += moving
        print(f"moment {number}: {phase}{', the arm moves' if moving else ''}, {load}, {door}: answered {answer_s:.3f} s, "
              f"at rest {rest_s:.3f} s, late {late_s:.3f} s", flush=True)
        if late_s <= LATE_S:
            judged += 1
            assert rest_s <= AT_ONCE_S + BRAKING_S, (load, door, phase, rest_s)
    print(f"{count} moments, seed {seed}, {judged} while the machine woke this test within {LATE_S} s, "
          f"{arm_moved} while the arm moved")
    # Else this test shows little.
    assert arm_moved > 0 or count < 10
    print("| load | door | moments | answered, s | at rest, s | machine late, s |\n| --- | --- | --- | --- | --- | --- |")
    for (load, door), (times, answer_s, rest_s, late_s) in sorted(longest.items()):
        print(f"| {load} | {door} | {times} | {answer_s:.3f} | {rest_s:.3f} | {late_s:.3f} |")


def main():
    count = int(sys.argv[6]) if len(sys.argv) > 6 else 2
    with Cell(*sys.argv[1:6]) as cell:
        doors = Doors(cell)
        accept_of_before_is_over(cell, doors)
        word_after_a_stop_moves_nothing(cell, doors, doors.NAMES if count > 10 else ("page", "modbus"))
        start_after_a_stop_is_for_the_next_shoe(cell, doors)
        of_many_words_one_counts(cell, doors)
        random_moments(cell, doors, count, seed=55)
    print("a stop stays a stop")


main()
