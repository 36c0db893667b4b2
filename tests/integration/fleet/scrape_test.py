#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""scrape_test.py HOST WEB FLEET PROMETHEUS_FILES: a real Prometheus reads a cell and the centre by the shipped settings.

Both give their numbers for a token only, also on loopback; it opens nothing else, and once it is dropped it opens nothing.
Neither sensor nor broker nor database is there: that, too, is told.
"""
import json
import pathlib
import shutil
import ssl
import subprocess
import sys
import tempfile
import urllib.error
import urllib.parse
import urllib.request

sys.path.append(str(pathlib.Path(__file__).parents[2] / "support"))
from programs import PATIENCE_S, Program, comes_true  # noqa: E402

HOST, WEB, FLEET, SHIPPED = sys.argv[1:5]
CELL, CENTRE, PROMETHEUS = "https://127.0.0.1:8443", "http://127.0.0.1:9118", "http://127.0.0.1:9090"


def status_of(address, token=None):
    any_name = ssl.create_default_context()
    any_name.check_hostname, any_name.verify_mode = False, ssl.CERT_NONE
    request = urllib.request.Request(address, headers={"Authorization": f"Bearer {token}"} if token else {})
    try:
        with urllib.request.urlopen(request, timeout=PATIENCE_S, context=any_name) as answer:
            return answer.status
    except urllib.error.HTTPError as error:
        return error.code


def value_of(question):
    """Of one series; nothing where there is none."""
    with urllib.request.urlopen(f"{PROMETHEUS}/api/v1/query?query={urllib.parse.quote(question)}", timeout=PATIENCE_S) as answer:
        series = json.load(answer)["data"]["result"]
    assert len(series) <= 1, series
    return float(series[0]["value"][1]) if series else None


def alarms():
    with urllib.request.urlopen(f"{PROMETHEUS}/api/v1/alerts", timeout=PATIENCE_S) as answer:
        return {alarm["labels"]["alertname"] for alarm in json.load(answer)["data"]["alerts"]}


def settings(folder):
    """The shipped ones with this test's addresses, files and haste."""
    text = pathlib.Path(SHIPPED, "prometheus.yml").read_text()
    for shipped, ours in (("/etc/prometheus", str(folder)), ("/usr/share/biteline/prometheus", SHIPPED), ("cell-1.example:8443", "127.0.0.1:8443"),
                          ('      - targets: ["cell-2.example:8443"]\n        labels: {cell: cell-2}\n', ""), ("interval: 15s", "interval: 1s")):
        assert shipped in text, shipped
        text = text.replace(shipped, ours)
    folder.joinpath("prometheus.yml").write_text(text)


def main(folder, programs):
    results, accounts = folder / "results", folder / "accounts"
    tokens = {name: folder / f"biteline-{name}.token" for name in ("cells", "fleet")}
    subprocess.run(["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes", "-keyout", folder / "key.pem",
                    "-out", folder / "biteline-ca.pem", "-days", "2", "-subj", "/CN=cell-1", "-addext", "subjectAltName=IP:127.0.0.1"],
                   check=True, capture_output=True)
    programs.append(Program(HOST, "--sensor", "tcp://127.0.0.1:1", "--out", results, "--control", "tcp://127.0.0.1:7118"))
    programs[-1].line_with("doors come in at")
    programs.append(Program(WEB, "--listen", "127.0.0.1:8443", "--control", "tcp://127.0.0.1:7118", "--certificate", folder / "biteline-ca.pem",
                            "--key", folder / "key.pem", "--exit-with-parent"))
    programs[-1].line_with("https://")
    programs.append(Program(FLEET, "--database", "host=127.0.0.1 port=1 connect_timeout=1", "--broker", "mqtt://127.0.0.1:1", "--metrics", "9118",
                            "--accounts", accounts, "--exit-with-parent"))
    programs[-1].line_with("/metrics")
    for address in (CELL, CENTRE):
        assert status_of(f"{address}/metrics") == status_of(f"{address}/metrics", "0" * 64) == 401, address

    def use_token():
        subprocess.run([WEB, "--out", results, "--metrics-token", tokens["cells"]], check=True)

    use_token()
    subprocess.run([FLEET, "--accounts", accounts, "--metrics-token", tokens["fleet"]], check=True)
    settings(folder)
    programs.append(Program("prometheus", f"--config.file={folder / 'prometheus.yml'}", f"--storage.tsdb.path={folder / 'series'}",
                            "--web.listen-address=127.0.0.1:9090", "--log.level=warn"))
    comes_true(lambda: status_of_or_none(f"{PROMETHEUS}/-/ready") == 200, "a Prometheus that answers")
    for job in ("biteline-cells", "biteline-fleet"):
        comes_true(lambda: value_of(f'up{{job="{job}"}}') == 1, f"{job} is read")
    # A scrape may take longer than its second here, and all of its series are gone then: until the next one.
    comes_true(lambda: value_of('biteline_host_up{cell="cell-1"}') == 1, "the cell's service is told")
    comes_true(lambda: (value_of('biteline_disk_free_bytes{cell="cell-1"}') or 0) > 0, "the cell's disk is told")
    for name in ("database", "broker"):
        comes_true(lambda: value_of(f"biteline_fleet_{name}_up") == 0, f"the {name} is told as away")
    comes_true(lambda: {"BitelineFleetWithoutDatabase", "BitelineFleetWithoutBroker"} <= alarms(), "the shipped rules see it")
    comes_true(lambda: "BitelineUnread" not in alarms(), "all is read")

    token = tokens["cells"].read_text().strip()
    for path in ("/api/v1/state", "/api/v1/sensors", "/api/v1/scans", "/api/v1/exchange/metrics"):
        assert status_of(CELL + path, token) in (401, 404), path
    assert status_of(f"{CENTRE}/metrics", token) == 401, "a cell's token at the centre"

    subprocess.run([WEB, "--out", results, "--drop-metrics-token"], check=True)
    assert status_of(f"{CELL}/metrics", token) == 401
    comes_true(lambda: value_of('up{job="biteline-cells"}') == 0, "without its token the cell is not read")
    comes_true(lambda: "BitelineUnread" in alarms(), "which is an alarm")
    use_token()
    comes_true(lambda: value_of('up{job="biteline-cells"}') == 1, "the same file's token is taken again")
    print("a Prometheus reads cell and centre by their tokens, and nothing else with them")


def status_of_or_none(address):
    try:
        return status_of(address)
    except OSError:
        return None


if __name__ == "__main__":
    if not shutil.which("prometheus"):
        print("skipped: no prometheus")
        sys.exit(77)
    RUNNING = []
    with tempfile.TemporaryDirectory() as work:
        try:
            main(pathlib.Path(work), RUNNING)
        except BaseException:
            for one in RUNNING:
                print(" ".join(one.command), *one.lines[-10:], sep="\n  ")
            raise
        finally:
            for one in reversed(RUNNING):
                one.end()
