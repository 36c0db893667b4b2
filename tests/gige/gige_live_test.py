#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""gige_live_test.py FACE SENSOR CELL: light only by --allow-control, and only while a client acquires and lives.

The simulated cell, the sensor on its wires, and the face at an address of its own.  An observer of the native protocol
looks at the laser.  Leaves with 77 (skipped) where the camera's port is taken.
"""
import json
import pathlib
import subprocess
import sys
import tempfile
import threading
import time

HERE = pathlib.Path(__file__).parent
sys.path.insert(0, str(HERE))
from gige_client import Client, Refused, read_leader
from gige_test import register_of, wait_for_head

ADDRESS = "127.0.0.2"
OBSERVER_HELLO, HEALTH, LASER_SLOT = 11, 4, 2
ON = 1
HEARTBEAT = 0x938
MONO8 = 0x01080001
SKIPPED = 77
# The laser's guard takes 75 ms without a frame for a silent camera.  A cell whose pictures came late goes slower, by a
# fifth each time, and its camera with it: this rate leaves it room for five such steps.
RATE_HZ = 40


class LaserWatch(threading.Thread):
    """What each Health says of the laser, as an observer hears it."""

    def __init__(self, endpoint):
        super().__init__(daemon=True)
        self.known = {"__name__": "stranger"}
        source = HERE.parent.joinpath("stranger", "stranger.py").read_text()
        exec(source.split("def main")[0], self.known)  # without its last line, which runs it
        self.peer = self.known["Peer"](*endpoint.removeprefix("tcp://").rsplit(":", 1))
        self.states, self.changed = [], threading.Condition()
        self.start()

    def run(self):
        try:
            while True:
                # Empty: neither profiles nor pictures are wanted.
                self.peer.send(self.known["message"](0, OBSERVER_HELLO, []))
                data = self.peer.receive()
                envelope = self.known["Table"](data, int.from_bytes(data[:4], "little"))
                if envelope.number(3, "B") == HEALTH:
                    with self.changed:
                        self.states.append(envelope.table(4).number(LASER_SLOT, "B"))
                        self.changed.notify_all()
        except (SystemExit, OSError):
            pass

    def wait_for(self, on, patience=20):
        with self.changed:
            begun = len(self.states)
            return self.changed.wait_for(lambda: any((s == ON) == on for s in self.states[begun:]), patience)

    def never_on(self, seconds):
        begun = len(self.states)
        time.sleep(seconds)
        assert len(self.states) > begun + 2, "no health"
        return ON not in self.states[begun:]


def start(*command):
    """The program and the first line that it says; nothing when it ends instead."""
    program = subprocess.Popen([str(c) for c in command], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    return program, program.stdout.readline()


def stop(program):
    program.terminate()
    return program.communicate(timeout=60)[1]


def open_client(face, endpoint, *options):
    """A face, and a client that controls it and has aimed its stream."""
    device, said = start(face, "--sensor", endpoint, "--interface", ADDRESS, "--exit-with-parent", *options)
    assert said, stop(device)
    client = Client(ADDRESS)
    description = client.description()
    wait_for_head(client, register_of(description, "Width"))
    client.acquisition = register_of(description, "AcquisitionStart")
    client.pixel_format = register_of(description, "PixelFormat")
    client.take_control()
    client.write(HEARTBEAT, 60_000)
    client.aim_stream(8000)
    return device, client


def take_frames(client, count):
    packets = 0
    for _ in range(200):
        for _ in range(100):
            if not client.hear(0.1):
                break
            packets += 1
        if sum(client.whole(block) is not None for block in list(client.frames)) >= count:
            return
    raise AssertionError(f"{packets} packets, {len(client.frames)} frames")


def stripe_columns(leader, pixels):
    """In how many columns of a picture there is light."""
    facts = read_leader(leader)
    assert facts["format"] == MONO8 and facts["width"] * facts["height"] == len(pixels), (facts, len(pixels))
    width = facts["width"]
    return width, facts["height"], sum(max(pixels[x::width]) > 40 for x in range(width))


def check_pictures(client):
    """The camera's own; the first may be of before the light."""
    seen = set()
    for _ in range(200):
        take_frames(client, len(seen) + 1)
        for block in [b for b in sorted(client.frames) if b not in seen and client.whole(b)]:
            seen.add(block)
            width, height, lit = stripe_columns(*client.whole(block))
            if lit > width // 10:
                print(f"pictures: {width} x {height}, a stripe in {lit} columns", flush=True)
                return
    raise AssertionError(f"{len(seen)} pictures without light")


def shine(client, laser):
    """Starts until there is light.

    The simulated camera's pictures may come late on a busy machine.  The sensor takes that for a silent camera and is
    dark at once; the cell goes slower in the next scan.
    """
    for _ in range(6):
        client.write(client.acquisition, 0)
        client.write(client.acquisition, 1)
        if laser.wait_for(True, 5):
            return
    raise AssertionError("no light")


def lose_heartbeat(client, laser):
    """The client falls silent for its second, and the light lasts nearly as long."""
    for _ in range(6):
        client.write(HEARTBEAT, 1000)
        if not laser.wait_for(False, 0.8):
            return
        client.write(HEARTBEAT, 60_000)
        shine(client, laser)
    raise AssertionError("each light ended before the client's heartbeat")


def take_control_when_free(client):
    """The light may have ended for late pictures in the last fifth of the heartbeat's second."""
    begun = time.monotonic()
    while True:
        try:
            return client.take_control()
        except Refused:
            if time.monotonic() > begun + 1:
                raise
            time.sleep(0.05)


def check_looking_on(face, endpoint, laser):
    device, client = open_client(face, endpoint)
    client.write(client.acquisition, 1)
    assert laser.never_on(2), "light by a client that only looks on"
    assert not client.frames
    print("looking on:", stop(device).strip() or "no light, no frames", flush=True)


def check_control(face, endpoint, laser):
    device, client = open_client(face, endpoint, "--allow-control")
    assert laser.never_on(1), "light before a start"
    shine(client, laser)
    take_frames(client, 3)
    client.write(client.acquisition, 0)
    # Sooner than the scan would end by itself.
    assert laser.wait_for(False, 5), "light after the stop"
    print("control: light from AcquisitionStart to AcquisitionStop", flush=True)

    # The arm goes back; then a client that dies.
    client.frames.clear()
    client.write(client.pixel_format, MONO8)
    shine(client, laser)
    check_pictures(client)
    lose_heartbeat(client, laser)
    assert laser.wait_for(False, 5), "light without the client's heartbeat"
    print("control: dark without the client's heartbeat", flush=True)

    other = Client(ADDRESS)
    other.acquisition = client.acquisition
    take_control_when_free(other)
    other.write(HEARTBEAT, 60_000)  # not its silence darkens, but the program's end
    other.aim_stream(8000)
    shine(other, laser)
    device.kill()
    device.communicate()
    assert laser.wait_for(False), "light without the program"
    print("control: dark without the program", flush=True)


def main():
    face, sensor, cell = sys.argv[1:4]
    with tempfile.TemporaryDirectory() as folder:
        place = pathlib.Path(folder) / "cell"
        # A lamp's stripe takes less of a busy machine than a laser's: the speckle is no part of this test.
        serving, said = start(cell, "serve", "--speed-mm-s", 20, "--rate-hz", RATE_HZ, "--light", "lamp", "--out", place,
                              "--exit-with-parent")
        if not said:
            told = stop(serving)
            assert "3956" in told, told
            print("skipped: " + told)
            sys.exit(SKIPPED)
        place = json.loads(said)
        for rights in ("required", "ignore"):
            running, said = start(sensor, "--source", "board:" + place["board"], "--sensor", place["sensor"], "--rt", rights,
                                  "--exit-with-parent")
            if said:
                break
        assert said, stop(running)
        endpoint = json.loads(said)["endpoint"]
        laser = LaserWatch(endpoint)
        check_looking_on(face, endpoint, laser)
        check_control(face, endpoint, laser)
        stop(running)
        stop(serving)


main()
