"""What an engine says of itself: name, version, settings, capabilities."""

import re
from dataclasses import fields

from harness.case import PROFILES, Case
from harness.engines.base import Capabilities, Setting, resolve
from harness.engines.conformance.bench import Bench
from harness.engines.conformance.verdict import Found, holds
from models.effects import Effects

_NAME = r"[a-z][a-z0-9_.-]{0,31}"


def name(bench: Bench) -> Found:
    """Look at the name: what a command line, a file name and a table key alike can hold."""
    found: object = bench.engine.name
    fits = isinstance(found, str) and re.fullmatch(_NAME, found) is not None
    wrong = "" if fits else f"{found!r} is not lower-case letters, digits, dots and dashes"
    return holds(wrong, str(found))


def version(bench: Bench) -> Found:
    """Look at the version, which goes into the digest of every case."""
    found: object = bench.engine.version
    fits = isinstance(found, str) and found.strip() != ""
    return holds("" if fits else f"{found!r} is no text", str(found))


def settings(bench: Bench) -> Found:
    """Look at the settings: each named once, explained, and taking its own values."""
    declared: object = bench.engine.settings
    if not isinstance(declared, tuple) or not all(isinstance(s, Setting) for s in declared):
        return holds("`settings` is not a tuple of Setting", "")
    names = [setting.name for setting in declared]
    twice = sorted({each for each in names if names.count(each) > 1})
    if twice:
        return holds(f"declared twice: {', '.join(twice)}", "")
    mute = [s.name for s in declared if len(s.meaning.split()) < 2]  # noqa: PLR2004 - a sentence
    if mute:
        return holds(f"without a sentence of meaning: {', '.join(mute)}", "")
    for profile in PROFILES:
        case = Case(scene=bench.brief, engine=bench.engine.name, profile=profile)
        timestep = bench.engine.timestep(case) or 0.0
        chosen = resolve(case, declared, timestep)
        own = {key: value for key, value in chosen.items() if value is not None}
        again = Case(
            scene=case.scene, engine=case.engine, profile=profile, options=tuple(own.items())
        )
        resolve(again, declared, timestep)  # raises where a setting does not take its own value
    return holds("", f"{len(names)} settings")


def capabilities(bench: Bench) -> Found:
    """Look at the capabilities: effects that exist, and a sentence for each imposed one."""
    found: object = bench.engine.capabilities
    if not isinstance(found, Capabilities):
        return holds(f"`capabilities` is {type(found).__name__}, not Capabilities", "")
    unknown = sorted(set(found.honours) - {field.name for field in fields(Effects)})
    if unknown:
        return holds(f"honours what is no effect of a scene: {', '.join(unknown)}", "")
    mute = [key for key, sentence in found.imposes.items() if not sentence.strip()]
    honours = ", ".join(sorted(found.honours)) or "nothing"
    imposes = ", ".join(found.imposes) or "nothing"
    return holds(
        f"imposes without a sentence: {', '.join(mute)}" if mute else "",
        f"honours {honours}, imposes {imposes}",
    )
