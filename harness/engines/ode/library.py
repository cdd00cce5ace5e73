"""The library of ODE, which the operating system has, and its binding, which pip installs.

The binding `odepy` holds no part of ODE. It looks for the library when it is imported, prints what
an old build does not have, and takes the numbers for doubles, whatever the library was built with.
"""

import io
import os
from contextlib import redirect_stdout
from ctypes import CFUNCTYPE, c_char_p, c_int, c_void_p
from functools import cache
from pathlib import Path
from typing import Any

import psutil

from harness.engines import MissingLibraryError

_INSTALL = "apt install libode8, or what the system calls the library of ODE in double precision"
_DOUBLE = "ODE_double_precision"


unsaid = CFUNCTYPE(None, c_int, c_char_p, c_void_p)(lambda *_: None)
"""Takes the messages of ODE, which would go to standard error: numbers that break are
an outcome."""


def _library() -> Any:  # noqa: ANN401 - the binding has no types
    """Return the binding, with ODE initialised.

    Raises
    ------
    MissingLibraryError
        If there is no library, or one in single precision.
    """
    kept = dict(os.environ)
    try:
        with redirect_stdout(io.StringIO()):  # where results are printed
            import odepy  # noqa: PLC0415 - with what it prints and sets
    except ImportError:
        raise
    except Exception as error:
        raise MissingLibraryError("engine 'ode'", "libode", str(error), _INSTALL) from error
    finally:
        os.environ.clear()  # the binding leaves paths of its own
        os.environ.update(kept)
    build = odepy.loadOde("dGetConfiguration", c_char_p)().decode().split()
    if _DOUBLE not in build:
        reason = f"it is not built with {_DOUBLE}, but as {' '.join(build)}"
        raise MissingLibraryError("engine 'ode'", "libode", reason, _INSTALL)
    odepy.dInitODE2(0)
    odepy.loadOde("dSetMessageHandler", None)(unsaid)
    return odepy


ode = _library()
"""The binding: every function by its name in ODE."""


@cache
def library_version() -> str:
    """Return the version in the name of the library's file, such as "8.0.2" of ODE 0.16.2.

    ODE tells none itself.
    """
    loaded = (Path(each.path) for each in psutil.Process().memory_maps())
    name = next(path.name for path in loaded if path.name.startswith("libode"))
    return name.partition(".so.")[2] or name
