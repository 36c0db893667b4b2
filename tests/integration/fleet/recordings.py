# SPDX-License-Identifier: MIT
"""Folders of scans as a service leaves them, for the tests of the fleet."""
import hashlib
import random


def make_recording(folder, scan, size, seed):
    """The folder of a scan, as the service leaves it; its files' SHA-256."""
    rng = random.Random(seed)
    files = {"report.json": b"{}\n", "scan.btln": rng.randbytes(size), "stages/one.png": rng.randbytes(1000), "empty": b""}
    for name, content in files.items():
        file = folder / scan / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(content)
    return {f"{scan}/{name}": hashlib.sha256(content).hexdigest() for name, content in files.items()}
