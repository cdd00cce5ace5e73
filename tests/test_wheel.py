"""The wheel, built and installed in empty environments, run where a user's files could mislead it.

Every Python that the classifiers name and that is present gets an environment of its own, from the
package index. Where that cannot be reached, the dependencies are those of this environment.
"""

import json
import os
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from zipfile import ZipFile

import pytest

pytestmark = pytest.mark.slow(minutes=5)  # three environments with all dependencies, three suites

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
VERSIONS = tuple(
    version
    for line in PROJECT["classifiers"]
    if (version := line.rpartition(" :: ")[2]).startswith("3.")
)
WITH_PYBULLET = {"3.11"}
"""Versions of which PyBullet has a wheel; for others a plain install must do without."""


def output(*words: object, timeout: float = 60.0) -> str:
    """Return what a program says, or nothing if it cannot be run."""
    try:
        done = subprocess.run(  # noqa: S603 - our own words
            [*map(str, words)], capture_output=True, text=True, timeout=timeout, check=True
        )
    except (OSError, subprocess.SubprocessError):
        return ""
    return done.stdout.strip()


def interpreter(version: str) -> Path | None:
    """Return a Python of a version that runs: this one, one on the path, or one of pyenv's.

    A shim on the path is there also where the version that it stands for is not chosen.
    """
    name = f"python{version}"
    places = [Path(folder, name) for folder in os.environ.get("PATH", "").split(os.pathsep)]
    places += map(Path, output("pyenv", "whence", "--path", name).splitlines())
    program = "import sys; print('%d.%d' % sys.version_info[:2])"
    return next((p for p in places if output(p, "-c", program) == version), None)


@dataclass(frozen=True)
class Installed:
    """An environment with the wheel."""

    version: str
    python: Path

    def run(
        self, folder: Path, *words: object, timeout: float = 120.0
    ) -> subprocess.CompletedProcess[str]:
        """Run a program of the environment in a folder."""
        environment = {k: v for k, v in os.environ.items() if not k.startswith("PYTHON")}
        return subprocess.run(  # noqa: S603 - our own words
            [str(self.python.parent / str(words[0])), *map(str, words[1:])],
            cwd=folder,
            env=environment | {"COLUMNS": "400"},
            capture_output=True,
            text=True,
            timeout=timeout,
            check=False,
        )


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Build the wheel."""
    folder = tmp_path_factory.mktemp("dist")
    words = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder)]
    subprocess.run(words, cwd=ROOT, check=True, capture_output=True, timeout=120)  # noqa: S603
    (built,) = folder.iterdir()
    return built


@pytest.fixture(scope="module", params=VERSIONS)
def installed(
    request: pytest.FixtureRequest, wheel: Path, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Installed]:
    """Install the wheel in an empty environment, which is removed afterwards."""
    version: str = request.param
    base = interpreter(version)
    if base is None:
        pytest.skip(f"there is no python{version} that runs")
    folder = tmp_path_factory.mktemp(f"python{version}")
    subprocess.run([base, "-m", "venv", folder / "env"], check=True, timeout=300)  # noqa: S603
    environment = Installed(version, folder / "env" / "bin" / "python")
    install = ("python", "-m", "pip", "install", "--quiet", "-c", ROOT / "constraints.txt")
    if environment.run(folder, *install, "--dry-run", "typer", timeout=300).returncode == 0:
        done = environment.run(folder, *install, wheel, timeout=1200)
    elif sys.version_info[:2] == tuple(map(int, version.split("."))):
        done = environment.run(folder, *install, "--no-deps", "--no-index", wheel, timeout=300)
        (site,) = (folder / "env" / "lib").glob("python*/site-packages")
        paths = [path for path in sys.path if path.endswith("site-packages")]
        (site / "borrowed.pth").write_text("\n".join(paths) + "\n", encoding="utf-8")
    else:
        pytest.skip(f"no package index to install the dependencies for Python {version} from")
    assert done.returncode == 0, done.stderr
    yield environment
    shutil.rmtree(folder)


@pytest.fixture
def cluttered(tmp_path: Path) -> Path:
    """Return a folder with files of a user that are called as packages of the wheel."""
    for name in ("harness.py", "models/__init__.py", "reference/__init__.py"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        text = "raise RuntimeError('a file of the user was imported')\n"
        (tmp_path / name).write_text(text, encoding="utf-8")
    return tmp_path


def test_the_classifiers_name_the_python_that_is_required() -> None:
    assert PROJECT["requires-python"] == f">={VERSIONS[0]}"


def test_a_wheel_has_the_packages_and_nothing_else(wheel: Path) -> None:
    names = ZipFile(wheel).namelist()
    own = {"harness", "models", "reference", "rockingcan.py"}
    assert {name.partition("/")[0] for name in names} - own == {
        f"{'-'.join(wheel.name.split('-')[:2])}.dist-info"
    }
    assert own <= {name.partition("/")[0] for name in names}
    for kept in (
        *("models/scenes/gentle-rock.toml", "harness/report/templates/index.html"),
        "harness/report/schema/result-2.json",
    ):
        assert kept in names


def test_what_is_installed_is_what_this_python_has_wheels_of(
    installed: Installed, tmp_path: Path
) -> None:
    done = installed.run(tmp_path, "rockingcan", "engines", "--json")
    engines = {engine["name"]: engine for engine in json.loads(done.stdout)["engines"]}
    assert engines["mujoco"]["installed"]
    assert engines["reference"]["installed"]
    pybullet = engines["pybullet"]
    assert pybullet["installed"] is (installed.version in WITH_PYBULLET)
    if not pybullet["installed"]:
        assert "rockingcan engines add pybullet --python python3.11" in pybullet["message"]
        assert pybullet["message"].endswith("-m pip install 'rockingcan[pybullet]')")
        asked = installed.run(tmp_path, "rockingcan", "run", "gentle-rock", "--engine", "pybullet")
        assert (asked.returncode, asked.stdout) == (2, "")
        assert asked.stderr == f"rockingcan: {pybullet['message']}\n"


def test_it_runs_where_files_have_the_names_of_its_packages(
    installed: Installed, cluttered: Path
) -> None:
    scenes = installed.run(cluttered, "rockingcan", "scenes")
    assert (scenes.returncode, scenes.stderr) == (0, "")
    assert "gentle-rock" in scenes.stdout
    exact = installed.run(cluttered, "rockingcan", "reference", "gentle-rock", "--json")
    assert (exact.returncode, exact.stderr) == (0, "")
    words = ("run", "gentle-rock", "--engine", "mujoco", "--timestep", "1e-3", "--json")
    run = installed.run(cluttered, "rockingcan", *words)
    assert (run.returncode, run.stderr) == (0, "")
    turn = json.loads(exact.stdout)["bounces"][0]["angle_of_turn_deg"]
    assert turn == pytest.approx(242.4925, abs=1e-3)
    assert json.loads(run.stdout)["outcome"].startswith("finished")


def test_the_main_job_runs_there_too(installed: Installed, cluttered: Path) -> None:
    done = installed.run(cluttered, "rockingcan", "validate", "--jobs", "2", timeout=1200)
    assert done.returncode == 0, done.stderr
    report = cluttered / "reports" / "latest"
    assert (report / "index.html").stat().st_size > 0
    summary = (report / "summary.md").read_text(encoding="utf-8")
    assert "mujoco matched to the scene misses the angle" in summary
    left_out = "Not installed, and so left out: pybullet; to have it, run: "
    assert (left_out in summary) is (installed.version not in WITH_PYBULLET)
    assert (left_out in done.stdout) is (installed.version not in WITH_PYBULLET)


def test_python_m_says_what_shadows_what(installed: Installed, cluttered: Path) -> None:
    done = installed.run(cluttered, "python", "-m", "rockingcan", "scenes")
    assert (done.returncode, done.stdout) == (2, "")
    shadow = (cluttered / "harness.py").resolve()
    assert done.stderr.startswith(f"rockingcan: '{shadow}' stands before its own package 'harness'")
    assert done.stderr.count("\n") == 1
    safe = installed.run(cluttered, "python", "-P", "-m", "rockingcan", "scenes")
    assert (safe.returncode, safe.stderr) == (0, "")


def test_what_needs_a_checkout_says_so(installed: Installed, tmp_path: Path) -> None:
    done = installed.run(tmp_path, "rockingcan", "benchmark")
    assert done.returncode == 2
    assert "of the source checkout" in done.stderr
