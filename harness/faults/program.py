"""The program on trial: a short suite of cases, run as any command runs them.

Started with one argument, an `Order` as JSON; prints the outcomes as JSON.
"""

import json
import sys
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from harness.case import Case
from harness.engines.registry import GROUP
from harness.errors import HarnessError
from harness.executors import local
from harness.faults.engines import FAULTY
from harness.faults.processes import Program, begin
from harness.interruption import Interrupted, listen
from harness.isolation import Limits
from harness.runner import run
from harness.store import Store
from models.catalogue import load

_WRONG = 2

_PROGRAM = f"from {__name__} import main; main()"


@dataclass(frozen=True, slots=True, kw_only=True)
class Order:
    """What the program is to do.

    Parameters
    ----------
    store : str
        Folder.
    cases : sequence of (scene, engine, profile, timestep)
    jobs : int
    seconds, memory : float
        Limits of a case.
    """

    store: str
    cases: Sequence[tuple[str, str, str, float | None]]
    jobs: int = 2
    seconds: float = 60.0
    memory: float = 4.0 * 2**30


def started(order: Order, entries: Path | None = None) -> Program:
    """Start the program as the leader of a process group of its own.

    Parameters
    ----------
    order : Order
    entries : Path, optional
        Folder in which engines are registered that the program is to find.
    """
    paths = [] if entries is None else [str(entries)]
    return begin(_PROGRAM, [json.dumps(asdict(order))], Path.cwd(), paths)


def register(folder: Path) -> Path:
    """Register the faulty engines in a folder, as an installed package would; return the folder."""
    metadata = folder / "faulty_engines-1.dist-info"
    metadata.mkdir(parents=True, exist_ok=True)
    lines = [f"[{GROUP}]", *(f"{n} = {k.__module__}:{k.__name__}" for n, k in FAULTY.items()), ""]
    (metadata / "entry_points.txt").write_text("\n".join(lines), encoding="utf-8")
    told = "Metadata-Version: 2.1\nName: faulty-engines\nVersion: 1\n"
    (metadata / "METADATA").write_text(told, encoding="utf-8")
    return folder


def cases_of(order: Order) -> list[Case]:
    """Return the cases of an order."""
    return [
        Case(scene=load(scene), engine=engine, profile=profile, timestep=timestep)
        for scene, engine, profile, timestep in order.cases
    ]


def main() -> None:
    """Run the cases of the order that is given, print what came of each, leave with a code."""
    order = Order(**json.loads(sys.argv[1]))
    listen()
    limits = Limits(seconds=order.seconds, memory=order.memory)
    try:
        with local(order.jobs, spawned=True, limits=limits) as executor:
            done = run(cases_of(order), executor, store=Store(folder=Path(order.store)))
    except (Interrupted, HarnessError) as error:
        told = [str(error), *getattr(error, "__notes__", ())]
        sys.stderr.write(". ".join(told) + "\n")
        sys.exit(error.exit_code if isinstance(error, Interrupted) else _WRONG)
    outcomes = [
        [e.simulation.case.engine, e.simulation.outcome.name, e.simulation.note] for e in done
    ]
    sys.stdout.write(json.dumps(outcomes) + "\n")
