"""Programs of an engine alone that stand in pages, each with what it prints below it."""

import re
import subprocess
import sys

PACKAGES = {
    "odepy": "ode",
    "dartpy": "dart",
    "pydrake": "drake",
    "ovphysx": "physx",
    "newton": "newton",
    "mujoco_warp": "mujoco-warp",
    "mujoco import mjx": "mjx",
    "pybullet": "pybullet",
    "mujoco": "mujoco",
}
"""Packages that programs import, with the engine; the first that is found needs most."""


def engine_of(text: str) -> str:
    """Return the engine that the program of a page needs."""
    imported = re.findall(r"^(?:import|from) (.*)$", text, flags=re.MULTILINE)
    return next(e for p, e in PACKAGES.items() if any(line.startswith(p) for line in imported))


def check_program(text: str) -> None:
    """Assert that the one program of a page prints what stands below it."""
    (program,) = re.findall(r"```python\n(.*?)```", text, flags=re.DOTALL)
    (printed,) = re.findall(r"```text\n(.*?)```", text, flags=re.DOTALL)
    done = subprocess.run(  # noqa: S603 - our own program
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert done.stdout == printed


def sections(text: str) -> list[str]:
    """Return the titles of the sections of a page."""
    return re.findall(r"^## (.*)$", text, flags=re.MULTILINE)
