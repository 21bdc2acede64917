"""What is easier said in Python: bars, JSON of any numbers, and a little HTML."""

from __future__ import annotations

import html
import json
import os
import sys
from typing import Any


class _Bar:
    """A bar of tqdm's that is told how far the work is, not how much more was done."""

    def __init__(self, bar: Any) -> None:
        self._bar = bar

    def show(self, done: int, of: int) -> None:
        """So much is done of so much."""
        self._bar.total = of
        self._bar.update(done - self._bar.n)

    def close(self) -> None:
        """Takes the bar away."""
        self._bar.close()


def _is_watched() -> bool:
    """Whether somebody looks: on a terminal, or in a notebook."""
    shell = getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)()
    return sys.stderr.isatty() or hasattr(shell, "kernel")


def bar(of: int, unit: str, wanted: bool | None) -> _Bar | None:
    """A progress bar, if somebody looks at it (or wants one in any case) and tqdm is there."""
    if not (wanted or _is_watched()):
        return None
    try:
        from tqdm.auto import tqdm
    except ImportError:
        return None
    return _Bar(tqdm(total=of, unit=f" {unit}", leave=False))


def _plain(value: object) -> object:
    """A value as JSON knows it: NumPy's arrays and numbers, ranges, paths."""
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, range):
        return list(value)
    if hasattr(value, "to_dict"):
        return value.to_dict()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    raise TypeError(f"expected a text, a number, True, False, a list or a dict, not {value!r}")


def to_json(value: object) -> str:
    """A value as JSON."""
    return json.dumps(value, default=_plain, allow_nan=False)


def html_text(text: str, picture: str | None = None) -> str:
    """A text as it stands, and a picture (SVG) below it."""
    return f"<pre>{html.escape(text)}</pre>{picture or ''}"


_MOST_ROWS = 20
"""Rows of a table that a notebook shows."""


def html_table(columns: dict[str, list[object]]) -> str:
    """The first rows of a table."""

    def cells(tag: str, values: list[object]) -> str:
        return "".join(f"<{tag}>{'' if value is None else html.escape(str(value))}</{tag}>" for value in values)

    rows = list(zip(*columns.values()))
    body = "".join(f"<tr>{cells('td', list(row))}</tr>" for row in rows[:_MOST_ROWS])
    more = f"<p>{len(rows)} rows</p>" if len(rows) > _MOST_ROWS else ""
    return f"<table><thead><tr>{cells('th', list(columns))}</tr></thead><tbody>{body}</tbody></table>{more}"
