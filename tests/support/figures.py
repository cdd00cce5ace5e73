"""What every figure of a study keeps to."""

import re
from collections.abc import Iterable

from harness.core.report_model import Artefact, Figure


def assert_two_sentences(artefacts: Iterable[Artefact]) -> None:
    """Hold the figures among artefacts, of which there are some, to two sentences on each."""
    captions = {one.name: one.seen for one in artefacts if isinstance(one, Figure)}
    assert captions
    assert {name: sentences(seen) for name, seen in captions.items()} == dict.fromkeys(captions, 2)


def sentences(text: str) -> int:
    """Return how many sentences a text has."""
    return len(re.findall(r"[.!?](?=\s|$)", text))
