"""Whole messages of errors of engines: that fall, and that live in interpreters of their own."""

from pathlib import Path

from harness.core.environments import EnvironmentFileError
from harness.core.errors import EngineContractError, ReservedNameError
from harness.engines.make_environment import UnmadeEnvironmentError
from harness.engines.new_environment import UnknownEnvironmentError
from harness.engines.remote import BrokenEnvironmentError, OtherProgramError, WorldElsewhereError
from harness.execution.dask_cluster import NoEnvironmentError
from harness.records.columns import RecordFileError
from harness.studies.comparison.rim import NoMeshError

OF_ENGINES: list[tuple[Exception, str]] = [
    (RecordFileError(Path("m.csv"), "has no\nx_m"), "'m.csv': has no x_m"),
    (
        NoMeshError("e"),
        "engine 'e' takes no mesh: engines with a setting 'mesh' do (see: rockingcan engines NAME)",
    ),
    (
        EngineContractError("e", "one case", "it returned str"),
        (
            "engine 'e' falls when it is asked for the timestep of the case 'one case' (it "
            "returned str); leave it out with --engine, or mend its adapter"
        ),
    ),
    (
        ReservedNameError("list", "mine:Engine"),
        (
            "no engine can be called 'list', which is a word of the command line; "
            "register 'mine:Engine' under another name"
        ),
    ),
    (
        EnvironmentFileError(Path("engines/mine.json"), "it is empty"),
        (
            "'engines/mine.json' describes no environment of an engine (it is empty); run: "
            "rockingcan engines remove mine, and add it again"
        ),
    ),
    (
        BrokenEnvironmentError("mine", "no such\nfile", "rockingcan engines add mujoco"),
        (
            "the environment of engine 'mine' is broken (no such file); to make it again, run: "
            "rockingcan engines remove mine && rockingcan engines add mujoco"
        ),
    ),
    (
        OtherProgramError("mine", "a, and here b", ""),
        (
            "the worker of engine 'mine' is of another version of the program than this process "
            "(sources a, and here b): they were edited meanwhile; start the program again"
        ),
    ),
    (
        UnmadeEnvironmentError("mujoco", "pip cannot"),
        "no environment is made for engine 'mujoco': pip cannot",
    ),
    (
        UnknownEnvironmentError("mine", ["mine2"]),
        "no engine 'mine' lives in an environment, did you mean 'mine2'? there are: mine2",
    ),
    (
        WorldElsewhereError("mine"),
        (
            "engine 'mine' lives in an interpreter of its own, which its worlds cannot leave: call "
            "what needs one there, by `call_at_engine`"
        ),
    ),
    (
        NoEnvironmentError(node="n", engine="mine"),
        (
            "a worker on 'n' has no environment of engine 'mine'; add it there as here (see: "
            "rockingcan engines list --json), or leave the engine out with --engine"
        ),
    ),
]
