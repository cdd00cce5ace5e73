"""Scene files: what is read, and the sentence for everything that is wrong."""

import pickle
from pathlib import Path

import pytest

from models import Can, Effects, Horizon, Release, Scene, SceneFileError, Slip, read_scene

GOOD = """\
name = "a-scene"
cite = "here"
gravity = 9.81
[can]
mass = 0.043
radius = 0.037
a = 0.727
c = 0.615
h = 1.473
[release]
phi = 0.4
psi_dot = 2
[horizon]
bounces = 1
"""
CAN_KEYS = "mass, radius, a, A, c, C, h, H"
RELEASE_KEYS = "phi, psi, theta, phi_dot, psi_dot, theta_dot, height"
FILE_KEYS = "name, cite, gravity, can, release, horizon, effects"
POSITIVE = "a finite number greater than zero"


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "scene.toml"


def refused(path: Path) -> SceneFileError:
    """Return the error that the file is refused with."""
    with pytest.raises(SceneFileError) as caught:
        read_scene(path)
    assert caught.value.path == path
    assert len(caught.value.keys) == len(caught.value.problems)
    return caught.value


def problems(path: Path) -> tuple[str, ...]:
    """Return what is wrong with the file, the lines without its name; each must have named it."""
    error = refused(path)
    prefix = f"scene file '{path}': "
    lines = str(error).split("\n")
    assert all(line.startswith(prefix) for line in lines)
    assert error.__cause__ is None  # one clear message, no chain behind it
    return tuple(line.removeprefix(prefix) for line in lines)


def test_a_scene_is_read_as_it_says(path: Path) -> None:
    path.write_text(GOOD)
    assert read_scene(str(path)) == Scene(
        name="a-scene",
        cite="here",
        gravity=9.81,
        can=Can.from_groups(mass=0.043, radius=0.037, a=0.727, c=0.615, h=1.473),
        release=Release(phi=0.4, psi_dot=2.0),
        horizon=Horizon(bounces=1),
    )


def test_groups_and_si_units_mix_and_effects_are_read(path: Path) -> None:
    text = GOOD.replace("a = 0.727", "A = 4e-5").replace("h = 1.473", "H = 0.05")
    path.write_text(text + "[effects]\nslip = { mu = 0 }\n")
    scene = read_scene(path)
    assert scene.can.transverse_inertia == 4e-5
    assert scene.can.half_height == 0.05
    assert scene.can.axial_inertia == 0.615 * (0.043 * 0.037**2)
    assert scene.effects == Effects(slip=Slip(mu=0.0))


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        (
            "mass = 0.043",
            'mass = "heavy"',
            "key 'can.mass' is the string 'heavy', but must be a number",
        ),
        ("mass = 0.043", "mass = true", "key 'can.mass' is true, but must be a number"),
        ("mass = 0.043", "mass = [1]", "key 'can.mass' is an array, but must be a number"),
        (
            "mass = 0.043",
            "mass = 2023-02-02",
            "key 'can.mass' is the date or time 2023-02-02, but must be a number",
        ),
        (
            "mass = 0.043",
            "mass = 1" + "0" * 400,
            "key 'can.mass' is an integer that is too large for a double",
        ),
        ("mass = 0.043", "mass = 1" + "0" * 5000, "holds an integer of more than 4300 digits"),
        ("mass = 0.043\n", "", "key 'can.mass' is missing; it must be a number"),
        ('name = "a-scene"\n', "", "key 'name' is missing; it must be a string"),
        ("[horizon]\nbounces = 1\n", "", "key 'horizon' is missing; it must be a table"),
        (
            "gravity = 9.81",
            "gravity = 9.81\nhorizon.x = 1",
            "is not valid TOML: Cannot declare ('horizon',) twice (at line 14, column 9)",
        ),
        ("mass = 0.043", "mass = nan", f"key 'can.mass' is nan, but must be {POSITIVE}"),
        ("mass = 0.043", "mass = -1", f"key 'can.mass' is -1.0, but must be {POSITIVE}"),
        ("mass = 0.043", "mass = 1e999", f"key 'can.mass' is inf, but must be {POSITIVE}"),
        ("radius = 0.037", "radius = 0", f"key 'can.radius' is 0.0, but must be {POSITIVE}"),
        ("h = 1.473", "H = -1", f"key 'can.H' is -1.0, but must be {POSITIVE}"),
        (
            "gravity = 9.81",
            "gravity = -9.81",
            "key 'gravity' is -9.81, but must be a finite number, zero or greater",
        ),
        (
            "psi_dot = 2",
            "psi_dot = inf",
            "key 'release.psi_dot' is inf, but must be a finite number",
        ),
        (
            "a = 0.727",
            "a = 0.727\nA = 4e-5",
            "keys 'can.a' and 'can.A' are both given, but exactly one of them must be there",
        ),
        (
            "c = 0.615\n",
            "",
            "keys 'can.c' and 'can.C' are both missing, but exactly one of them must be there",
        ),
        (
            "c = 0.615",
            "c = 1.5",
            (
                "key 'can.c' is 1.5, but must be at most twice the moment about a transverse "
                "axis: no rigid body has C greater than 2A"
            ),
        ),
        (
            "c = 0.615",
            "C = 1e-3",
            (
                "key 'can.C' is 0.001, but must be at most twice the moment about a transverse "
                "axis: no rigid body has C greater than 2A"
            ),
        ),
        (
            "phi = 0.4",
            "phi = 1.6",
            "key 'release.phi' is 1.6, but must be greater than 0 and less than pi/2 (radians)",
        ),
        (
            "phi = 0.4",
            "phi = 0",
            "key 'release.phi' is 0.0, but must be greater than 0 and less than pi/2 (radians)",
        ),
        (
            "psi_dot = 2",
            "psidot = 2",
            f"key 'release.psidot' is unknown, did you mean 'psi_dot'? allowed are {RELEASE_KEYS}",
        ),
        ("psi_dot = 2", "x = 2", f"key 'release.x' is unknown; allowed are {RELEASE_KEYS}"),
        (
            "psi_dot = 2",
            '"a\\nb" = 2',
            f"key 'release.a\\nb' is unknown; allowed are {RELEASE_KEYS}",
        ),
        (
            "bounces = 1",
            "bounces = 1\nseconds = 1",
            (
                "keys 'horizon.bounces' and 'horizon.seconds' are both given, "
                "but exactly one of them must be there"
            ),
        ),
        ("bounces = 1", "bounces = 1.0", "key 'horizon.bounces' is 1.0, but must be an integer"),
        (
            "bounces = 1",
            "bounces = 0",
            "key 'horizon.bounces' is 0, but must be an integer from 1 to 100000",
        ),
        (
            'name = "a-scene"',
            'name = "A Scene"',
            (
                "key 'name' is 'A Scene', but must be 1 to 64 lower-case letters, digits, dots, "
                "dashes and underscores, the first a letter or digit"
            ),
        ),
        ("phi = 0.4", "phi = ", "is not valid TOML: Invalid value (at line 11, column 7)"),
        (
            "phi = 0.4",
            "phi = 0.4\nphi = 0.5",
            "is not valid TOML: Cannot overwrite a value (at line 12, column 10)",
        ),
        (
            "mass = 0.043",
            "mas = 0.043",
            f"key 'can.mas' is unknown, did you mean 'mass'? allowed are {CAN_KEYS}",
        ),
        ("gravity = 9.81", "g = 9.81", f"key 'g' is unknown; allowed are {FILE_KEYS}"),
        (
            "phi = 0.4",
            "Phi = 0.4",
            f"key 'release.Phi' is unknown, did you mean 'phi'? allowed are {RELEASE_KEYS}",
        ),
        (
            "[horizon]",
            "[horizons]",
            f"key 'horizons' is unknown, did you mean 'horizon'? allowed are {FILE_KEYS}",
        ),
        (GOOD, "x = " + "[" * 100_000, "is not valid TOML: it is nested too deeply"),
    ],
)
def test_each_mistake_has_its_sentence(path: Path, old: str, new: str, expected: str) -> None:
    assert old in GOOD
    path.write_text(GOOD.replace(old, new))
    assert problems(path) == (expected,)


def test_all_wrong_keys_are_reported_together(path: Path) -> None:
    path.write_text(GOOD.replace("[can]", "[cam]").replace("gravity", "gravitas"))
    assert refused(path).keys == ("gravitas", "cam")


def test_a_key_that_no_unknown_one_stands_for_is_missing_beside_it(path: Path) -> None:
    path.write_text(GOOD.replace("mass = 0.043\nradius = 0.037", "mas = 0.043"))
    assert refused(path).keys == ("can.radius", "can.mas")


def test_all_tables_report_their_wrong_values_together(path: Path) -> None:
    path.write_text(GOOD.replace("0.043", "-1").replace("0.4", "4.0").replace("= 1\n", "= 0\n"))
    assert refused(path).keys == ("can.mass", "release.phi", "horizon.bounces")


def test_a_file_full_of_mistakes_does_not_fill_the_screen(path: Path) -> None:
    path.write_text("".join(f"k{n} = 1\n" for n in range(1000)) + GOOD)
    found = refused(path)
    assert found.keys == (*(f"k{n}" for n in range(10)), "")
    assert found.problems[-1] == "has 990 more such problems"


def test_long_values_are_quoted_short(path: Path) -> None:
    path.write_text(GOOD.replace('"here"', '"' + "y" * 10_000 + '"'))
    error = refused(path)
    assert error.keys == ("cite",)
    (line,) = error.problems
    assert "yyy" in line
    assert len(line) < 200


@pytest.mark.parametrize(
    ("old", "new", "key"),
    [
        ("c = 0.615\n", "", "can"),
        ("bounces = 1", "bounces = 1\nseconds = 1", "horizon"),
        ("phi = 0.4", "phi = ", ""),
        ('name = "a-scene"', 'name = "A Scene"', "name"),
    ],
)
def test_a_problem_without_a_key_of_its_own_is_of_its_table_or_the_file(
    path: Path, old: str, new: str, key: str
) -> None:
    path.write_text(GOOD.replace(old, new))
    error = refused(path)
    assert error.keys == (key,)
    again = pickle.loads(pickle.dumps(error))  # noqa: S301 - our own bytes
    assert (again.path, again.problems, again.keys) == (path, error.problems, error.keys)
