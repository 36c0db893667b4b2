#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""line_text_test.py HOST WEB SENSOR EXAMPLES: the text door, the two examples, and peers of the wrong kind."""
import json
import pathlib
import re
import signal
import subprocess
import sys
import time

from line_cell import AWAY, PART_BYTES, PATIENCE_S, READY, STOPPED, Cell, TextPeer, comes_true

UNKNOWN_JOB, NO_JOB, BUSY, CONTROL_HELD, PERSON_STOPPED, HOST_AWAY, BAD_REQUEST = 1, 2, 3, 5, 6, 8, 10
REFUSED = 3


def one_start_is_one_scan(cell, peer):
    comes_true(lambda: peer.state()["step"] == READY, "ready")
    assert cell.scans_asked() == 0, "a scan without a start"
    assert peer.ask("START 17") == [NO_JOB]
    assert peer.ask("JOB 9") == [UNKNOWN_JOB]
    assert peer.ask("JOB 7") == [UNKNOWN_JOB], "its model is not in the library"
    assert peer.ask("JOB 2") == [0]
    assert peer.ask("START 17") == [0]
    state = peer.state()
    assert (state["busy"], state["done"], state["taken"], state["job"]) == (1, 0, 17, 2), state
    assert peer.ask("START 17") == [0] and peer.ask("START 18") == [BUSY] and peer.ask("JOB 1") == [BUSY]
    comes_true(lambda: peer.state()["done"], "done")
    state = peer.state()
    # A plate is no shoe.
    assert (state["busy"], state["finished"], state["verdict"], state["sent"]) == (0, 17, REFUSED, 0), state
    assert (state["starts"], state["refused"], state["scan"]) == (1, 1, 1), state
    # Said again after a lost answer, it starts nothing.
    assert peer.ask("START 17") == [0]
    time.sleep(1)
    assert cell.scans_asked() == 1 and peer.state()["done"] == 1


def run_urscript(file, port, job, request):
    """The example as a controller runs it: URScript is near enough to Python; what it calls is as its manual says."""
    links = {}

    def socket_open(address, to_port, name):
        assert address == "192.0.2.1" and to_port == 7119
        links[name] = TextPeer(port)
        return True

    def socket_send_line(text, name):
        links[name].socket.sendall((text + "\n").encode())
        return True

    def socket_read_ascii_float(count, name, timeout):
        assert count <= 30
        line = links[name].reader.readline().decode()
        assert re.fullmatch(r"\([0-9]+(,[0-9]+)*\)\n", line), line
        numbers = [float(number) for number in line.strip()[1:-1].split(",")]
        return [float(len(numbers[:count]))] + numbers[:count]

    source = file.read_text()
    python = "\n".join(re.sub(r"\b(local|global) ", "", line) for line in source.split("\n") if line.strip() != "end")
    python = re.sub(r"\bTrue\b", "True", python)
    known = {
        "socket_open": socket_open,
        "socket_send_line": socket_send_line,
        "socket_read_ascii_float": socket_read_ascii_float,
        "socket_close": lambda name: links.pop(name).socket.close(),
        "sleep": time.sleep,
        "to_str": str,
        "str_cat": lambda a, b: str(a) + str(b),
        "textmsg": lambda *words: print("textmsg:", *words),
    }
    exec(python, known)
    return known["biteline_scan"](job, request)


def examples_work(cell, peer, examples):
    assert run_urscript(examples / "biteline.script", cell.text_port, 1, 30) == REFUSED
    assert peer.state()["finished"] == 30 and cell.scans_asked() == 2
    told = subprocess.run([sys.executable, str(examples / "line_client.py"), "127.0.0.1", str(cell.text_port), "2", "C-3"],
                          capture_output=True, text=True, timeout=PATIENCE_S)
    assert told.returncode == 3, told
    assert json.loads(told.stdout)["verdict"] == "refused", told
    assert cell.scans_asked() == 3 and peer.shoe() == "(C-3)\n"


def people_come_first(cell, peer):
    token = cell.log_in()
    # What is only for doors without login is no path of the page.
    for method, path in (("GET", "/line"), ("PUT", "/line/job"), ("PUT", "/line/part"), ("POST", "/line/start"), ("POST", "/line/stop")):
        assert cell.call(method, path, {}, token)[0] == 404
    assert cell.call("POST", "/control", {"action": "take"}, token)[0] == 200
    assert peer.ask("START 40") == [CONTROL_HELD] and peer.ask("JOB 1") == [CONTROL_HELD] and peer.ask("PART X") == [CONTROL_HELD]
    # The page's start is one scan, too, of the same machine.
    assert cell.call("POST", "/commands/start", {}, token)[0] == 202
    assert cell.call("POST", "/commands/start", {}, token)[0] == 409
    comes_true(lambda: (lambda state: state["done"] and not state["finished"])(peer.state()), "the page's scan")
    assert cell.scans_asked() == 4
    assert cell.call("POST", "/control", {"action": "release"}, token)[0] == 200
    assert cell.call("POST", "/commands/stop")[0] == 200
    comes_true(lambda: peer.state()["step"] == STOPPED, "stopped")
    assert peer.ask("START 41") == [PERSON_STOPPED]
    assert cell.call("POST", "/control", {"action": "take"}, token)[0] == 200
    assert cell.call("POST", "/commands/start", {}, token)[0] == 202
    comes_true(lambda: peer.state()["refused"] == 5, "the scan after a stop")
    assert cell.scans_asked() == 5
    assert cell.call("POST", "/control", {"action": "release"}, token)[0] == 200
    log = json.dumps(cell.call("GET", "/log", token=token)[1])
    assert "the line's control" in log and '"door": "text"' in log, log


def the_line_stops_and_a_person_starts_again(cell, peer):
    """Also behind its own start, in one piece: the stop is what counts."""
    asked = cell.scans_asked()
    peer.socket.sendall(b"START 60\nSTOP\n")
    answers = [peer.reader.readline() for _ in range(2)]
    assert answers[1] == b"(0)\n" and answers[0] in (b"(0)\n", b"(6)\n"), answers
    comes_true(lambda: peer.state()["step"] == STOPPED and not peer.state()["busy"], "stopped")
    assert peer.ask("START 61") == [PERSON_STOPPED] and peer.ask("STOP") == [0]
    time.sleep(1)
    assert cell.scans_asked() <= asked + 1 and peer.state()["sent"] == 0
    token = cell.call("POST", "/sessions", {"name": "ada", "password": "a long password"})[1]["token"]
    scans = cell.call("GET", "/scans", token=token)[1]["scans"]
    if cell.scans_asked() > asked:
        assert scans[0]["reason_code"] == "stopped_by_a_person", scans[0]
    assert cell.call("POST", "/control", {"action": "take"}, token)[0] == 200
    before = peer.state()["refused"]
    assert cell.call("POST", "/commands/start", {}, token)[0] == 202
    comes_true(lambda: peer.state()["refused"] == before + 1, "the scan after the line's stop")
    newest = cell.call("GET", "/scans", token=token)[1]["scans"][0]
    assert newest["reason_code"] != "stopped_by_a_person", newest
    assert cell.call("POST", "/control", {"action": "release"}, token)[0] == 200
    log = cell.call("GET", "/log", token=token)[1]["entries"]
    assert any(row["what"] == "stop" and row["who"] == "the line's control" and row["door"] == "text" for row in log), log


def a_part_number_is_of_one_shoe(cell, peer):
    """Of the next scan, whoever starts it, of the same shoe scanned again, and of no other one."""
    token = cell.call("POST", "/sessions", {"name": "ada", "password": "a long password"})[1]["token"]

    def newest():
        return cell.call("GET", "/scans", token=token)[1]["scans"][0]

    def next_row():
        """A scan's row is there at its end, and the door's state may be 0.1 s old."""
        nonlocal last
        comes_true(lambda: newest()["id"] != last, f"the scan behind {last}")
        row = newest()
        comes_true(lambda: peer.state()["scan"] == int(row["id"].removeprefix("scan-")), f"the end of {row['id']}")
        last = row["id"]
        return row

    last, longest = newest()["id"], "x" * PART_BYTES
    assert peer.ask("JOB 8") == [0] and peer.ask("PART  A-17 (left) ") == [0] and peer.ask("START 70") == [0]
    assert peer.ask("PART A-17 (left)") == [0] and peer.ask("PART B-1") == [BUSY]
    row = next_row()
    assert (row["part"], row["foot"], row["size"]) == ("A-17 (left)", "left", "EU 42"), row
    assert peer.shoe() == "(A-17 (left))\n"
    whole = cell.call("GET", "/scans/" + row["id"], token=token)[1]
    assert whole["report"]["part"] == "A-17 (left)" and whole["report"]["size"] == "EU 42", whole["report"]
    assert peer.ask("START 71") == [0]
    assert next_row()["part"] is None and peer.shoe() == "()\n"
    # The longest, taken back, and one that is too long.
    assert peer.ask("PART " + longest) == [0] and peer.ask("PART") == [0]
    assert peer.ask("PART " + longest + "x") == [BAD_REQUEST] and peer.ask("PART a\tb") == [BAD_REQUEST]
    assert peer.ask("PART " + longest) == [0]
    assert cell.call("POST", "/control", {"action": "take"}, token)[0] == 200
    assert cell.call("POST", "/commands/start", {}, token)[0] == 202
    assert next_row()["part"] == longest
    assert cell.call("POST", "/commands/start", {"part": "P-1"}, token)[0] == 202
    assert next_row()["part"] == "P-1"
    assert cell.call("POST", "/commands/rescan", {}, token)[0] == 202
    assert next_row()["part"] == "P-1", "the same shoe again"
    assert [one["part"] for one in cell.call("GET", "/scans?part=P-*", token=token)[1]["scans"]] == ["P-1", "P-1"]
    # After a stop nobody knows which shoe stands there.
    assert cell.call("POST", "/control", {"action": "release"}, token)[0] == 200
    assert peer.ask("PART A-20") == [0] and peer.ask("STOP") == [0]
    assert cell.call("POST", "/control", {"action": "take"}, token)[0] == 200
    assert cell.call("POST", "/commands/rescan", {}, token)[0] == 202
    assert next_row()["part"] is None
    assert cell.call("POST", "/control", {"action": "release"}, token)[0] == 200


def bad_peers_hurt_nobody(cell, peer):
    for line in ("", "JOB", "JOB -1", "JOB 1 2", "START 99999", "STATE ", "STOP 1", "JOB 1;START 3", "SHOE 1"):
        assert peer.ask(line) == [BAD_REQUEST], line
    # What is no word of this protocol may be another one: told, and ended before the next line is read.
    for line in ("HELLO", "start 3", "POST / HTTP/1.1\r\nHost: x\r\n\r\nJOB 1\nSTART 77"):
        stranger = TextPeer(cell.text_port)
        stranger.socket.sendall(line.encode() + b"\n")
        answer = b""
        try:
            while more := stranger.socket.recv(100):
                answer += more
        except ConnectionError:
            pass  # closed with lines unread
        assert answer in (b"(10)\n", b""), (line, answer)
    assert peer.state()["taken"] != 77
    long = TextPeer(cell.text_port)
    long.socket.sendall(b"S" * 200)
    assert long.ended()
    binary = TextPeer(cell.text_port)
    binary.socket.sendall(bytes(range(128, 256)) + b"\n")
    assert binary.ended()
    # One byte now and then is no request: the connection ends.
    slow = TextPeer(cell.text_port)
    slow.socket.sendall(b"ST")
    begin = time.monotonic()
    assert slow.ended() and time.monotonic() - begin >= 4
    crowd = [TextPeer(cell.text_port) for _ in range(40)]
    served = []
    for one in crowd:
        try:
            if one.ask("STATE"):
                served.append(one)
        except OSError:
            pass
    # Whoever comes later takes the place of one that asks nothing.
    assert 1 <= len(served) <= 16, len(served)
    assert peer.state()["map"] == 1, "who was there before is served"
    for one in crowd:
        one.socket.close()
    # The door notices one after the other that the crowd has gone.
    later = None

    def has_room():
        nonlocal later
        try:
            later = TextPeer(cell.text_port)
            return later.ask("STATE")
        except ConnectionError:
            return False

    comes_true(has_room, "room again")
    assert later.ask("BYE") is None


def service_that_is_away_is_told(cell, peer):
    beat = peer.state()["heartbeat"]
    comes_true(lambda: peer.state()["heartbeat"] > beat, "the heart beats")
    cell.host.end(signal.SIGKILL)
    comes_true(lambda: peer.state()["step"] == AWAY, "away")
    assert peer.ask("START 50") == [HOST_AWAY] and peer.ask("JOB 1") == [HOST_AWAY]
    beat = peer.state()["heartbeat"]
    time.sleep(2)
    state = peer.state()
    assert (state["heartbeat"], state["refusal"], state["ready"], state["busy"]) == (beat, HOST_AWAY, 0, 0), state


def main():
    host, web, sensor, examples = sys.argv[1:5]
    with Cell(host, web, sensor) as cell:
        peer = TextPeer(cell.text_port)
        one_start_is_one_scan(cell, peer)
        examples_work(cell, peer, pathlib.Path(examples))
        people_come_first(cell, peer)
        the_line_stops_and_a_person_starts_again(cell, peer)
        a_part_number_is_of_one_shoe(cell, peer)
        bad_peers_hurt_nobody(cell, peer)
        service_that_is_away_is_told(cell, peer)
    print("the text door keeps what docs/line-control.md says")


main()
