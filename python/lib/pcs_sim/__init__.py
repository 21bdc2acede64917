"""Cycle-exact simulation of ray tracing on a linear array of PCS processors (INRIA RR-0992, 1989).

>>> import pcs_sim
>>> run = pcs_sim.run("room", mode="broadcast", cells=4, size="16x12")
>>> run.cycles > 0
True
"""

from ._native import (
    CellFault,
    CellProgram,
    Deadlock,
    InputError,
    Machine,
    Model,
    Picture,
    Program,
    Run,
    Scene,
    Sizes,
    Stepping,
    Table,
    Why,
    __version__,
    assemble,
    farm,
    image,
    ipsc2,
    model,
    parameters,
    replay,
    run,
    scenes,
    size_fifos,
    sweep,
    why,
)

__all__ = [
    "CellFault",
    "CellProgram",
    "Deadlock",
    "InputError",
    "Machine",
    "Model",
    "Picture",
    "Program",
    "Run",
    "Scene",
    "Sizes",
    "Stepping",
    "Table",
    "Why",
    "__version__",
    "assemble",
    "farm",
    "image",
    "ipsc2",
    "model",
    "parameters",
    "replay",
    "run",
    "scenes",
    "size_fifos",
    "sweep",
    "why",
]
