"""What an engine is not asked: scenes with effects that it neither honours nor imposes."""

from collections.abc import Sequence
from dataclasses import dataclass

from harness.case import Case
from harness.engines.registry import missing_effects


@dataclass(frozen=True, slots=True, kw_only=True)
class Unsupported:
    """A scene that an engine cannot represent.

    Parameters
    ----------
    scene, engine : str
    effects : tuple of str
        Those that it lacks.
    """

    scene: str
    engine: str
    effects: tuple[str, ...]

    @property
    def verdict(self) -> str:
        """The verdict in words."""
        return f"unsupported: cannot represent {', '.join(self.effects)}"


def parted(cases: Sequence[Case]) -> tuple[tuple[Case, ...], tuple[Unsupported, ...]]:
    """Return the cases that can be run, and which engines cannot run which scenes.

    Raises
    ------
    HarnessError
        If a scene declares an effect and its engine is not there to be asked.
    """
    lacking = {
        (case.scene.name, case.engine): effects
        for case in cases
        if (effects := missing_effects(case.engine, case.scene))
    }
    return (
        tuple(case for case in cases if (case.scene.name, case.engine) not in lacking),
        tuple(
            Unsupported(scene=scene, engine=engine, effects=effects)
            for (scene, engine), effects in lacking.items()
        ),
    )
