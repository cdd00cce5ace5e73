"""Verdicts and findings as a store keeps them."""

from dataclasses import asdict, replace
from typing import Any

from harness.campaign import Shelf
from harness.case import Case
from harness.errors import StoreError
from harness.keys import about, key_of
from harness.store import About, Content, Store
from harness.store.entry import checksum
from harness.store.simulations import record_of, simulation_of
from harness.studies.stability.survey import Finding
from harness.studies.stability.verdict import Judged, Sign, Verdict
from models.effects import IDEAL
from models.scene import Scene

Part = tuple[Scene, ...]
"""Scenes that are examined in one task."""


def verdicts(store: Store) -> Shelf[Case, Judged]:
    """Return where the verdicts on runs are kept."""
    return Shelf(
        store=store,
        kind="verdicts",
        key=lambda case: key_of(case, __name__),
        about=lambda case: about(case, __name__),
        pack=_content_of,
        unpack=_judged_of,
    )


def findings(store: Store) -> Shelf[Part, list[Finding]]:
    """Return where it is kept how the reference fares."""
    return Shelf(
        store=store,
        kind="findings",
        key=_key_of_part,
        about=_about_part,
        pack=lambda found: Content(record={"findings": [asdict(each) for each in found]}),
        unpack=_findings_of,
    )


def _content_of(judged: Judged) -> Content:
    return Content(
        record={
            "simulation": record_of(judged.simulation),
            "verdict": judged.verdict.name,
            "sign": asdict(judged.sign),
        }
    )


def _judged_of(case: Case, content: Content) -> Judged:
    told = content.record
    try:
        return Judged(
            simulation=simulation_of(case, told["simulation"], None),
            verdict=Verdict[told["verdict"]],
            sign=Sign(**told["sign"]),
        )
    except (KeyError, TypeError) as error:
        raise StoreError("it is no verdict") from error


def _findings_of(part: Part, content: Content) -> list[Finding]:
    try:
        found: list[dict[str, Any]] = content.record["findings"]
        if [each["scene"] for each in found] != [scene.name for scene in part]:
            raise StoreError("its scenes are others")
        return [Finding(**each) for each in found]
    except (KeyError, TypeError) as error:
        raise StoreError("it is no finding") from error


def _key_of_part(part: Part) -> str:
    """Return what names what is found of scenes: the scenes, effects and all, and the program."""
    told = [key_of(_case(part[0]), __name__), *(str(scene.to_dict()) for scene in part)]
    return checksum("\n".join(told).encode())[:32]


def _about_part(part: Part) -> About:
    label = f"the reference on {len(part)} scenes from {part[0].name}"
    return replace(about(_case(part[0]), __name__), label=label, command="rockingcan stability")


def _case(scene: Scene) -> Case:
    """Return a case of the reference, which carries no effects."""
    return Case(scene=replace(scene, effects=IDEAL), engine="reference")
