"""The command, to hold the module against, and what several tests use."""

from __future__ import annotations

import os
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[2]
"""The repository."""

COMMAND = os.environ.get("PCS_SIM", str(ROOT / "target" / "release" / "pcs-sim"))
"""The command's program, as `cargo build --release` leaves it."""

LOOP = "0 host w8\n0 0 r8 o600 w8\n0 1 r8 i600 o5\n"
"""Ops of two cells that wait for each other: the first sends more than a FIFO holds before the ray for the second."""


@dataclass
class Ended:
    """A command that has ended."""

    status: int
    out: str
    err: str


def command(folder: Path, *arguments: str) -> Ended:
    """Runs the command in a folder."""
    ended = subprocess.run([COMMAND, *arguments], cwd=folder, capture_output=True, text=True, check=False)
    return Ended(ended.returncode, ended.stdout, ended.stderr)


def flags(parameters: dict[str, Any]) -> list[str]:
    """The flags that say the same as keywords."""
    said = []
    for name, value in parameters.items():
        flag = "--" + name.replace("_", "-")
        said += [flag] if value is True else [flag, str(value)]
    return said


def words(text: str) -> str:
    """A text without what a drawing of it adds: lines, margins, and places."""
    return " ".join(text.replace("|", " ").split())
