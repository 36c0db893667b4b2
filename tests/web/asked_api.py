# SPDX-License-Identifier: MIT
"""An API that runs, asked with made requests by each role and by nobody; each answer is judged by the document."""
import http.client
import json
import time
from collections import Counter

from check_api_answers import faults_of_answer
from made_requests import ANYBODY, Maker

ROLES = ["viewer", "operator", "engineer", "administrator"]
PASSWORD = "correct horse battery"
# An operation that ends a session is asked by nobody until the end.
ENDS_SESSION = "log_out"
# Judged before anybody looks who asks: address, type and length; and whether the program has such a thing, or its service, at all.
BEFORE_RIGHTS = {400, 404, 405, 413, 415, 426, 503, 504}


class AskedApi:
    """`port` of a biteline-web on loopback.  `holds_control`: a cell's; the centre has none to take."""

    def __init__(self, port, api, has_control):
        self.port, self.api, self.has_control = port, api, has_control
        self.link, self.tokens, self.held = None, {}, False
        self.faults, self.statuses, self.good = [], {}, set()

    def ask(self, method, path, body=b"", headers=None):
        """Status, type and body."""
        for last in (False, True):
            try:
                self.link = self.link or http.client.HTTPConnection("127.0.0.1", self.port, timeout=60)
                self.link.request(method, path, body or None, headers or {})
                answer = self.link.getresponse()
                return answer.status, answer.getheader("Content-Type", "").split(";")[0], answer.read()
            except (http.client.HTTPException, ConnectionError):
                # The server may close a connection between two requests.
                self.link = None
                if last:
                    raise
        raise AssertionError

    def session(self, role):
        return {"Authorization": f"Bearer {self.tokens[role]}"} if role else {}

    def call(self, method, path, body, role=None):
        """For the test's own ends: it must succeed."""
        headers = {"Content-Type": "application/json"} | self.session(role)
        status, _, text = self.ask(method, f"/api/v1{path}", json.dumps(body).encode(), headers)
        assert status < 300, f"{method} {path}: {status} {text[:300]}"
        return json.loads(text)

    def make_accounts(self):
        """One of each role; the first one is made without a session, on this machine."""
        for role in reversed(ROLES):
            name = f"the-{role}"
            self.call("POST", "/users", {"name": name, "role": role, "password": PASSWORD}, "administrator" if self.tokens else None)
            self.tokens[role] = self.call("POST", "/sessions", {"name": name, "password": PASSWORD})["token"]

    def hold(self, held):
        """The administrator takes control; and gives it up unless `held`."""
        if self.has_control:
            self.call("POST", "/control", {"action": "take"}, "administrator")
            if not held:
                self.call("POST", "/control", {"action": "release"}, "administrator")
        self.held = held

    def ask_everything(self, rounds, seed, known, alive):
        maker = Maker(self.api.text, seed, known)
        for turn in range(rounds):
            self.hold(turn % 4 != 3)
            for path, method, item, operation in maker.operations():
                name = operation["operationId"]
                maker.turn_to(operation, turn)
                role = None if name == ENDS_SESSION else maker.random.choice([None, *ROLES, *["administrator"] * 4])
                self.judge(maker.make(path, method, item, operation), role, operation)
                if name == "change_control":
                    self.hold(self.held)
            alive()

    def log_everybody_out(self):
        item = self.api.text["paths"]["/sessions"]
        for role in ROLES:
            self.judge(Maker(self.api.text, 0, {}).make("/sessions", "delete", item, item["delete"]), role, item["delete"])

    def judge(self, made, role, operation):
        began = time.monotonic()
        status, kind, text = self.ask(made.method, made.path, made.body, made.headers | self.session(role))
        took_s = time.monotonic() - began
        # A part of a file is no whole text.
        is_json = kind == "application/json" and status != 206
        try:
            body = json.loads(text) if is_json and text else None
            noted = {"method": made.method, "path": made.described, "status": status, "type": kind, "body": body}
            words = faults_of_answer(self.api, noted, set())
        except ValueError:
            words = ["no JSON"]
        words += ["failed inside"] if status == 500 else []
        words += [f"it took {took_s:.1f} s"] if took_s > 5 else []
        words += self.faults_of_rights(status, role, operation)
        self.faults += [f"{role}: {made.method} {made.path} {made.body[:200]!r}: {status} {text[:200]!r}: {one}" for one in words]
        self.statuses.setdefault(made.operation, Counter())[status] += 1
        if status < 400 or status == 426:
            self.good.add(made.operation)

    def faults_of_rights(self, status, role, operation):
        free = operation.get("security") in ANYBODY or operation.get("x-local") or "x-role" not in operation
        if free or status in BEFORE_RIGHTS:
            return []
        if role is None:
            return [] if status == 401 else ["nobody is logged in: 401 expected"]
        if ROLES.index(role) < ROLES.index(operation["x-role"]):
            return [] if status == 403 else [f"{operation['x-role']} is needed: 403 expected"]
        without_control = operation.get("x-control") and not (self.held and role == "administrator")
        return ["without control: 409 expected"] if without_control and status != 409 else []

    def table(self):
        return "\n".join(f"{name:26} {' '.join(f'{status}:{count}' for status, count in sorted(counts.items()))}" for name, counts in sorted(self.statuses.items()))

    def asked(self):
        return sum(sum(counts.values()) for counts in self.statuses.values())
