"""Errors that wrong use of the harness raises; each message says the fix.

A numerical failure of an engine is no error: it is an `Outcome` of a simulation.
"""

import re
from collections.abc import Iterable
from pathlib import Path
from typing import Self

from models.errors import did_you_mean


class HarnessError(Exception):
    """Root of all errors that the harness raises for wrong use."""

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle by the attributes: an error made of keywords has no arguments to be made from."""
        return self._made_again, (self.args,), vars(self)

    @classmethod
    def _made_again(cls, args: tuple[object, ...]) -> Self:
        error = cls.__new__(cls, *args)
        error.args = args
        return error


class UnknownEngineError(HarnessError, LookupError):
    """No engine of that name is installed.

    Parameters
    ----------
    name : str
        What was asked for.
    available : iterable of str
        The engines there are; kept sorted.
    """

    def __init__(self, name: str, available: Iterable[str]) -> None:
        self.name = name
        self.available = tuple(sorted(available))
        super().__init__(name, self.available)

    def __str__(self) -> str:
        """List what there is."""
        hint = did_you_mean(self.name, self.available)
        return f"unknown engine '{self.name}'{hint} there are: {', '.join(self.available)}"


class MissingPackageError(HarnessError, ImportError):
    """The Python package behind an engine, or another optional part, cannot be imported.

    Parameters
    ----------
    part : str
        What needs it, as a sentence names it.
    package : str
    reason : str
        Why it cannot be imported.
    install : str
        The command that installs it.
    """

    _needed, _fails = "package", "imported"

    def __init__(self, part: str, package: str, reason: str, install: str) -> None:
        super().__init__(part, package, reason, install)
        self.part, self.package, self.reason, self.install = part, package, reason, install

    def __str__(self) -> str:
        """Say how the package is installed."""
        return (
            f"{self.part} needs the {self._needed} '{self.package}', which cannot be {self._fails} "
            f"({self.reason}); install it with: {self.install}"
        )


class MissingLibraryError(MissingPackageError):
    """A library of the operating system behind an engine is not there, or of the wrong kind.

    `install` is how the operating system installs it.
    """

    _needed, _fails = "library", "used"


class MissingCheckoutError(HarnessError, ImportError):
    """An installed package is asked for a program that only the source checkout has.

    Parameters
    ----------
    folder : str
        Where the program is in the checkout.
    """

    def __init__(self, folder: str) -> None:
        super().__init__(folder)
        self.folder = folder

    def __str__(self) -> str:
        """Say how the program is run in the checkout."""
        return (
            f"this needs '{self.folder}' of the source checkout, which an installed package does "
            "not have; get the checkout from where the package is developed, and in it run: "
            f"make test, then .venv/bin/python -m {self.folder.replace('/', '.')}"
        )


class BrokenEngineError(MissingPackageError):
    """The package behind an engine is there, but no engine can be made of it.

    `package` is the module of the entry point, and `install` is empty: nothing is missing.

    Parameters
    ----------
    engine : str
    entry : str
        The entry point, ``module:Class``.
    reason : str
        What happened.
    """

    def __init__(self, engine: str, entry: str, reason: str) -> None:
        super().__init__(f"engine '{engine}'", entry.partition(":")[0], reason, "")
        self.args = engine, entry, reason
        self.engine, self.entry = engine, entry

    def __str__(self) -> str:
        """Say what an entry point must name."""
        return (
            f"engine '{self.engine}' cannot be made from its entry point '{self.entry}' "
            f"({self.reason}); the entry point must name a class that is made without arguments"
        )


class BrokenPackageError(BrokenEngineError):
    """The packages behind an engine are installed, and cannot be imported."""

    def __str__(self) -> str:
        """Say that another build may do."""
        return (
            f"engine '{self.engine}' is installed, and cannot be imported ({self.reason}): another "
            "build of it may do"
        )


class EngineCrashError(BrokenEngineError):
    """Making an engine kills the process that does it, or never ends."""

    def __str__(self) -> str:
        """Say how to go on without the engine."""
        return (
            f"engine '{self.engine}' falls while it is made from its entry point '{self.entry}' "
            f"({self.reason}); leave it out with --engine, or uninstall its package"
        )


class ReservedNameError(BrokenEngineError):
    """An engine is registered under a name that is a word of the command line."""

    def __init__(self, engine: str, entry: str) -> None:
        super().__init__(engine, entry, "the name is reserved")
        self.args = engine, entry

    def __str__(self) -> str:
        """Say what to do."""
        return (
            f"no engine can be called '{self.engine}', which is a word of the command line; "
            f"register '{self.entry}' under another name"
        )


class EngineContractError(BrokenEngineError):
    """An engine does not say with which timestep it runs a case.

    Parameters
    ----------
    engine : str
    case : str
        Label of the case.
    reason : str
        What happened.
    """

    def __init__(self, engine: str, case: str, reason: str) -> None:
        super().__init__(engine, "", reason)
        self.args = engine, case, reason
        self.case = case

    def __str__(self) -> str:
        """Say how to go on without the engine."""
        return (
            f"engine '{self.engine}' falls when it is asked for the timestep of the case "
            f"'{self.case}' ({self.reason}); leave it out with --engine, or mend its adapter"
        )


class UnknownSettingError(HarnessError, LookupError):
    """An engine has no setting of that name.

    Parameters
    ----------
    engine, name : str
    available : iterable of str
        The settings of the engine; kept sorted.
    owners : iterable of str
        Engines that have a setting of that name.
    """

    def __init__(
        self, engine: str, name: str, available: Iterable[str], owners: Iterable[str] = ()
    ) -> None:
        self.engine, self.name = engine, name
        self.available, self.owners = tuple(sorted(available)), tuple(owners)
        super().__init__(engine, name, self.available, self.owners)

    def __str__(self) -> str:
        """List the settings there are."""
        hint, listed = did_you_mean(self.name, self.available), ", ".join(self.available) or "none"
        if self.owners:
            hint = f", which is one of {', '.join(self.owners)};"
        return (
            f"engine '{self.engine}' has no setting '{self.name}'{hint} its settings are: {listed}"
        )


class InvalidSettingError(HarnessError, ValueError):
    """A setting, profile or timestep has a value that it cannot have.

    Parameters
    ----------
    name : str
    value : object
    allowed : str
        The allowed values, to be read after "allowed:".
    """

    def __init__(self, name: str, value: object, allowed: str) -> None:
        super().__init__(name, value, allowed)
        self.name, self.value, self.allowed = name, value, allowed

    def __str__(self) -> str:
        """Return the value and the allowed values in a sentence."""
        # what follows a colon is a reason
        named = self.allowed.partition(": ")[0]
        words = re.split(", | or ", named) if isinstance(self.value, str) else []
        hint = did_you_mean(str(self.value), words)
        return f"setting '{self.name}' cannot be {self.value!r}{hint} allowed: {self.allowed}"


class UnsupportedEffectError(HarnessError, ValueError):
    """A scene declares an effect that the engine neither honours nor imposes.

    Parameters
    ----------
    engine, effect : str
    able : iterable of str
        The engines that can represent the effect; kept sorted.
    """

    def __init__(self, engine: str, effect: str, able: Iterable[str]) -> None:
        self.engine, self.effect = engine, effect
        self.able = tuple(sorted(able))
        super().__init__(engine, effect, self.able)

    @property
    def _others(self) -> str:
        return ", ".join(self.able) or "none of the installed engines"

    def __str__(self) -> str:
        """List the engines that can."""
        return (
            f"engine '{self.engine}' cannot represent the effect '{self.effect}' that the scene "
            f"declares; engines that can: {self._others}"
        )


class EffectBelowMinimumError(UnsupportedEffectError):
    """A scene declares an effect that is weaker than the weakest that the engine takes.

    Parameters
    ----------
    engine : str
    key : str
        Constant of the effect, ``effect.constant``.
    value, least : float
        What the scene declares and the least that the engine takes, in the unit of the constant.
    able : iterable of str
        The engines that take the value; kept sorted.
    """

    def __init__(
        self, engine: str, key: str, value: float, least: float, able: Iterable[str]
    ) -> None:
        super().__init__(engine, key.partition(".")[0], able)
        self.args = engine, key, value, least, self.able
        self.key, self.value, self.least = key, value, least

    def __str__(self) -> str:
        """Return the least value, and list the engines that can."""
        return (
            f"engine '{self.engine}' cannot represent 'effects.{self.key}' = {self.value:g} that "
            f"the scene declares: it takes {self.least:g} or more; engines that can: {self._others}"
        )


class RefusedModelError(HarnessError, ValueError):
    """An engine does not compile a case: the scene or a setting is out of its range.

    Parameters
    ----------
    engine : str
    case : str
        Label of the case.
    reason : str
        What the engine says; kept in one line.
    """

    def __init__(self, engine: str, case: str, reason: str) -> None:
        self.engine, self.case, self.reason = engine, case, " ".join(reason.split())
        super().__init__(engine, case, self.reason)

    def __str__(self) -> str:
        """Return what the engine says of the case."""
        return f"engine '{self.engine}' does not compile the case '{self.case}': {self.reason}"


class ParityError(HarnessError, ValueError):
    """An engine compiled another can than the scene's, and the run did not start.

    Parameters
    ----------
    case : str
        Label of the case.
    quantities : str
        The quantities in which the two differ.
    """

    def __init__(self, case: str, quantities: str) -> None:
        super().__init__(case, quantities)
        self.case, self.quantities = case, quantities

    def __str__(self) -> str:
        """Say what to do about the difference."""
        return (
            f"{self.case}: the engine's model is not the scene's in: {self.quantities} (see the "
            "parity table); leave the settings that cause it at the profile's, or use --profile "
            "default"
        )


class TrajectoryError(HarnessError, ValueError):
    """An engine returned what is no trajectory."""


class OutputError(HarnessError, OSError):
    """A result cannot be written, or completed, where it was asked for."""


class ReportError(HarnessError, OSError):
    """A report that was written earlier cannot be read."""


class StoreError(HarnessError, ValueError):
    """A store, or an entry of one, is not what was written there."""


class CacheWarning(UserWarning):
    """A broken entry of the result cache was moved to the folder `aside`.

    Parameters
    ----------
    path : Path
        Where it was.
    reason : str
    aside : Path
    """

    def __init__(self, path: Path, reason: str, aside: Path) -> None:
        super().__init__(path, reason, aside)
        self.path, self.reason, self.aside = path, reason, aside

    def __str__(self) -> str:
        """Say what becomes of the entry."""
        return f"{self.path}: {self.reason}; it is set aside in '{self.aside}' and done again"


class ClusterError(HarnessError, OSError):
    """A cluster cannot be reached, or is not fit to run cases."""
