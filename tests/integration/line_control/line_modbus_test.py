#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""line_modbus_test.py HOST WEB SENSOR EXAMPLES: pymodbus chooses a job, starts, reads; and peers of the wrong kind."""
import random
import socket
import struct
import sys
import time

try:
    from pymodbus.client import ModbusTcpClient
except ImportError as error:
    print("skipped:", error, "(python3-pymodbus and python3-serial-asyncio)")
    sys.exit(77)
from line_cell import NAMES, PART_BYTES, PART_REGISTERS, PATIENCE_S, READY, Cell, comes_true

JOB, START, STOP, PART = 0, 1, 2, 3
UNKNOWN_JOB, BUSY, PERSON_STOPPED = 1, 3, 6
STOPPED = 6
REFUSED = 3
# Of the bits that are read (function 2).
BIT_READY, BIT_BUSY, BIT_DONE, BIT_PERSON, BIT_ALIVE = range(5)


def state_of(plc):
    return dict(zip(NAMES, plc.read_input_registers(0, len(NAMES)).registers, strict=True))


def job_start_and_verdict(cell, plc):
    comes_true(lambda: state_of(plc)["step"] == READY, "ready")
    assert plc.read_discrete_inputs(0, 5).bits[:5] == [True, False, False, False, True]
    assert not plc.write_register(JOB, 9).isError() and state_of(plc)["refusal"] == UNKNOWN_JOB
    assert not plc.write_register(JOB, 1).isError()
    assert state_of(plc)["refusal"] == 0 and plc.read_holding_registers(0, 2).registers == [1, 0]
    assert not plc.write_register(START, 5).isError()
    state = state_of(plc)
    assert (state["busy"], state["done"], state["taken"]) == (1, 0, 5), state
    plc.write_register(START, 6)
    assert state_of(plc)["refusal"] == BUSY
    # 0 puts the register back and is no start.
    plc.write_register(START, 0)
    comes_true(lambda: plc.read_discrete_inputs(0, 5).bits[BIT_DONE], "done")
    state = state_of(plc)
    assert (state["busy"], state["finished"], state["verdict"], state["job"], state["refused"]) == (0, 5, REFUSED, 1, 1), state


def a_control_that_writes_all_each_turn(cell, plc):
    """As the cyclic exchange of a PLC: both registers, each turn, until the scan is done."""
    before = cell.scans_asked()

    def turn():
        assert not plc.write_registers(JOB, [2, 7]).isError()
        state = state_of(plc)
        assert state["refusal"] == 0, state
        return state["done"] and state["finished"] == 7

    comes_true(turn, "done")
    for _ in range(5):
        turn()
    assert cell.scans_asked() == before + 1 and state_of(plc)["job"] == 2


def registers_of(part):
    letters = part.encode().ljust(PART_BYTES, b"\0")
    return [letters[i] << 8 | letters[i + 1] for i in range(0, PART_BYTES, 2)]


def text_of(registers):
    return b"".join(bytes(divmod(pair, 256)) for pair in registers).rstrip(b"\0").decode()


def a_part_number_goes_with_its_scan(cell, plc):
    part_of_last = lambda: text_of(plc.read_input_registers(len(NAMES), PART_REGISTERS).registers)
    part_of_next = lambda: text_of(plc.read_holding_registers(PART, PART_REGISTERS).registers)
    assert part_of_last() == "" == part_of_next()
    assert not plc.write_registers(PART, registers_of("x" * PART_BYTES)).isError() and part_of_next() == "x" * PART_BYTES
    # A shorter one leaves nothing of it, blanks at its end are none of it, and zeros take it back.
    assert not plc.write_registers(PART, registers_of("A-17  ")[:4]).isError() and part_of_next() == "A-17"
    assert not plc.write_register(PART, 0).isError() and part_of_next() == ""
    # All in one write, each turn until it is done.
    turns = [1, 8, 0] + registers_of("A-18")

    def done():
        assert not plc.write_registers(JOB, turns).isError()
        state = state_of(plc)
        assert state["refusal"] == 0, state
        return state["done"] and state["finished"] == 8

    assert not plc.write_registers(JOB, turns).isError()
    assert part_of_next() == "A-18" and state_of(plc)["busy"]
    plc.write_registers(PART, registers_of("A-19"))
    assert state_of(plc)["refusal"] == BUSY and part_of_next() == "A-18"
    comes_true(done, "done")
    assert part_of_last() == "A-18"
    # A piece of a number would be another one, and so would be letters behind its end.
    for answer, code in (
        (plc.write_register(PART + 1, 0x4141), 2),
        (plc.write_registers(PART + 1, [0x4141, 0]), 2),
        (plc.write_register(PART, 1), 3),
        (plc.write_registers(PART, [0x4100, 0x4100]), 3),
        (plc.write_registers(PART, [0x4109]), 3),
        (plc.write_registers(PART, registers_of("x") + [0]), 2),
    ):
        assert answer.isError() and answer.exception_code == code, (answer, code)
    assert not plc.write_register(PART, 0).isError()


def the_line_stops(cell, plc):
    """A control that writes all registers each turn starts nothing while its stop stands, and afterwards a person must."""
    before = cell.scans_asked()
    assert plc.read_holding_registers(STOP, 1).registers == [0]
    # 0 puts the register back and is no stop.
    assert not plc.write_register(STOP, 0).isError() and state_of(plc)["step"] != STOPPED
    for _ in range(5):
        assert not plc.write_registers(JOB, [1, 90, 1]).isError()
        assert state_of(plc)["step"] == STOPPED and plc.read_holding_registers(STOP, 1).registers == [1]
    assert not plc.write_registers(JOB, [1, 90, 0]).isError()
    assert state_of(plc)["refusal"] == PERSON_STOPPED
    time.sleep(0.5)
    assert cell.scans_asked() == before
    token = cell.log_in()
    assert cell.call("POST", "/control", {"action": "take"}, token)[0] == 200
    assert cell.call("POST", "/commands/start", {}, token)[0] == 202
    comes_true(lambda: cell.scans_asked() == before + 1 and not state_of(plc)["busy"], "a person's start")
    assert cell.call("POST", "/control", {"action": "release"}, token)[0] == 200
    rows = [row for row in cell.call("GET", "/log", token=token)[1]["entries"] if row["what"] == "stop"]
    assert [(row["who"], row["door"]) for row in rows] == [("the line's control", "modbus")], rows


def what_is_not_in_the_table_is_refused(plc):
    for answer, code in (
        (plc.read_input_registers(len(NAMES) + PART_REGISTERS, 1), 2),
        (plc.read_holding_registers(PART, PART_REGISTERS + 1), 2),
        (plc.write_register(PART + PART_REGISTERS, 1), 2),
        (plc.write_registers(JOB, [1, 9, 1] + [0] * (PART_REGISTERS + 1)), 2),
        (plc.read_coils(0, 1), 2),
        (plc.write_coil(0, True), 1),
        (plc.readwrite_registers(read_address=0, read_count=1, write_address=0, write_registers=[1]), 1),
    ):
        assert answer.isError() and answer.exception_code == code, (answer, code)
    assert state_of(plc)["taken"] == 7


def raw(port, bytes_, wait_s=PATIENCE_S):
    with socket.create_connection(("127.0.0.1", port), timeout=wait_s) as peer:
        peer.sendall(bytes_)
        try:
            return peer.recv(300)
        except ConnectionError:
            return b""


def frame(pdu, transaction=1, protocol=0, length=None):
    return struct.pack(">HHHB", transaction, protocol, len(pdu) + 1 if length is None else length, 1) + pdu


def bad_peers_hurt_nobody(cell, plc):
    port = cell.modbus_port
    read = struct.pack(">BHH", 4, 0, 1)
    assert raw(port, frame(read))[7:] == struct.pack(">BBH", 4, 2, 1)
    assert raw(port, frame(read, protocol=1)) == b"" and raw(port, frame(read, length=0)) == b""
    assert raw(port, frame(read, length=4000)) == b""
    # Sound frames with lengths and counts that do not fit: exception 3.
    for pdu in (read[:-1], read + b"x", struct.pack(">BHH", 4, 0, 0), struct.pack(">BHH", 4, 0, 126),
                struct.pack(">BHHB", 16, 0, 100, 2) + b"\0\1", struct.pack(">BHHB", 16, 0, 1, 200) + b"\0\1"):
        assert raw(port, frame(pdu))[7:9] == bytes([pdu[0] | 0x80, 3]), pdu
    assert raw(port, frame(bytes([43, 14, 1, 0])))[7:9] == bytes([43 | 0x80, 1])
    # Two requests in one piece, and one in pieces.
    both = raw(port, frame(read, 1) + frame(read, 2))
    assert both[:2] == b"\0\1"
    with socket.create_connection(("127.0.0.1", port), timeout=PATIENCE_S) as peer:
        for byte in frame(read, 3):
            peer.sendall(bytes([byte]))
            time.sleep(0.01)
        assert peer.recv(300)[:2] == b"\0\3"
    seed = 5
    rng = random.Random(seed)
    started = state_of(plc)["starts"]
    for _ in range(300):
        garbage = bytearray(frame(read)) if rng.random() < 0.5 else bytearray(rng.randbytes(rng.randrange(1, 300)))
        garbage[rng.randrange(len(garbage))] ^= rng.randrange(1, 256)
        # A peer that goes at once; a write of job or start is no garbage, so functions 6 and 16 are left out.
        if len(garbage) > 7 and garbage[7] in (6, 16):
            continue
        with socket.create_connection(("127.0.0.1", port), timeout=PATIENCE_S) as peer:
            peer.sendall(garbage)
    crowd = [socket.create_connection(("127.0.0.1", port), timeout=PATIENCE_S) for _ in range(60)]
    assert state_of(plc)["starts"] == started, "who was there before is served"
    turned_away = 0
    for one in crowd:
        try:
            one.sendall(frame(read))
            turned_away += one.recv(300) == b""
        except ConnectionError:
            turned_away += 1
        one.close()
    assert 45 <= turned_away < 60, turned_away
    # Answers that nobody takes are not kept: the connection ends, the door goes on.
    with socket.create_connection(("127.0.0.1", port), timeout=1) as deaf:
        deaf.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 2048)
        try:
            for _ in range(200_000):
                deaf.sendall(frame(struct.pack(">BHH", 4, 0, 23)) * 20)
        except OSError:
            pass
        else:
            raise AssertionError("a peer that never reads was served without end")
    assert state_of(plc)["map"] == 1


def main():
    with Cell(*sys.argv[1:4]) as cell:
        plc = ModbusTcpClient("127.0.0.1", port=cell.modbus_port, timeout=PATIENCE_S)
        assert plc.connect()
        job_start_and_verdict(cell, plc)
        a_control_that_writes_all_each_turn(cell, plc)
        what_is_not_in_the_table_is_refused(plc)
        a_part_number_goes_with_its_scan(cell, plc)
        bad_peers_hurt_nobody(cell, plc)
        the_line_stops(cell, plc)
        plc.close()
    print("pymodbus reads what docs/line-control.md says")


main()
