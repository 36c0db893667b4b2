#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""installed_test.py BUILD SOURCE TOOL SENSOR CXX: libbiteline as a stranger gets it.

The components library, dev and python are installed into an empty folder.  Examples and strangers' programs are built and run
from that folder alone.  What they find must be, byte for byte, what the tool finds in the same files.
"""
import json
import math
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

SKIPPED = 77
BUILD, SOURCE, TOOL, SENSOR = (pathlib.Path(word) for word in sys.argv[1:5])
CXX = sys.argv[5]
GOLDEN = SOURCE / "tests/golden"
HERE = pathlib.Path(__file__).parent
EXPORTED = ("_ZN8biteline3sdk", "_ZNK8biteline3sdk", "_ZTIN8biteline3sdk", "_ZTSN8biteline3sdk", "_ZTVN8biteline3sdk")


def run(*command, **more):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False, **more)
    assert done.returncode == 0, f"{command}: {done.returncode}\n{done.stdout[-3000:]}\n{done.stderr[-3000:]}"
    return done.stdout


class Installed:
    def __init__(self, work):
        self.prefix = work / "installed"
        for component in ("library", "dev", "python"):
            run("cmake", "--install", BUILD, "--component", component, "--prefix", self.prefix)
        self.libraries = next(self.prefix.glob("lib/*-linux-gnu*"))
        self.env = dict(os.environ, LD_LIBRARY_PATH=str(self.libraries), PKG_CONFIG_PATH=str(self.libraries / "pkgconfig"))
        self.env["PYTHONPATH"] = str(self.prefix / "lib/python3/dist-packages")
        self.env["PYTHONDONTWRITEBYTECODE"] = "1"
        self.has_python = (self.prefix / "lib/python3/dist-packages/biteline").is_dir()
        self.bin = work / "examples"
        run("cmake", "-S", self.prefix / "share/doc/libbiteline-dev/examples", "-B", self.bin, "-G", "Ninja",
            "-DCMAKE_CXX_COMPILER=" + CXX, "-DCMAKE_BUILD_TYPE=Debug", "-DCMAKE_PREFIX_PATH=" + str(self.prefix))
        run("cmake", "--build", self.bin)

    def cpp(self, example, *arguments):
        return run(self.bin / example, *arguments, env=self.env)

    def python(self, example, *arguments):
        script = self.prefix / "share/doc/python3-biteline/examples" / f"{example}.py"
        return run("/usr/bin/python3", script if script.exists() else example, *arguments, env=self.env)

    def both(self, example, work, *arguments):
        """The file that each language writes: last argument."""
        ways = [self.cpp] + ([self.python] if self.has_python else [])
        for number, way in enumerate(ways):
            out = work / f"{example}_{number}.csv"
            way(example, *arguments, out)
            yield out.read_bytes()


def check_surface(installed):
    """Nothing but the public namespace is exported, and the headers need nothing of the source tree."""
    library = installed.libraries / "libbiteline.so"
    names = run("nm", "-D", "--defined-only", "--format=just-symbols", library).split()
    odd = [name for name in names if not name.startswith(EXPORTED) and name.split("@")[0] != "BITELINE_0"]
    assert len(names) > 50 and not odd, f"exported: {odd[:10]} of {len(names)}"
    for header in (installed.prefix / "include").rglob("*.hpp"):
        for line in header.read_text().splitlines():
            if line.startswith('#include "'):
                assert line.startswith('#include "biteline/'), f"{header.name}: {line}"


def check_strangers(installed, work):
    cloud = GOLDEN / "sample/cloud.ply"
    flags = run("pkg-config", "--cflags", "--libs", "biteline", env=installed.env).split()
    run(CXX, "-std=c++20", HERE / "stranger.cpp", "-o", work / "stranger", *flags)
    told = [run(work / "stranger", cloud, env=installed.env)]
    if installed.has_python:
        told.append(installed.python(HERE / "stranger.py", cloud))
    run(TOOL, "extract", cloud, "--out", work / "strangers")
    rows = (work / "strangers/line.csv").read_text().splitlines()[1:]
    places = [[float(word) for word in row.split(",")[:3]] for row in rows]
    expected = sum(math.dist(places[i - 1], places[i]) for i in range(len(places)))
    for words in told:
        height, length = (float(word) for word in words.split())
        # line.csv has places to 0.00001 mm: half of it in a mean, and at most 2 sqrt(3) halves in each piece's length.
        assert abs(height - sum(place[2] for place in places) / len(places)) < 1e-5
        assert abs(length - expected) < len(places) * math.sqrt(3) * 1e-5, (length, expected)


def check_same_as_tool(installed, work):
    sample, upper = GOLDEN / "sample/cloud.ply", GOLDEN / "upper/cloud.ply"
    process = SOURCE / "host/robot/path/processes/spray.yaml"
    run(TOOL, "extract", sample, "--out", work / "sample")
    line = work / "sample/line.csv"
    for found in installed.both("find_line", work, sample):
        assert found == line.read_bytes(), "the library's line is not the tool's"
    shutil.copy(sample, work / "sample/cloud.ply")
    run(TOOL, "transfer", "--sample", work / "sample", "--upper", upper, "--out", work / "upper")
    for carried in installed.both("transfer", work, work / "sample", upper):
        assert carried == (work / "upper/line.csv").read_bytes(), "the library's carried line is not the tool's"
    places = [[float(word) for word in row.split(",")[:2]] for row in line.read_text().splitlines()[1:]]
    x, y = (round(sum(place[k] for place in places) / len(places)) for k in (0, 1))
    run(TOOL, "plan", line, "--process", process, "--robot", "UR10e", "--base-at", x, y - 600, 0, 0, "--out", work / "path")
    for planned in installed.both("plan", work, line, process):
        assert planned == (work / "path/path.csv").read_bytes(), "the library's path is not the tool's"


def check_refusals(installed, work):
    lines = ["import biteline, sys", "try: biteline.find_line(biteline.read_cloud(sys.argv[1]))",
             "except biteline.Refused as e: print(e.reason_code, bool(str(e)), bool(e.next_step))"]
    done = subprocess.run([installed.bin / "find_line", GOLDEN / "upper/cloud.ply", work / "none.csv"], capture_output=True,
                          text=True, env=installed.env, check=False)
    assert done.returncode == 3 and done.stderr.startswith("no_crease: "), done
    done = subprocess.run([installed.bin / "find_line", work / "missing.ply", work / "none.csv"], capture_output=True,
                          text=True, env=installed.env, check=False)
    assert done.returncode == 2 and "missing.ply" in done.stderr, done
    if installed.has_python:
        told = run("/usr/bin/python3", "-c", "\n".join(lines), GOLDEN / "upper/cloud.ply", env=installed.env)
        assert told.split() == ["no_crease", "True", "True"], told


def check_calibration(installed, work):
    run(TOOL, "calibrate", GOLDEN / "head", "--out", work / "head")

    def numbers(text):
        return [line for line in text.splitlines() if not line.startswith("comment:")]

    assert numbers(installed.cpp("calibrate", GOLDEN / "head")) == numbers((work / "head/sensor.yaml").read_text())


def check_live_scan(installed, work):
    """A sensor that replays a recording, as a client sees it: the points of the tool's replay."""
    program = subprocess.Popen([SENSOR, "--source", f"replay:{GOLDEN / 'part'}", "--exit-with-parent"], stdout=subprocess.PIPE, text=True)
    endpoint = json.loads(program.stdout.readline())["endpoint"]
    told = installed.cpp("live_scan", endpoint, work / "scan.btln", work / "live.ply")
    assert program.wait(timeout=30) == 0
    # A part of a shoe: there are points, and no line.
    replay = subprocess.run([TOOL, "replay", GOLDEN / "part", "--out", work / "replay"], capture_output=True, text=True, check=False)
    assert replay.returncode == 3, replay.stderr
    assert (work / "live.ply").read_bytes() == (work / "replay/cloud.ply").read_bytes(), told
    if installed.has_python:
        read = installed.python("recording", work / "scan.btln")
        assert read.split(" ")[0] == told.split(" ")[0] and "not whole" not in read, (read, told)
    whole = (work / "scan.btln").read_bytes()
    (work / "cut.btln").write_bytes(whole[: len(whole) * 2 // 3])
    if installed.has_python:
        assert "not whole" in installed.python("recording", work / "cut.btln")


def check_npm(installed, work):
    """The package as npm packs it reads the live scan's points, and says what is cut."""
    if shutil.which("npm") is None or not installed.has_python:
        return
    packed = run("npm", "pack", SOURCE / "host/library/npm", "--pack-destination", work, "--loglevel=error", cwd=work).strip()
    run("tar", "-xzf", work / packed.splitlines()[-1], "-C", work)
    reader = work / "package/index.js"

    def read(scan):
        return json.loads(run("node", HERE / "read_scan.mjs", reader, scan, work / "sample/line.csv"))

    lines = ["import biteline, json, sys", "scan = biteline.read_recording(sys.argv[1])", "line = biteline.read_line(sys.argv[2])",
             "print(json.dumps([len(scan.profiles), len(scan.cloud), scan.cloud.points_mm.astype(float).mean(axis=0).tolist(),"
             " len(line), line.positions_mm[0].tolist()]))"]
    told = read(work / "scan.btln")
    profiles, points, mean, count, first = json.loads(
        run("/usr/bin/python3", "-c", "\n".join(lines), work / "scan.btln", work / "sample/line.csv", env=installed.env))
    assert (told["profiles"], told["points"], told["line"], told["first"]) == (profiles, points, count, first), told
    # The cloud holds single precision: 0.00006 mm at 1 m for each point, less for their mean.
    assert max(abs(a - b) for a, b in zip(told["mean"], mean)) < 6e-5, (told, mean)
    assert told["complete"] and "BTLNSCAN" in told["refused"]
    cut = read(work / "cut.btln")
    assert not cut["complete"] and 0 < cut["profiles"] < profiles


def check_stripe(installed):
    if not installed.has_python:
        return
    told = installed.python("stripe", GOLDEN / "head/truth/sensor.yaml").split()
    # Of 1626 columns none is off by more than five of the standard deviations that the finder itself states for a row.
    sensor = str(GOLDEN / "head/truth/sensor.yaml")
    lines = [f"import biteline; head = biteline.read_head({sensor!r}); u, v = head.width_px / 2, head.height_px / 2",
             "z = head.triangulate([u, u], [v, v + 1])[:, 2]; print(abs(z[1] - z[0]))"]
    mm_per_px = float(run("/usr/bin/python3", "-c", "\n".join(lines), env=installed.env))
    assert int(told[0]) > 100 and float(told[told.index("error") + 1]) < 5 * float(told[-2]) * mm_per_px, (told, mm_per_px)


def check_types(installed):
    if not installed.has_python or shutil.which("mypy") is None:
        return
    examples = installed.prefix / "share/doc/python3-biteline/examples"
    env = dict(installed.env, MYPYPATH=installed.env["PYTHONPATH"])
    for script in sorted(examples.glob("*.py")):
        run("mypy", "--strict", "--python-executable", "/usr/bin/python3", "--cache-dir", "/dev/null", script, env=env)
    # Each name of the module has its types, and each type its name.
    lines = ["import ast, biteline, pathlib", "tree = ast.parse(pathlib.Path(biteline.__file__ + 'i').read_text())",
             "typed = {n.name for n in tree.body if isinstance(n, (ast.FunctionDef, ast.ClassDef))} - {'Stripe'}",
             "print(sorted(typed ^ {n for n in dir(biteline) if n[0] != '_'}))"]
    assert run("/usr/bin/python3", "-c", "\n".join(lines), env=installed.env).strip() == "[]"


def main():
    work = pathlib.Path(tempfile.mkdtemp(prefix="biteline-library-"))
    try:
        if not (BUILD / "lib/libbiteline.so").exists():
            print("skipped: libbiteline was not built")
            return SKIPPED
        installed = Installed(work)
        check_surface(installed)
        check_strangers(installed, work)
        check_refusals(installed, work)
        check_same_as_tool(installed, work)
        check_calibration(installed, work)
        check_live_scan(installed, work)
        check_npm(installed, work)
        check_stripe(installed)
        check_types(installed)
        return 0
    finally:
        shutil.rmtree(work, ignore_errors=True)


sys.exit(main())
