# SPDX-License-Identifier: MIT
"""Programs that a test starts, and waiting for what they say."""
import signal
import subprocess
import threading
import time

PATIENCE_S = 120  # of a loaded machine


def comes_true(condition, what, patience_s=PATIENCE_S):
    """The condition's value, once it has one."""
    until = time.monotonic() + patience_s
    while time.monotonic() < until:
        value = condition()
        if value:
            return value
        time.sleep(0.05)
    raise AssertionError("never came true: " + what)


class Program:
    """One that this test started, in a process group of its own; its lines are kept."""

    def __init__(self, *command, user=None, cwd=None):
        self.lines = []
        self.command = [str(word) for word in command]
        self.process = subprocess.Popen(self.command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, user=user, cwd=cwd,
                                        start_new_session=True)
        threading.Thread(target=lambda: [self.lines.append(line.rstrip("\n")) for line in self.process.stdout], daemon=True).start()

    def line_with(self, words):
        return comes_true(lambda: next((line for line in list(self.lines) if words in line), None), words + "\n" + "\n".join(self.lines))

    def end(self, how=signal.SIGTERM):
        if self.process.poll() is None:
            self.process.send_signal(how)
            self.process.wait(PATIENCE_S)
