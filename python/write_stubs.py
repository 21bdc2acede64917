"""Writes lib/pcs_sim/_parameters.pyi, the parameters' types, from what the module says that there are.

A parameter that is new to the simulator is taken at once; for type checkers to know it, run this.
"""

from collections.abc import Iterable
from pathlib import Path

import pcs_sim

TYPES = {
    "text": "str",
    "size": "str | int | tuple[int, int]",
    "truth": "bool",
    "whole": "int",
    "whole or word": "int | str",
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
    rows = dict(zip(table["name"], zip(table["name"], table["kind"], table["label"])))

    def of(call: str, *, without: Iterable[str] = ()) -> list[tuple[str, str, str]]:
        taken = {name for name, is_taken in zip(table["name"], table[call]) if is_taken}
        return [row for name, row in rows.items() if name in taken and name not in {"scene", *without}]

    machine = [row[0] for row in of("machine")]
    base = "MachineParameters, total=False"
    return (
        HEADING
        + group(
            "MachineChanges",
            "TypedDict, total=False",
            "Changes to a machine.",
            of("machine", without=["on", "machine"]),
        )
        + group(
            "MachineParameters",
            "MachineChanges, total=False",
            "A machine, and changes to it.",
            [rows["on"], rows["machine"]],
        )
        + group("RunParameters", base, "Parameters of a run of primary rays.", of("run", without=machine))
        + group("ImageParameters", base, "Parameters of a whole image.", of("image", without=machine))
        + group("ModelParameters", base, "Parameters of a prediction.", of("model", without=machine))
        + group("FarmParameters", "TypedDict, total=False", "Parameters of a farm.", of("farm"))
        + group("CubeParameters", "TypedDict, total=False", "Parameters of an image on a hypercube.", of("ipsc2"))
    )


if __name__ == "__main__":
    Path(__file__).parent.joinpath("lib", "pcs_sim", "_parameters.pyi").write_text(text(), encoding="utf-8")
