"""Scene files gone wrong: valid ones changed byte by byte, token by token, value by value."""

import random
import re
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import lru_cache

from models import load, names, write_scene
from models.catalogue import hard_names
from models.effects import KINDS, Effects

NAMES = (
    "../../x",
    "/etc/passwd",
    "<script>alert(1)</script>",
    '"/><geom type="plane"',
    "]]>",
    "&amp;&lt;&#0;",
    "a\\u0000b",
    "a\\nb",
    "\\u001b[31mred",
    "\\u202egnp.exe",
    "=cmd|' /C calc'!A0",
    "[bold]loud[/]",
    "{{ 7 * 7 }}",
    "${HOME}",
    "con",
    ".",
    "..",
    "-rf",
    "x" * 300,
    "\\U0001f964",
    "",
)
"""Names that would do harm where they are taken at their word; as TOML writes them."""

NUMBERS = (
    *("0", "-0.0", "1", "-1", "nan", "inf", "-inf", "1e-320", "5e-324", "1e-300", "1e-150"),
    *("1e-20", "1e-9", "1e-5", "0.1", "0.5", "1.57079632679", "1.5707963267948966", "3.2"),
    *("10", "1e3", "1e5", "1e9", "1e20", "1e150", "1e300", "1.7976931348623157e308", "1e999"),
    *("9" * 30, "9" * 400, "0x10", "1_000", "+1", "true"),
)
"""Numbers at the edges of what a scene, a double and TOML hold."""

_TOKENS = (
    *NUMBERS,
    *("=", "==", "[", "]", "[[can]]", "[can]", "[effects.slip]", "[a.b.c]", ".", ",", "{", "}"),
    *('"', '""', '"""', "'''", "#", "\n", "1979-05-27", "07:32:00", "[1, 2]", "{ a = 1 }"),
    *("mass", "phi", "bounces", "seconds", "mu", "name", "\ufeff", "\u00a0", "\x00", "\x7f"),
)
_TOKEN = re.compile(r'"[^"]*"|[\w.+-]+|\s+|.')
_BYTES = (b"\x00", b"\xff", b"\xc3", b"\r", b"\n", b'"', b"'", b"[", b"=", b"\xe2\x80\xae", b"\\")
_MOST_CHANGES = 6


@lru_cache(maxsize=1)
def valid() -> tuple[str, ...]:
    """Return the text of valid scenes: the catalogue, the hard cases, and some with effects."""
    # a thousand bounces take half a minute each time, gone wrong or not
    scenes = [load(name) for name in (*names(), *hard_names()) if name != "thousand-bounces"]
    slip = Effects(slip=KINDS["slip"](mu=0.4))
    ideal = [scene for scene in scenes if not scene.effects.declared()]
    return (
        *(write_scene(scene) for scene in scenes),
        *(write_scene(replace(scene, effects=slip)) for scene in ideal[:2]),
    )


def by_byte(chance: random.Random) -> bytes:
    """Return a scene file with some bytes changed, lost, doubled or put in."""
    text = bytearray(chance.choice(valid()).encode())
    for _ in range(chance.randint(1, _MOST_CHANGES)):
        at = chance.randrange(len(text) + 1)
        kind = chance.randrange(6)
        if kind == 0 and at < len(text):
            text[at] ^= 1 << chance.randrange(8)
        elif kind == 1:
            text[at:at] = chance.choice(_BYTES)
        elif kind == 2:
            del text[at : at + chance.randint(1, 20)]
        elif kind == 3:
            text[at:at] = text[at : at + chance.randint(1, 40)] * chance.randint(1, 3)
        elif kind == 4:
            text[at:at] = bytes(chance.randrange(256) for _ in range(chance.randint(1, 8)))
        elif chance.random() < 0.2:
            del text[at:]
    return bytes(text)


def by_token(chance: random.Random) -> bytes:
    """Return a scene file with some words changed, lost, doubled, swapped or put in."""
    tokens = _TOKEN.findall(chance.choice(valid()))
    for _ in range(chance.randint(1, _MOST_CHANGES)):
        at, other = chance.randrange(len(tokens)), chance.randrange(len(tokens))
        kind = chance.randrange(5)
        if kind == 0:
            tokens[at] = chance.choice(_TOKENS)
        elif kind == 1:
            tokens.insert(at, chance.choice(_TOKENS))
        elif kind == 2:
            tokens[at], tokens[other] = tokens[other], tokens[at]
        elif kind == 3:
            tokens.insert(at, tokens[other])
        elif len(tokens) > 1:
            del tokens[at]
    return "".join(tokens).encode("utf-8", errors="replace")


def by_value(chance: random.Random) -> bytes:
    """Return a scene file of the right form with other values: numbers at the edges, and names."""
    lines = chance.choice(valid()).splitlines()
    places = [number for number, line in enumerate(lines) if " = " in line]
    for place in chance.sample(places, chance.randint(1, 4)):
        key = lines[place].partition(" = ")[0]
        if key in {"name", "cite"}:
            value = f'"{chance.choice(NAMES)}"'
        elif key == "bounces":
            value = chance.choice(("0", "1", "2", "3", "-1", "1.0", "true", "100001", "9" * 30))
        elif chance.random() < 0.5:
            value = chance.choice(NUMBERS)
        else:
            value = repr(chance.choice((-1.0, 1.0)) * 10.0 ** chance.uniform(-12.0, 12.0))
        lines[place] = f"{key} = {value}"
    return "\n".join(lines).encode()


LEVELS: dict[str, Callable[[random.Random], bytes]] = {
    "byte": by_byte,
    "token": by_token,
    "value": by_value,
}


def mutations(level: str, count: int, seed: int) -> Iterator[bytes]:
    """Yield so many scene files gone wrong at a level, the same for the same seed."""
    chance = random.Random(f"{level} {seed}")  # noqa: S311 - to be the same again, not to be secret
    for _ in range(count):
        yield LEVELS[level](chance)
