"""What an engine must refuse, and what it must honour because it says so."""

import math
from dataclasses import fields, replace
from typing import Any

import numpy as np

from harness.engines.conformance.bench import Bench
from harness.engines.conformance.effects import DECLARED, SLIPPERY
from harness.engines.conformance.verdict import Found, holds, not_applicable, within
from harness.engines.registry import check_effects, names
from harness.errors import InvalidSettingError, UnknownSettingError, UnsupportedEffectError
from models.effects import Effects

_ODD = (math.nan,) * 17
"""A value that no setting takes: seventeen numbers that are none."""


def unknown_setting(bench: Bench) -> Found:
    """Ask for a setting that no engine has."""
    case = bench.case(bench.brief, no_such_setting=1.0)
    try:
        bench.engine.simulate(case)
    except UnknownSettingError as error:
        named = "no_such_setting" in str(error)
        return holds("" if named else f"the message does not name it: {error}", str(error))
    return holds("a setting that does not exist was taken", "")


def wrong_value(bench: Bench) -> Found:
    """Give every setting a value of another kind."""
    if not bench.engine.settings:
        return not_applicable("the engine has no settings")
    taken = []
    for setting in bench.engine.settings:
        odd: dict[str, Any] = {setting.name: _ODD}
        case = bench.case(bench.brief, **odd)
        try:
            bench.engine.simulate(case)
        except InvalidSettingError:
            continue
        taken.append(setting.name)
    wrong = f"took a value of another kind: {', '.join(taken)}" if taken else ""
    return holds(wrong, f"{len(bench.engine.settings)} settings")


def unsupported_effect(bench: Bench) -> Found:
    """Declare every effect that the engine neither honours nor imposes."""
    own = bench.engine.capabilities
    missing = [
        field.name
        for field in fields(Effects)
        if field.name not in own.honours and field.name not in own.imposes
    ]
    if not missing:
        return not_applicable("the engine honours or imposes every effect")
    if bench.engine.name not in names():
        return not_applicable("the engine is not registered, so that no case reaches it")
    taken = []
    for effect in missing:
        try:
            check_effects(bench.engine.name, replace(bench.brief, effects=DECLARED[effect]))
        except UnsupportedEffectError:
            continue
        taken.append(effect)
    wrong = f"not refused: {', '.join(taken)}" if taken else ""
    return holds(wrong, f"refused: {', '.join(missing)}")


def friction(bench: Bench) -> Found:
    """Put the can on a slippery plane, if the engine says that it honours slip."""
    if "slip" not in bench.engine.capabilities.honours:
        return not_applicable("the engine does not honour slip")
    scene = replace(bench.brief, effects=DECLARED["slip"])
    force = bench.trajectory(bench.case(scene)).contact_force
    bears = force[:, 2] > 0.0
    if not bears.any():
        return holds("no sample bears a load", "")
    ratio = np.hypot(force[bears, 0], force[bears, 1]) / force[bears, 2]
    # the release needs three times this friction, so that the rim slips and takes all there is; an
    # engine that slips late or solves loosely may fall short, none may exceed it by a thousandth
    if not ratio.max() > SLIPPERY / 2.0:
        return holds(f"friction ratio of {ratio.max():.2g} where {SLIPPERY} is called for", "")
    over = float(ratio.max()) / SLIPPERY - 1.0
    return within(over, 1e-3, "relative", f"friction ratio beyond the declared {SLIPPERY}")
