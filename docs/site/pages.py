"""The pages of the site that are made: from results, and from the public names of the library."""

import inspect
from importlib import import_module

from docs.formatting import ROOT
from docs.site.boards import cases_html, leaderboard_page, top
from docs.site.engine_pages import engine_index, engine_names, engine_page, reference_page
from docs.site.sources import ELSEWHERE

TRIALS = {
    "reports/faults.md": "what must not lose work: kills, full disks, lost workers",
    "reports/fuzz.md": "damaged scene files, each answered with one clear sentence",
    "reports/hostile.md": "releases beside separatrices and steady motions, to sixty digits",
    "reports/onsets.md": "where slip begins, over random cans",
    "reports/mutation.md": "what the tests would not notice if it changed",
}
"""Pages that programs of the tests wrote, with what they tried."""

ROWS = 5
"""Of the leaderboard, on the first page."""

PUBLIC = {
    "harness": "The library",
    "harness.engines": "For adapters",
    "models": "Scenes",
}
"""Modules whose public names have an entry in the API page."""


def pages() -> dict[str, str]:
    """Return the made pages by their place, with links as if from `docs`."""
    return {
        "index.md": first_page(),
        "api.md": api_page(),
        "engines/README.md": engine_index(),
        "engines/reference.md": reference_page(),
        **{f"engines/{name}.md": engine_page(name, cases_html(name)) for name in engine_names()},
        "leaderboard.md": leaderboard_page(),
        "trials/README.md": trials_page(),
    }


def first_page() -> str:
    """Return the first page, with the top of the leaderboard in its place."""
    text = (ROOT / "docs" / "index.md").read_text(encoding="utf-8")
    if not (ROOT / "docs" / "history.md").is_file():
        text = text.replace("\nhistory\n", "\n")
    return text.replace("<!-- leaderboard -->", top(ROWS))


def trials_page() -> str:
    """Return the page that leads to the trials."""
    lines = [f"- [{told[:1].upper()}{told[1:]}](../{path})" for path, told in TRIALS.items()]
    names = [ELSEWHERE[path].removeprefix("trials/").removesuffix(".md") for path in TRIALS]
    return "\n".join(
        [
            "# Trials",
            "",
            "What was tried on the program itself; each page names the command that wrote it.",
            "",
            *lines,
            "",
            "```{toctree}",
            ":hidden:",
            "",
            *names,
            "```",
            "",
        ]
    )


def api_page() -> str:
    """Return the reference of the public names, made from their docstrings."""
    parts = [
        "# API",
        "",
        "The public names of the library. An adapter imports all that it needs from",
        "`harness.engines`, and that path stays.",
        "",
    ]
    told = set[int]()
    for path, title in PUBLIC.items():
        module = import_module(path)
        public = {name: getattr(module, name) for name in module.__all__}
        data = [name for name, value in public.items() if not _directive(value)]
        parts += [f"## {title}: `{path}`", "", "```{eval-rst}", f".. currentmodule:: {path}", ""]
        for name, value in public.items():
            if id(value) not in told and (directive := _directive(value)):
                parts += [f".. {directive}:: {name}", ""]
        parts += ["```", ""]
        if again := [name for name, value in public.items() if id(value) in told]:
            parts += [f"From here too, as above: {_listed(again)}.", ""]
        if data:
            parts += [f"Constants and types: {_listed(data)}.", ""]
        told |= {id(value) for name, value in public.items() if name not in data}
    return "\n".join(parts)


def _listed(names: list[str]) -> str:
    return ", ".join(f"`{name}`" for name in names)


def _directive(value: object) -> str:
    """Return the directive that documents a value; empty of one that has no docstring."""
    if inspect.isclass(value):
        return "autoclass"
    return "autofunction" if inspect.isroutine(value) else ""
