"""Writes lib/pcs_sim/_parameters.pyi, the parameters' types, from what the module says that there are.

A parameter that is new to the simulator is taken at once; for type checkers to know it, run this.
"""

from pathlib import Path

import pcs_sim

TYPES = {
    "text": "str",
    "size": "str | int | tuple[int, int]",
    "truth": "bool",
    "whole": "int",
    "number": "float",
}

SPECIAL = {
    "rays": "str | PathLike[str] | ArrayLike",
    "program": "str | PathLike[str] | Mapping[str, Any] | Program",
    "machine": "str | PathLike[str] | Mapping[str, Any] | Machine",
    "cell_programs": "str | PathLike[str]",
}

HEADING = '''"""The parameters of runs. Written by write_stubs.py."""

from collections.abc import Mapping
from os import PathLike
from typing import Any, TypedDict

from numpy.typing import ArrayLike

from ._native import Machine, Program
'''


def group(name: str, base: str, about: str, rows: list[tuple[str, str, str]]) -> str:
    """The declaration of some parameters, each with what it is."""
    lines = [f'\nclass {name}({base}):\n    """{about}"""\n']
    for parameter, kind, label in rows:
        lines.append(
            f'    {parameter}: {SPECIAL.get(parameter, TYPES[kind])} | None\n    """{label[0].upper()}{label[1:]}."""\n'
        )
    return "\n".join(lines)


def text() -> str:
    """The whole file."""
    table = pcs_sim.parameters().to_dict()
    rows = list(zip(table["name"], table["kind"], table["label"], table["of"]))

    def of(*groups: str) -> list[tuple[str, str, str]]:
        return [row[:3] for row in rows if row[3] in groups and row[0] != "scene"]

    machine = [row for row in of("machine") if row[0] == "machine"]
    changes = [row for row in of("machine") if row[0] != "machine"]
    return (
        HEADING
        + group("MachineChanges", "TypedDict, total=False", "Changes to a machine.", changes)
        + group("MachineParameters", "MachineChanges, total=False", "A machine, and changes to it.", machine)
        + group("ModelParameters", "MachineParameters, total=False", "Parameters of a prediction.", of("run", "rays"))
        + group("RunParameters", "ModelParameters, total=False", "Parameters of a run of primary rays.", of("cells"))
        + group(
            "ImageParameters",
            "MachineParameters, total=False",
            "Parameters of a whole image.",
            of("run", "cells", "image"),
        )
    )


if __name__ == "__main__":
    Path(__file__).parent.joinpath("lib", "pcs_sim", "_parameters.pyi").write_text(text(), encoding="utf-8")
