"""What each collider of an engine finds under the rim of a can, before anything is solved.

The survey is `harness.engines.probes.rim_survey`; here it is run for every collider that an engine
offers, and told: findings in a table and a sentence, places as a map of tilts by colliders.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from harness.core.case import Case
from harness.core.errors import HarnessError, InvalidSettingError
from harness.core.report_model import (
    Artefact,
    Column,
    Figure,
    Heatmap,
    Panel,
    Prose,
    Table,
    table_of,
)
from harness.core.verdict import Status, Verdict
from harness.engines.base import Variant, features_of
from harness.engines.can_mesh import MESH_SETTING, Mesh
from harness.engines.probes.rim_contact import Answer, NoAnswerError
from harness.engines.probes.rim_survey import (
    RimSurvey,
    refuse_without_contacts,
    survey_rim,
    why_no_contacts,
)
from harness.engines.registry import description_of, engine, engine_version
from harness.evaluation.effort import engine_group
from harness.evaluation.evaluate import check_case
from harness.evaluation.evaluation import Record
from harness.execution.cache import CacheFolder
from harness.execution.worker import LostTaskError
from harness.studies.comparison.study import EngineSettings
from harness.studies.study import Job, Results, Work, record_cache
from models.catalogue import load

SCENE = "gentle-rock"
"""Scene whose can it is."""

_SECONDS = 2.0
"""s of processor for a collider, on average."""

_NEAR = 1e-3
"""Of the radius: a contact that is as near to the lowest point is at the rim."""

_AT_THE_RIM = "at the rim"


def probed(case: Case) -> Record:
    """Return rows and findings of the collider of a case, as numbers and words alone."""
    try:
        survey = survey_rim(case)
    except NoAnswerError as error:
        return _failed(str(error))
    findings = [
        {
            "kind": each.kind,
            "sentence": each.sentence,
            "below_tilt_rad": _number(each.below_tilt_rad),
            "place_error_m": _number(each.place_error_m),
        }
        for each in survey.findings
    ]
    return {"rows": _rows(survey, case.scene.can.radius), "findings": findings}


def _rows(survey: RimSurvey, radius: float) -> list[Record]:
    """Return a row for each tilt: the worst of all stances."""
    rows = []
    for tilt, found in zip(survey.tilts, survey.found, strict=True):
        own = [answer for answer in found if answer.stance.depth > 0.0]
        worst = {
            name: _number(max((v for v in values if not math.isnan(v)), default=math.nan))
            for name, values in (
                ("place_error_m", [answer.place_error for answer in own]),
                ("depth_error_m", [answer.depth_error for answer in own]),
                ("normal_error_rad", [answer.normal_error for answer in own]),
            )
        }
        counts = max(answer.count for answer in own)
        rows.append(
            {"tilt_rad": tilt, "count": counts} | worst | {"verdict": _verdict(own, radius)}
        )
    return rows


def _verdict(own: Sequence[Answer], radius: float) -> str:
    """Return in words where the contact of a tilt is."""
    if any(answer.count == 0 for answer in own):
        return "no contact" if all(answer.count == 0 for answer in own) else "lost at some turns"
    if any(answer.place_error > _NEAR * radius for answer in own):
        return "off the rim"
    return _AT_THE_RIM


def _number(value: float) -> float | None:
    return None if math.isnan(value) else value


def _lost(case: Case, error: LostTaskError) -> Record:
    """Return the record of a collider that took its process with it: that is its finding."""
    del case
    return _failed(error.reason)


def _failed(reason: str) -> Record:
    """Return the record of a collider that does not answer."""
    sentence = f"the engine does not survive the question: {reason}"
    return {"rows": [], "findings": [_finding(sentence)]}


def _finding(sentence: str) -> Record:
    return {"kind": "contact", "sentence": sentence, "below_tilt_rad": None, "place_error_m": None}


def _check(case: Case) -> None:
    """Refuse wrong use before anything runs."""
    refuse_without_contacts(case.engine)
    check_case(case)


PROBING: Work[Case, Record] = Work(
    name="probing the rim",
    call=probed,
    lost=_lost,
    label=Case.label,
    cache=record_cache("rims", probed.__module__),
    check=_check,
    effort=lambda _: _SECONDS,
    group=engine_group,
)
"""Ask a collider for its contacts in every stance."""

_COLUMNS = (
    Column("engine", "Name of the engine."),
    Column("variant", "Collider that was asked."),
    Column("finding", "What it does that an exact collider does not."),
    Column("kind", "What of the contact it concerns.", shown=False),
    Column("below_tilt_rad", "Upper end of the tilts at which it does it most often, rad."),
    Column(
        "place_error_m",
        "Largest distance of the contact from the lowest point of the rim, m.",
    ),
    Column(
        "seen_from_rad",
        "Tilt from which on the contact is at the rim at every turn, rad; empty if it never is.",
    ),
    Column("verdict", "Whether there is a finding."),
)

_NOTHING = "none: at the rim in every stance"


@dataclass(eq=False)
class NoMeshError(HarnessError, ValueError):
    """The can of an engine cannot be a mesh."""

    engine: str

    def __str__(self) -> str:
        """Say which engines can."""
        return (
            f"engine '{self.engine}' takes no mesh: engines with a setting '{MESH_SETTING.name}' "
            "do (see: rockingcan engines NAME)"
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class RimStudy:
    """Every collider of each engine, asked for the contact under the rim.

    Parameters
    ----------
    engines : tuple of str
        Those without contacts are left out.
    settings : mapping
        By engine, settings on top of every collider, or, where they are those of a collider, of one
        that they make.
    meshes : mapping of str to Mesh
        Meshes that stand for the can, by name; without any the engine's own colliders are asked.
    """

    engines: tuple[str, ...]
    settings: EngineSettings = field(default_factory=dict)
    meshes: Mapping[str, Mesh] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """Title of the study."""
        return "Under the rim"

    def next_jobs(self, _: Results) -> list[Job[Case, Record]]:
        """Return a job for each collider: one round."""
        return [Job(PROBING, case) for own in self._cases().values() for case in own.values()]

    def report(self, done: Results) -> tuple[Artefact, ...]:
        """Return a sentence, the map, and the table of findings."""
        found = self.found(done)
        return _told(found), _map(found), self._table(found)

    def kept(self, cache: CacheFolder) -> "RimStudy":
        """Return the study of those engines of which every answer is in a store."""
        return replace(
            self,
            engines=tuple(
                name
                for name, own in self._cases().items()
                if all(Job(PROBING, case).stored(cache) for case in own.values())
            ),
        )

    def found(self, done: Results) -> dict[str, dict[str, Record]]:
        """Return the records by engine and name of the collider."""
        of_case = done.of(PROBING)
        return {
            name: {variant: of_case[case] for variant, case in own.items()}
            for name, own in self._cases().items()
        }

    def answer(self, done: Results) -> Mapping[str, Any]:
        """Return what `probe --json` prints of the first engine."""
        (name, own), *_ = self.found(done).items()
        return {
            "engine": name,
            "version": engine_version(name),
            **{
                part: [
                    {"variant": variant} | row
                    for variant, record in own.items()
                    for row in record[part]
                ]
                for part in ("rows", "findings")
            },
        }

    def _table(self, found: Mapping[str, Mapping[str, Record]]) -> Table:
        """Return a row for each finding, and one for each collider without any."""
        rows = []
        for name, own in found.items():
            for variant, record in own.items():
                for each in record["findings"] or [_finding(_NOTHING)]:
                    exact = not record["findings"]
                    text = "agrees" if exact else "deviates"
                    rows.append(
                        {
                            "engine": name,
                            "variant": variant,
                            "kind": each["kind"],
                            "finding": each["sentence"],
                            "verdict": Verdict(Status.AGREES if exact else Status.DEVIATES, text),
                            "below_tilt_rad": each["below_tilt_rad"],
                            "place_error_m": each["place_error_m"],
                            "seen_from_rad": _seen_from(record["rows"]),
                        }
                    )
        return table_of("rim-findings", "What the colliders find under the rim", _COLUMNS, rows)

    def _colliders(self, name: str) -> tuple[Variant, ...]:
        """Return the colliders of an engine with its settings, or the one that these make."""
        chosen = dict(self.settings.get(name, {}))
        words = ", ".join(f"{key}={value}" for key, value in chosen.items())
        features = features_of(engine(name))
        offered = features.mesh_colliders if self.meshes else features.colliders
        if self.meshes and not offered:
            raise NoMeshError(name)
        taken = {MESH_SETTING.name, *(key for each in offered for key, _ in each.settings)}
        if self.meshes and (twice := sorted(taken.intersection(chosen))):
            allowed = (
                f"left out beside --mesh, which asks: {', '.join(each.name for each in offered)}"
            )
            raise InvalidSettingError(f"--set {twice[0]}", chosen[twice[0]], allowed)
        if not offered or any(key in chosen for each in offered for key, _ in each.settings):
            offered = (Variant(name=words or "matched"),)
        asked = tuple(replace(each, settings=(*each.settings, *chosen.items())) for each in offered)
        if not self.meshes:
            return asked
        return tuple(
            replace(
                each,
                name=f"{mesh}, {each.name}",
                settings=(*each.settings, (MESH_SETTING.name, points)),
            )
            for mesh, points in self.meshes.items()
            for each in asked
        )

    def _cases(self) -> dict[str, dict[str, Case]]:
        """Return the cases by engine and name of the collider."""
        scene = load(SCENE)
        return {
            name: {
                each.name: Case(scene=scene, engine=name, options=each.settings)
                for each in self._colliders(name)
            }
            for name in self.engines
            if len(self.engines) == 1 or not why_no_contacts(engine(name))
        }


def _told(found: Mapping[str, Mapping[str, Record]]) -> Prose:
    """Return the first finding of each engine as it is first asked, and where the rim is seen."""
    said = []
    for name, own in found.items():
        variant, record = next(iter(own.items()))
        first = record["findings"][0]["sentence"] if record["findings"] else _NOTHING
        seen = "; ".join(f"{each} {_from(one['rows'])}" for each, one in own.items() if one["rows"])
        label = description_of(name).label or name
        said.append(f"{label} ({variant}): {first}. The rim is seen: {seen or 'nowhere'}.")
    return Prose(name="rim-told", title="Under the rim", text="\n\n".join(said))


_EXACT = 1e-12
"""Of the radius: nearer than this is all one on the map."""


def _map(found: Mapping[str, Mapping[str, Record]]) -> Figure:
    """Return the maps of tilts by colliders, one for each engine."""
    asked = {
        name: {variant: record for variant, record in own.items() if record["rows"]}
        for name, own in found.items()
    }
    return Figure(
        name="rim",
        title="How far the contact is from the lowest point of the rim",
        seen="White cells have no contact. A collider that is exact is dark all along.",
        panels=tuple(_panel(name, own) for name, own in asked.items() if own),
        columns=1,
    )


def _seen_from(rows: Sequence[Record]) -> float | None:
    """Return the smallest tilt from which on the contact is at the rim, rad; None without one."""
    lost = [place for place, row in enumerate(rows) if row["verdict"] != _AT_THE_RIM]
    first = lost[-1] + 1 if lost else 0
    tilt: float | None = rows[first]["tilt_rad"] if first < len(rows) else None
    return tilt


def _from(rows: Sequence[Record]) -> str:
    """Return that tilt in words."""
    tilt = _seen_from(rows)
    if tilt is None:
        return "at no tilt, or not up to the largest"
    return "at every tilt" if tilt == rows[0]["tilt_rad"] else f"from {tilt:.2g} rad on"


def _panel(name: str, own: Mapping[str, Record]) -> Panel:
    """Return the map of one engine: tilts across, colliders down."""
    names, radius = tuple(reversed(list(own))), load(SCENE).can.radius
    tilts = np.array([row["tilt_rad"] for row in next(iter(own.values()))["rows"]])
    between = np.sqrt(tilts[1:] * tilts[:-1])
    off = np.array(
        [
            [
                math.nan if row["place_error_m"] is None else row["place_error_m"]
                for row in own[n]["rows"]
            ]
            for n in names
        ]
    )
    return Panel(
        title=description_of(name).label or name,
        x_label="tilt (rad)",
        y_label="",
        series=(),
        log_x=True,
        y_names=names,
        heat=Heatmap(
            label="log10 of the distance (R)",
            x=np.concatenate(([tilts[0] ** 2 / between[0]], between, [tilts[-1]])),
            y=np.arange(len(names) + 1, dtype=np.float64) - 0.5,
            z=np.log10((off / radius).clip(_EXACT)),
        ),
    )
