# SPDX-License-Identifier: MIT
"""Whoever looks on: the person who works, a second one, and a page that was just loaded are told the same."""
from stop_cell import comes_true

TOLD = ("phase", "scan", "process", "process_by", "offers", "held", "teaching")


def told(state):
    """Without what passes with time."""
    held = state["held"] and {key: state["held"][key] for key in ("scan", "waits_for", "version")}
    return {**{key: state[key] for key in TOLD}, "held": held}


def looks(cell, path):
    """What each of them is told, the first one twice: at a moment when nothing changes all are alike."""
    reloaded = cell.call("POST", "/sessions", {"name": "ada", "password": "a long password"})[1]["token"]
    return [cell.call("GET", path, token=token)[1] for token in (cell.token, cell.viewer, reloaded, cell.token)]


def everybody_sees(cell, step, **expected):
    """Looks at the state that agree; what they tell."""
    def agree():
        seen = [told(look) for look in looks(cell, "/state")]
        if any(look != seen[0] for look in seen) or any(seen[0][key] != value for key, value in expected.items()):
            return None
        return seen[0]
    look = comes_true(agree, f"{step}: {expected}")
    print(f"{step}: {look['phase']}, {look['process']} by {look['process_by']}, held {look['held']}, teaching {look['teaching']}", flush=True)
    return look


def everybody_reads(cell, path):
    """One thing, the same for all."""
    def agree():
        seen = looks(cell, path)
        return seen[0] if all(look == seen[0] for look in seen) else None
    return comes_true(agree, f"all read the same at {path}")


def put_process(cell, name, **changed):
    """Into the service's list: the cell's own one under another name, with lines of it changed."""
    folder = cell.results / "processes"
    folder.mkdir(exist_ok=True)
    lines = (cell.results.parent / "grind.yaml").read_text().splitlines()
    for key, value in {"name": name, **changed}.items():
        [at] = [i for i, line in enumerate(lines) if line.strip().startswith(key + ":")]
        lines[at] = lines[at][:lines[at].index(key)] + f"{key}: {value}"
    (folder / f"{name}.yaml").write_text("\n".join(lines) + "\n")
