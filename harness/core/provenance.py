"""Provenance of a result: versions, platform, processor, commit and time.

No function fails: a value that cannot be determined is "unknown" or None, since a report without a
commit is still a report.
"""

import os
import platform
import shutil
import subprocess
from dataclasses import dataclass, field
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from types import MappingProxyType
from typing import Any

from harness.core.engine_packages import engine_packages
from harness.core.environments import environments
from harness.core.plain_json import Words

PACKAGES = (
    "numpy",
    "scipy",
    "pandas",
    "pyarrow",
    "pydantic",
    "jinja2",
    "matplotlib",
    "plotly",
)
"""Packages whose version, beside those of engines, can change a number or a report's look."""

UNKNOWN = "unknown"

_GIT_PATIENCE_S = 10.0  # a checkout on a slow network disk answers in seconds; longer is a hang


@dataclass(frozen=True, slots=True, kw_only=True)
class Commit:
    """The commit of a checkout, and whether files that it tracks have been changed since."""

    digest: str
    changed: bool


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Provenance:
    """Program, machine and time that produced a result.

    Parameters
    ----------
    rockingcan, python : str
        Versions.
    packages : mapping of str to str
        Versions of engines' packages and `PACKAGES`, as far as they are installed.
    environments : mapping of str to str
        Of each engine in an interpreter of its own, the versions there.
    platform, processor : str
    cores : int
        Cores that this process may use.
    commit : Commit or None
        None if the package does not run from a checkout.
    written : str
        UTC, ISO 8601, to the second.
    reference : str
        Code that solved releases by the exact bounce: "numpy", or "compiled" with the version of
        numba. The two differ by round-off.
    """

    rockingcan: str
    python: str
    packages: Words
    environments: Words = field(default_factory=lambda: MappingProxyType({}))
    platform: str
    processor: str
    cores: int
    commit: Commit | None
    written: str
    reference: str = "numpy"

    def to_dict(self) -> dict[str, Any]:
        """Return the provenance as in a manifest: strings, numbers and None only."""
        return {
            "rockingcan": self.rockingcan,
            "python": self.python,
            "packages": dict(self.packages),
            "environments": dict(self.environments),
            "platform": self.platform,
            "processor": self.processor,
            "cores": self.cores,
            "commit": None if self.commit is None else self.commit.digest,
            "changed_since_commit": None if self.commit is None else self.commit.changed,
            "written": self.written,
            "reference": self.reference,
        }


def provenance(*, reference: str = "numpy") -> Provenance:
    """Return the provenance of a result that is written now, and whose reference was solved so."""
    versions = {name: version_of(name) for name in (*engine_packages(), *PACKAGES)}
    return Provenance(
        rockingcan=version_of("rockingcan"),
        python=platform.python_version(),
        packages=MappingProxyType({k: v for k, v in versions.items() if v != UNKNOWN}),
        environments=MappingProxyType({name: str(place) for name, place in environments().items()}),
        platform=platform.platform(),
        processor=processor(),
        cores=_cores(),
        commit=commit_of(Path(__file__)),
        written=datetime.now(UTC).isoformat(timespec="seconds"),
        reference=reference,
    )


def commit_of(file: Path) -> Commit | None:
    """Return the commit of the checkout that tracks a file, or None if there is none.

    A file that merely lies below a checkout, such as a package installed in a virtual environment
    there, is not tracked by it and has no commit.
    """
    if _git(file.parent, "ls-files", "--error-unmatch", "--", file.name) is None:
        return None
    digest = _git(file.parent, "rev-parse", "HEAD")
    changes = _git(file.parent, "status", "--porcelain", "--untracked-files=no")
    if digest is None or changes is None:
        return None
    return Commit(digest=digest, changed=bool(changes))


def _git(folder: Path, *words: str) -> str | None:
    """Return git's output in a folder, or None if git fails or is not installed."""
    git = shutil.which("git")
    if git is None:
        return None
    # a hook or an outer git sets GIT_DIR and its like, which would speak of another checkout
    environment = {k: v for k, v in os.environ.items() if not k.startswith("GIT_")}
    try:
        done = subprocess.run(  # noqa: S603 # the words are this module's own
            [git, *words],
            cwd=folder,
            env=environment,
            capture_output=True,
            check=False,
            encoding="utf-8",
            errors="replace",
            timeout=_GIT_PATIENCE_S,
        )
    except (OSError, subprocess.TimeoutExpired):
        return None
    return done.stdout.strip() if done.returncode == 0 else None


def version_of(package: str, missing: str = UNKNOWN) -> str:
    """Return the version of an installed package, or `missing` if it is not installed."""
    try:
        return version(package)
    except PackageNotFoundError:
        return missing


def processor() -> str:
    """Return the name of the processor, which Linux has in a file only."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        lines = []
    names = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return next(names, "") or platform.processor() or platform.machine() or UNKNOWN


def _cores() -> int:
    """Return the number of cores that this process may use, which a container can limit."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
