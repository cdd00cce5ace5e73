"""Verdicts and findings as a store keeps them."""

from dataclasses import replace

from harness.core.case import Case
from harness.evaluation.case_cache import case_key, case_metadata
from harness.execution.cache import CacheFolder
from harness.execution.cache_entry import Metadata, checksum
from harness.execution.tasks import ResultCache
from harness.studies.stability.failure_criteria import ClassifiedRun
from harness.studies.stability.survey import ReferenceCheck
from models.effects import IDEAL
from models.scene import Scene

Part = tuple[Scene, ...]
"""Scenes that are examined in one task."""


def classified_cache(store: CacheFolder) -> ResultCache[Case, ClassifiedRun]:
    """Return where the verdicts on runs are kept."""
    return ResultCache(
        store=store,
        kind="verdicts",
        key=lambda case: case_key(case, __name__),
        metadata=lambda case: case_metadata(case, __name__),
    )


def reference_check_cache(store: CacheFolder) -> ResultCache[Part, list[ReferenceCheck]]:
    """Return where it is kept how the reference fares."""
    return ResultCache(store=store, kind="findings", key=_key_of_part, metadata=_about_part)


def _key_of_part(part: Part) -> str:
    """Return what names what is found of scenes: the scenes, effects and all, and the program."""
    told = [case_key(_case(part[0]), __name__), *(str(scene.to_dict()) for scene in part)]
    return checksum("\n".join(told).encode())[:32]


def _about_part(part: Part) -> Metadata:
    label = f"the reference on {len(part)} scenes from {part[0].name}"
    return replace(
        case_metadata(_case(part[0]), __name__), label=label, command="rockingcan stability"
    )


def _case(scene: Scene) -> Case:
    """Return a case of the reference, which carries no effects."""
    return Case(scene=replace(scene, effects=IDEAL), engine="reference")
