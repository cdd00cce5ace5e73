"""Write the outputs of the quick suites, or compare two sets of them.

    python -m tests.golden_outputs write FOLDER
    python -m tests.golden_outputs compare BEFORE AFTER

A change of structure must not change a number. `write` runs every command whose tables or JSON are
documented; `compare` compares each file of both folders letter for letter, apart from times and
provenance, and from values that `renamed.json` says were renamed on purpose.
"""

import csv
import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

HERE = Path(__file__).parent
SCENES = ("gentle-rock", "paper-release", "wobble", "petals", "steady-rolling", "slipping-rock")

TIMED = re.compile(
    r"(^|_)(wall|cpu|setup|cost|price|overhead|step_us|seconds)(_|$)|cpu_|relative_(cost|to)|tied"
)
"""Columns and keys that hold times of this machine, or follow from them."""

TIMED_TABLES = ("prices", "hardness", "overhead", "exponents", "points", "growth", "tuned", "front")
"""Tables of the study of cost in which settings are chosen by their times."""


def commands(tree: Path) -> Iterator[tuple[str, list[str]]]:
    """Yield the file and the words of each command."""
    listed = run(["scenes", "--json"], HERE).stdout
    for scene in json.loads(listed)["scenes"]:
        yield f"reference-{scene['name']}.json", ["reference", scene["name"], "--json"]
    for scene in SCENES:
        for engine in ("mujoco", "pybullet"):
            for profile in ("default", "matched", "adaptive"):
                words = ["run", scene, "--engine", engine, "--profile", profile, "--json"]
                yield f"run-{scene}-{engine}-{profile}.json", words
    gentle = "gentle-rock"
    baseline = str(tree / "reports" / "baseline")
    yield "validate.txt", ["validate", "--baseline", baseline, "--jobs", "1", "--out", "validate"]
    yield "effects.json", ["effects", gentle, "--jobs", "1", "--out", "effects", "--json"]
    options = ["--jobs", "1", "--json"]
    for study, engine in (("attribute", "mujoco"), ("errors", "pybullet")):
        yield f"{study}.json", [study, gentle, "--engine", engine, "--out", study, *options]
    yield "stability.txt", ["stability", "--jobs", "1", "--out", "stability"]
    axes = ["--over", "release.psi_dot=-1:1:21", "--over", "release.theta_dot=-1:1:21"]
    yield "sweep.txt", ["sweep", "paper-release", *axes, "--jobs", "1", "--out", "sweep"]
    for engine in ("mujoco", "pybullet"):
        yield f"check-{engine}.json", ["check", engine, "--json"]
    yield "engines.json", ["engines", "--json"]


def run(words: list[str], folder: Path) -> subprocess.CompletedProcess[str]:
    """Run a command of the program that is imported here."""
    tree = str(HERE.parents[1])
    environment = {**os.environ, "PYTHONPATH": tree, "ROCKINGCAN_STORE": str(folder / "store")}
    return subprocess.run(  # noqa: S603 - the program itself
        [sys.executable, "-m", "harness", *words],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )


def write(folder: Path) -> None:
    """Write what every command prints, and the reports that they write, into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, words in commands(HERE.parents[1]):
        done = run(words, folder)
        (folder / name).write_text(done.stdout, encoding="utf-8")
        sys.stdout.write(f"{name}: code {done.returncode}\n")


def without_times(value: Any) -> Any:
    """Return a JSON value without what was measured by a clock."""
    if isinstance(value, dict):
        return {k: without_times(v) for k, v in value.items() if not TIMED.search(k)}
    return [without_times(inner) for inner in value] if isinstance(value, list) else value


def content(path: Path, renamed: dict[str, str]) -> str:
    """Return what is compared of a file."""
    text = path.read_text(encoding="utf-8")
    for before, after in renamed.items():
        text = text.replace(before, after)
    if path.suffix == ".json":
        return json.dumps(without_times(json.loads(text)), indent=1, sort_keys=True)
    if path.suffix == ".csv":
        head, *rows = list(csv.reader(text.splitlines()))
        kept = [place for place, name in enumerate(head) if not TIMED.search(name)]
        timed = head.index("quantity") if "quantity" in head else None
        judged = [row for row in rows if timed is None or not TIMED.search(row[timed])]
        return "\n".join(",".join(row[place] for place in kept) for row in [head, *judged])
    return text


def compare(before: Path, after: Path) -> int:
    """Say which files differ; return how many."""
    renamed = json.loads((HERE / "renamed.json").read_text(encoding="utf-8"))["values"]
    files = [
        *before.glob("*.json"),
        *before.glob("*/tables/*.csv"),
        *before.glob("*/junit.xml"),
    ]
    differing = 0
    for path in sorted(files):
        if path.stem.endswith(TIMED_TABLES):
            continue
        other = after / path.relative_to(before)
        same = other.exists() and content(path, renamed) == content(other, {})
        differing += not same
        if not same:
            sys.stdout.write(f"differs: {path.relative_to(before)}\n")
    sys.stdout.write(f"{len(files)} files compared, {differing} differ\n")
    return differing


if __name__ == "__main__":
    match sys.argv[1:]:
        case ["write", folder]:
            write(Path(folder).absolute())
        case ["compare", before, after]:
            sys.exit(bool(compare(Path(before), Path(after))))
        case _:
            sys.exit(__doc__)
