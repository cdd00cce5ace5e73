"""Meshes that stand for a can: read, refused where they are not closed, and asked of engines."""

import math
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
import trimesh

from harness.core.errors import InvalidSettingError, MissingPackageError
from harness.engines.can_mesh import (
    MESH_SETTING,
    Mesh,
    mesh_points,
    obj_text,
    outline_gap,
    prism,
    read_mesh,
)
from harness.studies.comparison.rim import RimStudy
from harness.studies.study import Results, run_study
from models import Scene
from tests.support.command_line import Command

Corner = tuple[float, float, float]


def written(path: Path, corners: Sequence[Corner], sides: Sequence[Sequence[int]]) -> Path:
    """Return the path of a mesh as it is written in OBJ; corners are counted from 1."""
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in corners]
    lines += [f"f {' '.join(map(str, side))}" for side in sides]
    path.write_text("\n".join(lines), encoding="utf-8")
    return path


TETRAHEDRON = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
CLOSED = ((1, 3, 2), (1, 2, 4), (2, 3, 4), (1, 4, 3))


def can_of(sides: int) -> trimesh.Trimesh:
    """Return a prism as another library makes it, in another unit and place."""
    mesh: trimesh.Trimesh = trimesh.creation.cylinder(radius=37.0, height=100.0, sections=sides)
    mesh.apply_translation((0.0, 0.0, 50.0))
    return mesh


@pytest.mark.parametrize("ending", ["obj", "stl"])
def test_a_file_is_scaled_to_the_can(gentle: Scene, tmp_path: Path, ending: str) -> None:
    path = tmp_path / f"can.{ending}"
    can_of(48).export(path)
    points, can = mesh_points(read_mesh(path), gentle.can), gentle.can
    assert len(points) == 96  # the middles of the ends are no corners
    single = 1e-6  # STL has single precision
    assert np.hypot(*points[:, :2].T) == pytest.approx(can.radius, rel=single)
    assert abs(points[:, 2]) == pytest.approx(can.half_height, rel=single)
    assert set(np.sign(points[:, 2])) == {-1.0, 1.0}


def test_a_mesh_is_its_own_text_again(gentle: Scene, tmp_path: Path) -> None:
    path = tmp_path / "can.obj"
    path.write_text(obj_text(mesh_points(prism(7), gentle.can)), encoding="utf-8")
    again = np.reshape(read_mesh(path), (-1, 3))
    expected = np.reshape(prism(7), (-1, 3))
    assert len(again) == len(expected)
    for corner in expected:  # in any order
        assert np.abs(again - corner).max(axis=1).min() < 1e-14


@pytest.mark.parametrize("sides", [3, 32, 101])
def test_the_gap_of_a_prism_is_in_the_middle_of_its_sides(sides: int) -> None:
    assert outline_gap(prism(sides)) == pytest.approx(1.0 - math.cos(math.pi / sides), rel=1e-9)


def test_a_mesh_without_flat_ends_has_any_gap() -> None:
    assert outline_gap((*(0.0, 0.0, 1.0), *prism(4)[:12])) == 1.0


@pytest.mark.parametrize("place", [(0.5, 0.3, 0.0), (1e6, 0.0, 0.0), (0.0, -1e3, 1e3)])
def test_a_mesh_may_be_anywhere(tmp_path: Path, place: tuple[float, float, float]) -> None:
    mesh, path = can_of(33), tmp_path / "can.obj"
    expected = np.reshape(_read(mesh, path), (-1, 3))
    mesh.apply_translation(place)
    found = np.reshape(_read(mesh, path), (-1, 3))
    assert len(found) == len(expected)
    assert np.abs(found - expected).max() < 1e-5  # of digits that the file has


def test_of_a_mesh_in_any_unit_the_same_is_read(tmp_path: Path) -> None:
    path = tmp_path / "can.obj"
    expected = _read(can_of(33), path)
    for scale in (1e-9, 1e9):
        mesh = can_of(33)
        mesh.vertices = mesh.vertices * scale
        path.write_text(obj_text(np.asarray(mesh.vertices, dtype=np.float64)), encoding="utf-8")
        assert np.reshape(read_mesh(path), (-1, 3)).shape == (66, 3)
        assert outline_gap(read_mesh(path)) == pytest.approx(outline_gap(expected), rel=1e-6)


def _read(mesh: trimesh.Trimesh, path: Path) -> Mesh:
    """Return what is read of a mesh that was written by another library."""
    mesh.export(path)
    return read_mesh(path)


def test_what_is_no_can_about_z_is_refused(tmp_path: Path) -> None:
    lying = can_of(32)
    lying.vertices = lying.vertices[:, [0, 2, 1]] * (1.0, -1.0, 1.0)
    oval = can_of(32)
    oval.vertices = oval.vertices * (1.0, 1.3, 1.0)
    on_a_face = can_of(6)
    on_a_face.vertices = on_a_face.vertices[:, [0, 2, 1]] * (1.0, -1.0, 1.0)
    box = trimesh.creation.box((1.0, 2.0, 3.0))
    for mesh in (lying, oval, on_a_face, box, trimesh.creation.icosphere()):
        with pytest.raises(InvalidSettingError, match="round about it, with flat ends"):
            _read(mesh, tmp_path / "a.obj")
    apart = can_of(32)
    apart.apply_translation((200.0, 0.0, 0.0))
    with pytest.raises(InvalidSettingError, match="one body, and it has 2"):
        _read(can_of(32) + apart, tmp_path / "a.obj")


@pytest.mark.parametrize(
    ("corners", "sides", "why"),
    [
        (TETRAHEDRON, CLOSED[:3], "3 edges have one triangle alone, such as from (0, "),
        (TETRAHEDRON, (), "a mesh of triangles"),
        ((*TETRAHEDRON[:3], (0.0, 0.0, math.nan)), CLOSED, "finite"),
        ((*TETRAHEDRON[:3], (0.5, 0.5, 0.0)), CLOSED, "a volume"),
        ((*TETRAHEDRON[:3], (0.0, 0.0, 1e-300)), CLOSED, "a volume"),
        ([(x, y, z + 1e17) for x, y, z in TETRAHEDRON], CLOSED, "a volume"),
        ([(1e300 * x, y, z) for x, y, z in TETRAHEDRON], CLOSED, "a volume"),
        (TETRAHEDRON, (*CLOSED, (1, 3, 2), (2, 3, 1)), "two triangles at every edge"),
        (TETRAHEDRON, CLOSED, "flat ends"),
        (TETRAHEDRON, (*CLOSED[:3], (1, 4, 9)), "a mesh in a known format"),
    ],
    ids=[
        *("open", "empty", "broken", "flat", "flatter", "far away", "drawn out", "doubled"),
        *("no can", "without a corner"),
    ],
)
def test_what_is_no_closed_mesh_is_refused(
    tmp_path: Path, corners: Sequence[Corner], sides: Sequence[Sequence[int]], why: str
) -> None:
    path = written(tmp_path / "a.obj", corners, sides)
    with pytest.raises(InvalidSettingError) as caught:
        read_mesh(path)
    assert caught.value.name == "--mesh"
    assert why in str(caught.value)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", ["none.obj", "text.txt", "folder.stl"])
def test_what_is_no_mesh_file_is_refused(tmp_path: Path, name: str) -> None:
    (tmp_path / "text.txt").write_text("v 1 2", encoding="utf-8")
    (tmp_path / "folder.stl").mkdir()
    with pytest.raises(InvalidSettingError, match=r"the path of a file|a known format"):
        read_mesh(tmp_path / name)


@pytest.mark.parametrize("ending", ["obj", "stl", "ply", "off"])
def test_garbage_is_refused(tmp_path: Path, ending: str) -> None:
    path = tmp_path / f"garbage.{ending}"
    path.write_bytes(bytes(range(256)) * 4)
    with pytest.raises(InvalidSettingError, match=r"a known format|of triangles"):
        read_mesh(path)


def test_too_many_corners_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "fine.stl"
    can_of(2600).export(path)
    with pytest.raises(InvalidSettingError, match="5000 corners at most"):
        read_mesh(path)


def test_without_the_package_it_is_named(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setitem(sys.modules, "trimesh", None)
    with pytest.raises(MissingPackageError, match=r"rockingcan\[mesh\]"):
        read_mesh(tmp_path / "can.obj")


def asked(engine: str, mesh: Mesh) -> tuple[RimStudy, Results]:
    """Return the study of a mesh, and its results."""
    study = RimStudy(engines=(engine,), meshes={"can.obj": mesh})
    return study, run_study(study)


def test_the_same_prism_has_the_same_findings_from_a_file_as_from_the_engine() -> None:
    own = RimStudy(engines=("mujoco",), settings={"mujoco": {"shapes": "mesh-plane"}})
    (expected,) = own.found(run_study(own))["mujoco"].values()
    study, done = asked("mujoco", prism(32))
    assert study.found(done)["mujoco"]["can.obj, mesh-plane"] == expected
    assert expected["findings"]


@pytest.mark.parametrize(
    "name", ["mujoco", pytest.param("pybullet", marks=pytest.mark.engine("pybullet"))]
)
def test_a_finer_mesh_is_nearer_to_the_rim(name: str) -> None:
    def farthest(sides: int) -> float:
        study, done = asked(name, prism(sides))
        record = next(iter(study.found(done)[name].values()))
        (place,) = (each for each in record["findings"] if each["kind"] == "place")
        found: float = place["place_error_m"]
        return found

    # half a side
    assert farthest(16) / farthest(64) == pytest.approx(math.tan(math.pi / 16) * 64 / math.pi, 0.1)


@pytest.mark.parametrize(
    ("name", "profile"),
    [
        ("mujoco", "matched"),
        pytest.param("pybullet", "default", marks=pytest.mark.engine("pybullet")),
        pytest.param("physx", "matched", marks=pytest.mark.engine("physx")),
        pytest.param("newton", "matched", marks=pytest.mark.engine("newton")),
    ],
)
def test_a_mesh_can_be_rolled(rockingcan: Command, name: str, profile: str) -> None:
    points = ",".join(map(repr, prism(24)))
    run = ("run", "gentle-rock", "--engine", name, "--profile", profile, "--timestep", "0.001")
    rolled = rockingcan(*run, "--set", f"{MESH_SETTING.name}={points}", "--json")
    assert rolled.code == 0, rolled.err
    assert rolled.json()["outcome"].startswith("finished")


def test_points_that_are_no_points_are_refused(rockingcan: Command) -> None:
    refused = rockingcan("run", "gentle-rock", "--engine", "mujoco", "--set", "mesh=1,2,3,4")
    assert refused.code == 2
    assert "points, three numbers each" in refused.err


def test_the_command_refuses_an_open_mesh_in_a_sentence(
    rockingcan: Command, tmp_path: Path
) -> None:
    path = written(tmp_path / "a.obj", TETRAHEDRON, CLOSED[:3])
    refused = rockingcan("probe", "mujoco", "--mesh", str(path))
    assert (refused.code, refused.err.count("\n")) == (2, 1)
    assert "a closed mesh" in refused.err


def test_an_engine_that_takes_no_mesh_is_refused_with_those_that_do(
    rockingcan: Command, tmp_path: Path
) -> None:
    can_of(32).export(tmp_path / "a.obj")
    refused = rockingcan("probe", "reference", "--mesh", str(tmp_path / "a.obj"))
    assert (refused.code, refused.err.count("\n")) == (2, 1)
    assert "engine 'reference' takes no mesh" in refused.err


def test_meshes_of_one_name_are_told_apart(tmp_path: Path, rockingcan: Command) -> None:
    paths = [tmp_path / folder / "can.obj" for folder in ("a", "b")]
    for path, sides in zip(paths, (16, 4), strict=True):
        path.parent.mkdir()
        can_of(sides).export(path)
    options = (word for path in paths for word in ("--mesh", str(path)))
    found = rockingcan("probe", "mujoco", *options, "--json").json()
    variants = dict.fromkeys(row["variant"] for row in found["rows"])
    assert {variant.partition(",")[0] for variant in variants} == set(map(str, paths))


@pytest.mark.parametrize("setting", ["shapes=cylinder-box", "mesh=0,0,1"])
def test_what_a_mesh_takes_the_place_of_is_not_set_as_well(
    tmp_path: Path, rockingcan: Command, setting: str
) -> None:
    can_of(32).export(tmp_path / "a.obj")
    refused = rockingcan("probe", "mujoco", "--mesh", str(tmp_path / "a.obj"), "--set", setting)
    assert (refused.code, refused.err.count("\n")) == (2, 1)
    assert "left out beside --mesh" in refused.err
