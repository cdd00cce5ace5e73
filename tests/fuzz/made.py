"""Scene files that hypothesis makes: of the right shape, mostly, with values of any kind."""

from collections.abc import Callable
from dataclasses import fields

from hypothesis import HealthCheck, Phase, Verbosity, given, seed, settings
from hypothesis import strategies as st

from models.effects import KINDS
from tests.fuzz.mutations import NAMES, NUMBERS

_KEYS = {
    "can": ("mass", "radius", "a", "c", "h", "A", "C", "H"),
    "release": ("phi", "psi", "theta", "phi_dot", "psi_dot", "theta_dot", "height"),
    "horizon": ("bounces", "seconds"),
}


def _written(value: float) -> str:
    return repr(value) if value == value else "nan"  # noqa: PLR0124 - what nan is not


_plausible = st.floats(0.05, 1.2).map(_written)
_edges = st.one_of(
    st.floats().map(_written),
    st.integers(-10, 10).map(str),
    st.sampled_from(NUMBERS),
    st.sampled_from([f'"{name}"' for name in NAMES]),
    st.sampled_from(["[]", "{}", "true", "1979-05-27", "07:32:00", "[[1]]"]),
)
_ODD = 5  # any that hypothesis has no liking for, as it has for zero
_bounces = st.sampled_from(("1", "1", "1", "2", "3", "0"))
_key = st.text("abcdefghijklmnopqrstuvwxyz_.-AHC ", min_size=1, max_size=8)


@st.composite
def _value(draw: st.DrawFn) -> str:
    """Draw a value: one that a can may have, but for one in forty."""
    # equal branches of `one_of` count once, so the odds are drawn
    return draw(_edges if draw(st.integers(0, 39)) == _ODD else _plausible)


@st.composite
def scene_texts(draw: st.DrawFn) -> str:
    """Draw the text of a scene file, or of something like one."""
    lines = [f'name = "{draw(_names())}"', f"gravity = {draw(_value())}"]
    for table, keys in _KEYS.items():
        usual = {"can": 5, "release": len(keys) - 1, "horizon": 1}[table]
        # a table out of order in one file of eight
        chosen = keys[:usual]
        if draw(st.integers(0, 7)) == _ODD:
            chosen = tuple(draw(st.lists(st.sampled_from(keys))))
        lines.append(f"[{table}]")
        for key in chosen:
            value = draw(_bounces if key == "bounces" else _value())
            lines.append(f"{key} = {value}")
        if draw(st.integers(0, 15)) == _ODD:
            lines.append(f"{draw(_key)} = {draw(_value())}")
    if draw(st.integers(0, 7)) == _ODD:
        for effect in draw(st.sets(st.sampled_from(sorted(KINDS)), max_size=2)):
            lines.append(f"[effects.{effect}]")
            lines += [f"{field.name} = {draw(_value())}" for field in fields(KINDS[effect])]
    return "\n".join(lines) + "\n"


@st.composite
def _names(draw: st.DrawFn) -> str:
    """Draw a name as TOML writes it: mostly harmless."""
    if draw(st.integers(0, 7)) != _ODD:
        return "made"
    if draw(st.booleans()):
        return draw(st.sampled_from(NAMES))
    return "".join(f"\\U{ord(letter):08x}" for letter in draw(st.text(max_size=20)))


def each_made(count: int, number: int, see: Callable[[bytes], None]) -> None:
    """Hand so many scene files to a function, the same for the same number."""

    @seed(number)
    @settings(
        max_examples=count,
        database=None,
        deadline=None,
        phases=[Phase.generate],
        verbosity=Verbosity.quiet,
        suppress_health_check=list(HealthCheck),
    )
    @given(scene_texts())
    def shown(text: str) -> None:
        see(text.encode("utf-8", errors="replace"))

    shown()
