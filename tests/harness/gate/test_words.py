"""What is said of a comparison: what got worse is named, with its case and its numbers."""

from harness.core.report_model import Figure, Prose, Table
from harness.gate.comparison import differences
from harness.gate.report import GATE, SIDES, gate_report, regressions, sentences
from harness.results.scores import QUANTITIES, QuantityKind
from tests.support.gate_scores import make_score, make_scores

PHI, SLIP, SUNK = "phi_rms_rad", "max_slip_m_s", "max_penetration_m"


def test_a_regression_is_named() -> None:
    accepted = make_scores(
        make_score({PHI: 1e-4, SLIP: 1.0}), make_score({PHI: 1e-4}, scene="petals")
    )
    run = make_scores(
        make_score({PHI: 5e-4, SLIP: 1.2}),
        make_score({PHI: 1e-5}, scene="petals"),
        make_score(scene="wobble"),
        versions={"mujoco": "4.0.1"},
        settings={"mujoco.impratio": "1"},
        suite="quick",
    )
    found = differences(accepted, run)
    assert [one.quantity for one in regressions(found)] == [PHI, SLIP]
    text = " ".join(sentences(found, accepted, run, GATE))
    assert (
        "Worse: gentle-rock in mujoco (matched, 0.001 s), error of the nutation phi (rms) "
        "0.0001 rad -> 0.0005 rad (5 times) and 1 more."
    ) in text
    assert "Better: petals in mujoco (matched, 0.001 s), error of the nutation phi (rms)" in text
    assert "0.0001 rad -> 1e-05 rad (0.1 times)" in text
    assert "New: wobble in mujoco" in text
    assert "mujoco 4.0.0 accepted, 4.0.1 found" in text
    assert "found has set: mujoco.impratio = 1" in text
    assert "No spread was measured" in text


def test_a_run_that_fails_is_named_before_a_number_that_grew() -> None:
    accepted = make_scores(make_score({PHI: 1e-4}), make_score({PHI: 1e-4}, scene="petals"))
    run = make_scores(make_score({PHI: 5e-4}), make_score(scene="petals", outcome="FLAT"))
    found = regressions(differences(accepted, run))
    assert [one.identity.scene for one in found] == ["petals", "gentle-rock"]
    text = " ".join(sentences(found, accepted, run, GATE))
    assert "petals in mujoco (matched, 0.001 s), finished, then flat; gentle-rock" in text


def test_two_sides_are_spoken_of_alike() -> None:
    a, b = (
        make_scores(make_score({PHI: 1.0}), place="A"),
        make_scores(make_score({PHI: 3.0}), place="B"),
    )
    forth, back = differences(a, b), differences(b, a)
    assert SIDES.verdict(forth[1]).text == "a is better"
    assert SIDES.verdict(back[1]).text == "b is better"
    assert forth[1].severity == back[1].severity == 3.0


def test_the_artefacts_hold_every_difference() -> None:
    accepted = make_scores(make_score({PHI: 1.0, SLIP: 0.0}, spread={PHI: 0.1, SLIP: None}))
    run = make_scores(make_score({PHI: 3.0, SLIP: 0.0}))
    found = differences(accepted, run)
    artefacts = gate_report(found, accepted, run, GATE)
    table = next(one for one in artefacts if isinstance(one, Table))
    assert len(table.frame) == len(found) == 3
    assert set(table.columns) == set(table.frame.columns)
    assert list(map(str, table.frame["verdict"])) == ["worse", "same", "undecidable"]
    figure = next(one for one in artefacts if isinstance(one, Figure))
    (panel,) = figure.panels
    assert panel.log_y  # ten times better is as far from the line of one as ten times worse
    drawn = {series.label: list(series.y) for series in panel.series}
    assert drawn == {"worse": [3.0], "undecidable": [1.0]}
    assert "1 of 2 have moved" in figure.seen
    assert any(isinstance(one, Prose) and one.name == "summary" for one in artefacts)


def test_machines_that_differ_are_named_and_what_one_side_does_not_know_is_left_out() -> None:
    there = make_scores(
        make_score({PHI: 1e-4}),
        versions={"mujoco": "4.0.0", "pybullet": "3.2.7"},
        platform="Linux A",
        processor="X",
    )
    here = make_scores(make_score({PHI: 1e-4}), platform="Linux B", processor="X")
    text = " ".join(sentences(differences(there, here), there, here, GATE))
    assert "They differ in: platform 'Linux A' accepted, 'Linux B' found." in text
    same = " ".join(sentences(differences(here, here), here, here, GATE))
    assert "They differ" not in same


def test_the_figure_of_factors_has_a_point_for_each_that_is_judged() -> None:
    values = {PHI: 1e-4, SLIP: 1.0, "cpu_s": 1.0, SUNK: 1.0}
    accepted = make_scores(make_score(values), make_score({PHI: 0.0}, scene="petals"))
    run = make_scores(
        make_score({PHI: 5e-4, SLIP: 1.2, "cpu_s": 9.0, SUNK: 0.0}),
        make_score({PHI: 1e-3}, scene="petals"),
    )
    artefacts = gate_report(differences(accepted, run), accepted, run, GATE)
    (figure,) = (a for a in artefacts if isinstance(a, Figure))
    (panel,) = figure.panels
    assert "the largest factor, either way, is 5." in figure.seen
    assert figure.columns == 1
    assert panel.x_names is not None
    judged = [quantity for quantity in QUANTITIES if quantity.kind is not QuantityKind.TIME]
    assert list(panel.x_names) == [quantity.words for quantity in judged]
    drawn = sorted(float(y) for series in panel.series for y in series.y)
    assert drawn == [1.2, 5.0]
    (table,) = (a for a in artefacts if isinstance(a, Table))
    assert set(table.frame["timestep_s"]) == {1e-3}


def test_a_quantity_that_only_one_side_has_is_said_in_words() -> None:
    has = make_scores(make_score({PHI: 1e-4, SLIP: 1.0}, spread={PHI: 0.0, SLIP: 0.0}))
    lacks = make_scores(make_score({PHI: 1e-4}, spread={PHI: 0.0}))
    text = " ".join(sentences(differences(has, lacks), has, lacks, GATE))
    assert "can no longer be told from the record" in text
    text = " ".join(sentences(differences(lacks, has), lacks, has, GATE))
    assert "could not be told from the record" in text
