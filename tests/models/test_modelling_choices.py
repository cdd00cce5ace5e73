"""Every effect says what it supposes, once."""

import pytest

from models import KINDS, MODELLING_CHOICES, Effects
from models.effects import modelling_choices


def test_every_effect_has_its_sentence() -> None:
    assert tuple(MODELLING_CHOICES) == tuple(KINDS)
    assert len(set(MODELLING_CHOICES.values())) == len(KINDS)
    for sentence in MODELLING_CHOICES.values():
        assert sentence[0].isupper()
        assert sentence.endswith(".")


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("slip", "static equal to kinetic"),
        ("slip", "a cone of its own"),
        ("drilling", "beside the cone of friction"),
        ("rolling_resistance", "beside the cone of friction"),
        ("damping", "also where the plane is shaken"),
    ],
)
def test_what_another_model_would_choose_otherwise_is_said(name: str, words: str) -> None:
    assert words in MODELLING_CHOICES[name]


def test_only_what_is_declared_is_said() -> None:
    assert modelling_choices(Effects()) == ()
    two = Effects(slip=KINDS["slip"](mu=0.3), tilt=KINDS["tilt"](angle=0.1))
    assert modelling_choices(two) == (MODELLING_CHOICES["slip"], MODELLING_CHOICES["tilt"])
