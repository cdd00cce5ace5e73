"""Verdicts and findings as a store keeps them."""

from dataclasses import asdict, replace
from typing import Any

from harness.core.case import Case
from harness.core.errors import StoreError
from harness.evaluation.case_cache import (
    case_key,
    case_metadata,
    decode_simulation,
    encode_simulation,
)
from harness.execution.cache import CacheFolder
from harness.execution.cache_entry import EntryContent, Metadata, checksum
from harness.execution.tasks import ResultCache
from harness.studies.stability.failure_criteria import ClassifiedRun, Sign, StabilityStatus
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
        about=lambda case: case_metadata(case, __name__),
        pack=_content_of,
        unpack=_judged_of,
    )


def reference_check_cache(store: CacheFolder) -> ResultCache[Part, list[ReferenceCheck]]:
    """Return where it is kept how the reference fares."""
    return ResultCache(
        store=store,
        kind="findings",
        key=_key_of_part,
        about=_about_part,
        pack=lambda found: EntryContent(record={"findings": [asdict(each) for each in found]}),
        unpack=_findings_of,
    )


def _content_of(judged: ClassifiedRun) -> EntryContent:
    return EntryContent(
        record={
            "simulation": encode_simulation(judged.simulation),
            "verdict": judged.verdict.name,
            "sign": asdict(judged.sign),
        }
    )


def _judged_of(case: Case, content: EntryContent) -> ClassifiedRun:
    told = content.record
    try:
        return ClassifiedRun(
            simulation=decode_simulation(case, told["simulation"], None),
            verdict=StabilityStatus[told["verdict"]],
            sign=Sign(**told["sign"]),
        )
    except (KeyError, TypeError) as error:
        raise StoreError("it is no verdict") from error


def _findings_of(part: Part, content: EntryContent) -> list[ReferenceCheck]:
    try:
        found: list[dict[str, Any]] = content.record["findings"]
        if [each["scene"] for each in found] != [scene.name for scene in part]:
            raise StoreError("its scenes are others")
        return [ReferenceCheck(**each) for each in found]
    except (KeyError, TypeError) as error:
        raise StoreError("it is no finding") from error


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
