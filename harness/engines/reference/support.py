"""Whether a scene has an exact motion that every run of it can be held against."""

from harness.core.errors import InvalidSettingError, UnsupportedEffectError
from harness.engines.reference.assumption_checks import divergence_of
from harness.engines.reference.to_reference_problem import refusal
from harness.engines.registry import check_effects
from models.scene import Scene


def check_exact(scene: Scene) -> None:
    """Refuse a scene of which no run has an error: the reference does not carry it, or it is chaos.

    Raises
    ------
    InvalidSettingError
        Says which scenes have an exact motion.
    """
    if not _carried(scene):
        allowed = (
            "a scene under gravity with no effects but those that the reference carries: another "
            "has no exact motion"
        )
        raise InvalidSettingError("SCENE", scene.name, allowed)
    chaos = divergence_of(scene)
    if chaos is not None and chaos.chaotic:
        allowed = (
            "a scene that is not chaotic: of another what differs in the end is no error, and "
            "`run` says when it parts"
        )
        raise InvalidSettingError("SCENE", scene.name, allowed)


def _carried(scene: Scene) -> bool:
    """Whether the reference carries a scene with all its effects."""
    if refusal(scene):
        return False
    try:
        check_effects("reference", scene)
    except UnsupportedEffectError:
        return False
    return True
