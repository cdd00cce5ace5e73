"""Errors in the description of a can, each with one sentence.

Every message names the file or the key, its value and the allowed values.
"""

from collections.abc import Iterable, Sequence
from difflib import get_close_matches
from pathlib import Path

_LONGEST_SHOWN = 80


def shown(value: object) -> str:
    """Return the value as a message quotes it: its repr, shortened when it is long."""
    text = repr(value)
    return text if len(text) <= _LONGEST_SHOWN else text[: _LONGEST_SHOWN - 3] + "..."


def did_you_mean(name: str, names: Iterable[str], otherwise: str = ";") -> str:
    """Return what follows a wrong name in a message: the nearest of the names, if one is near."""
    known = {one.casefold(): one for one in names}
    near = get_close_matches(name.casefold(), list(known), n=1)
    return f", did you mean {known[near[0]]!r}?" if near else otherwise


class ModelError(ValueError):
    """The root of everything that `models` refuses."""


class InvalidValueError(ModelError):
    """A quantity has a value that no can, release or scene may have.

    Parameters
    ----------
    key : str
        The quantity, as its owner names it: ``mass``, ``phi``, ``mu``.
    value : object
        The value.
    allowed : str
        What is allowed, to be read after "must be".
    """

    def __init__(self, key: str, value: object, allowed: str) -> None:
        super().__init__(key, value, allowed)
        self.key = key
        self.value = value
        self.allowed = allowed

    def __str__(self) -> str:
        """Return the value and the allowed values in a sentence."""
        return f"`{self.key}` is {shown(self.value)}, but must be {self.allowed}"


class RecordShapeError(ModelError):
    """The arrays of a record of a motion do not belong together.

    Parameters
    ----------
    time, quaternion, angular_velocity : tuple of int
        The shapes they have; (n,), (n, 4) and (n, 3) with n of at least 1 belong together.
    """

    def __init__(
        self, time: tuple[int, ...], quaternion: tuple[int, ...], angular_velocity: tuple[int, ...]
    ) -> None:
        super().__init__(time, quaternion, angular_velocity)
        self.time = time
        self.quaternion = quaternion
        self.angular_velocity = angular_velocity

    def __str__(self) -> str:
        """Return the shapes that a record needs, and those found."""
        return (
            f"a record needs `time` of shape (n,), `quaternion` (n, 4) and `angular_velocity` "
            f"(n, 3), n at least 1; found {self.time}, {self.quaternion} and "
            f"{self.angular_velocity}"
        )


class SceneFileError(ModelError):
    """A scene file cannot be read, or says something that no scene may say.

    Parameters
    ----------
    path : Path
        The file.
    problems : sequence of str
        What is wrong with it, one sentence each.
    keys : sequence of str, optional
        For each problem the key or table that it is about, such as ``can.mass``; empty where it is
        the file as a whole, as it is of all problems if left out.
    """

    def __init__(self, path: Path, problems: Sequence[str], keys: Sequence[str] = ()) -> None:
        super().__init__(path, tuple(problems), tuple(keys))
        self.path = path
        self.problems = tuple(problems)
        self.keys = tuple(keys) or ("",) * len(self.problems)

    def __str__(self) -> str:
        """Return one line for each problem, each with the name of the file."""
        return "\n".join(f"scene file {str(self.path)!r}: {problem}" for problem in self.problems)


class UnknownSceneError(ModelError):
    """No scene has this name, and no file this path.

    Parameters
    ----------
    name : str
        What was asked for.
    available : sequence of str
        The scenes there are.
    """

    def __init__(self, name: str, available: Sequence[str]) -> None:
        super().__init__(name, tuple(available))
        self.name = name
        self.available = tuple(available)

    def __str__(self) -> str:
        """List what there is."""
        hint = did_you_mean(self.name, self.available, otherwise=":")
        return (
            f"unknown scene {shown(self.name)}{hint} it is neither in the catalogue "
            f"({', '.join(self.available)}) nor the path of a scene file"
        )
