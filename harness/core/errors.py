"""Errors that wrong use of the harness raises; each message says the fix.

A numerical failure of an engine is no error: it is an `Outcome` of a simulation.
"""

import re
from collections.abc import Iterable, Iterator
from contextlib import contextmanager

from models.errors import did_you_mean


class HarnessError(Exception):
    """Root of all errors that the harness raises for wrong use."""


class UnknownEngineError(HarnessError, LookupError):
    """No engine of that name is installed."""

    def __init__(self, name: str, available: Iterable[str]) -> None:
        names = sorted(available)
        hint = did_you_mean(name, names)
        super().__init__(f"unknown engine '{name}'{hint} there are: {', '.join(names)}")


class MissingPackageError(HarnessError, ImportError):
    """The Python package behind an engine, or another optional part, cannot be imported."""

    def __init__(self, part: str, package: str, reason: str, install: str) -> None:
        super().__init__(
            f"{part} needs the package '{package}', which cannot be imported "
            f"({reason}); install it with: {install}"
        )


class MissingCheckoutError(HarnessError, ImportError):
    """An installed package is asked for a program that only the source checkout has."""

    def __init__(self, folder: str) -> None:
        super().__init__(
            f"this needs '{folder}' of the source checkout, which an installed package does not "
            "have; get the checkout from where the package is developed, and in it run: "
            f"make test, then .venv/bin/python -m {folder.replace('/', '.')}"
        )


class BrokenEngineError(MissingPackageError):
    """The package behind an engine is there, but no engine can be made of it."""

    def __init__(self, engine: str, entry: str, reason: str) -> None:
        super(MissingPackageError, self).__init__(
            f"engine '{engine}' cannot be made from its entry point '{entry}' ({reason}); "
            "the entry point must name a class that is made without arguments"
        )


class EngineCrashError(BrokenEngineError):
    """Making an engine kills the process that does it, or never ends."""

    def __init__(self, engine: str, entry: str, reason: str) -> None:
        super(MissingPackageError, self).__init__(
            f"engine '{engine}' falls while it is made from its entry point '{entry}' ({reason}); "
            "leave it out with --engine, or uninstall its package"
        )


class EngineContractError(BrokenEngineError):
    """An engine does not say with which timestep it runs a case."""

    def __init__(self, engine: str, case: str, reason: str) -> None:
        super(MissingPackageError, self).__init__(
            f"engine '{engine}' falls when it is asked for the timestep of the case '{case}' "
            f"({reason}); leave it out with --engine, or mend its adapter"
        )


class UnknownSettingError(HarnessError, LookupError):
    """An engine has no setting of that name."""

    def __init__(self, engine: str, name: str, available: Iterable[str]) -> None:
        names = sorted(available)
        hint, listed = did_you_mean(name, names), ", ".join(names) or "none"
        super().__init__(
            f"engine '{engine}' has no setting '{name}'{hint} its settings are: {listed}"
        )


class InvalidSettingError(HarnessError, ValueError):
    """A setting, profile or timestep has a value that it cannot have."""

    def __init__(self, name: str, value: object, allowed: str) -> None:
        words = re.split(", | or ", allowed) if isinstance(value, str) else []
        hint = did_you_mean(str(value), words)
        super().__init__(f"setting '{name}' cannot be {value!r}{hint} allowed: {allowed}")


class UnsupportedEffectError(HarnessError, ValueError):
    """A scene declares an effect that the engine neither honours nor imposes."""

    def __init__(self, engine: str, effect: str, able: Iterable[str]) -> None:
        others = ", ".join(sorted(able)) or "none of the installed engines"
        super().__init__(
            f"engine '{engine}' cannot represent the effect '{effect}' that the scene declares; "
            f"engines that can: {others}"
        )


class EffectBelowMinimumError(UnsupportedEffectError):
    """A scene declares an effect that is weaker than the weakest that the engine takes."""

    def __init__(
        self, engine: str, key: str, value: float, least: float, able: Iterable[str]
    ) -> None:
        others = ", ".join(sorted(able)) or "none of the installed engines"
        super(UnsupportedEffectError, self).__init__(
            f"engine '{engine}' cannot represent 'effects.{key}' = {value:g} that the scene "
            f"declares: it takes {least:g} or more; engines that can: {others}"
        )


class RefusedModelError(HarnessError, ValueError):
    """An engine does not compile a case: the scene or a setting is out of its range."""

    def __init__(self, engine: str, case: str, reason: str) -> None:
        super().__init__(
            f"engine '{engine}' does not compile the case '{case}': {' '.join(reason.split())}"
        )


class ParityError(HarnessError, ValueError):
    """An engine compiled another can than the scene's, and the run did not start."""

    def __init__(self, case: str, quantities: str) -> None:
        super().__init__(
            f"{case}: the engine's model is not the scene's in: {quantities} (see the parity "
            "table); leave the settings that cause it at the profile's, or use --profile default"
        )


class TrajectoryError(HarnessError, ValueError):
    """An engine returned arrays that are not a trajectory."""


class OutputError(HarnessError, OSError):
    """A result cannot be written where it was asked for."""


class ReportError(HarnessError, OSError):
    """A report that was written earlier cannot be read."""


class StoreError(HarnessError, ValueError):
    """An entry of a store is not what was written there."""


class CacheWarning(UserWarning):
    """A broken entry of the result cache was moved to the folder `aside`."""


class ClusterError(HarnessError, OSError):
    """A cluster cannot be reached, or is not fit to run cases."""


@contextmanager
def writing(what: str, hint: str = "") -> Iterator[None]:
    """Turn an `OSError` within into an `OutputError` that says what cannot be written, and why.

    Parameters
    ----------
    what : str
        After "cannot write": the thing or the place.
    hint : str
        After the reason.

    Raises
    ------
    OutputError
        For an `OSError` within; a `HarnessError` within is raised as it is.
    """
    try:
        yield
    except HarnessError:
        raise
    except OSError as error:
        raise OutputError(f"cannot write {what}: {error.strerror or error}{hint}") from error
