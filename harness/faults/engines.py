"""Engines that fail in the ways in which engines do. Each is registered for a trial alone."""

import ctypes
import itertools
from dataclasses import replace

import numpy as np

from harness.case import Case
from harness.engines.base import Capabilities, Setting
from harness.engines.registry import engine
from harness.simulation import Simulation

_BLOCK = 2**24
"""Bytes of a bite, each of which is written to: memory that is only reserved is not used."""


def _never(case: Case) -> Simulation | None:
    """Return nothing, whatever the case."""
    del case
    return None


class _Reference:
    """The reference under another name: what a faulty engine is before it fails."""

    name = "sound"
    version = "1"
    settings: tuple[Setting, ...] = ()
    capabilities = Capabilities(honours=frozenset(), imposes={})

    def timestep(self, case: Case) -> float | None:
        """Return the timestep of a case, as it is; the reference has none."""
        return case.timestep

    def simulate(self, case: Case) -> Simulation:
        """Run a case."""
        whole = engine("reference").simulate(replace(case, engine="reference", timestep=None))
        return replace(whole, case=case, model=self.name)


class Crashing(_Reference):
    """Reads from where nothing is."""

    name = "crashing"

    def simulate(self, case: Case) -> Simulation:
        """Die of a segmentation fault."""
        ctypes.string_at(0)
        return super().simulate(case)


class Hanging(_Reference):
    """Never returns, and never lets go of the interpreter for long."""

    name = "hanging"

    def simulate(self, case: Case) -> Simulation:
        """Count for ever."""
        return next(whole for _ in itertools.count() if (whole := _never(case)) is not None)


class Hungry(_Reference):
    """Allocates without end."""

    name = "hungry"

    def simulate(self, case: Case) -> Simulation:
        """Take one block after the other."""
        blocks = [b"\1" * _BLOCK for _ in itertools.count()]
        raise MemoryError(f"{len(blocks)} blocks for {case.label()}")


class Garbling(_Reference):
    """Returns what are no numbers."""

    name = "garbling"

    def simulate(self, case: Case) -> Simulation:
        """Spoil the motion from the second sample on."""
        whole = super().simulate(case)
        if whole.trajectory is None:
            return whole
        position = np.array(whole.trajectory.position)
        position[1:] = np.nan
        return replace(whole, trajectory=replace(whole.trajectory, position=position))


FAULTY: dict[str, type[_Reference]] = {
    kind.name: kind for kind in (Crashing, Hanging, Hungry, Garbling)
}
"""By the names under which they are registered."""
