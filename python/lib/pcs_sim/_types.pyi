"""Dicts that the simulator gives. They are dicts and no more; these names are for type checkers."""

from typing import Any, TypedDict

import numpy as np
from numpy.typing import NDArray

_For = TypedDict("_For", {"for": str})

class Wait(_For):
    """One wait of a standstill. `for` is "word", "room", "return" or "nothing"."""

    actor: str
    """Who waits: "cell 3", "the host"."""
    on: str
    """For whom."""
    channel: str | None
    """The channel of the FIFO that it stands at: X, Y or Z."""
    capacity: int | None
    """Words that the FIFO holds."""
    since: int
    """The cycle since when."""
    op: str
    """The op that waits."""
    moved: int
    """How many of the op's words have been moved."""
    ray: int
    """The ray whose op it is."""
    position: int
    """The op's place in what the actor does for the ray, from 0."""
    text: str
    """All of it, as a sentence."""

class FewColors(TypedDict):
    """A picture of few colours, and how far they are off, in steps of 255."""

    colors: NDArray[np.uint8]
    """The table: n x 3, red, green and blue as a screen has them."""
    pixels: NDArray[np.uint16]
    """The place in it of each pixel's colour: height x width."""
    mean_square: float
    """The mean of the squares of a pixel's distance from its colour."""
    largest: float
    """The largest distance."""
    bound: float | None
    """The most that any colour can be off, of an octree."""

class Graphs(TypedDict):
    """The graphs of a run: vertices and edges, each as `networkx.node_link_graph(graph, edges="edges")` takes it."""

    G_r: dict[str, Any]
    """The scene's parts."""
    G_v: dict[str, Any]
    """The rays."""
    G_p: dict[str, Any]
    """The processes."""
    classification: dict[str, Any]
    """What was known of them before the run."""

class Counts(TypedDict):
    """How often the kernels did their work."""

    voxels: int
    slab_tests: int
    intersection_tests: int
    hits: int

class FifoLevels(TypedDict):
    """What every FIFO held in each bin (FIFOs x bins): words, and the cycles at whose end it was full."""

    min: NDArray[np.uint64]
    max: NDArray[np.uint64]
    mean: NDArray[np.float64]
    full: NDArray[np.uint64]

class Timelines(TypedDict):
    """A run over time, cut into bins."""

    bin: int
    """Width of a bin, in cycles."""
    start: NDArray[np.uint64]
    """The first cycle of each bin."""
    cells: dict[str, NDArray[np.uint64]]
    """For each state, the cycles of every cell in it (cells x bins)."""
    fifos: FifoLevels
    """What every FIFO held."""
    rays: NDArray[np.uint64]
    """How many answers came back in each bin."""

class Doing(TypedDict):
    """What somebody does in one cycle."""

    actor: str
    """Who it is: "cell 3", "the host"."""
    does: str
    """ "works", "moves", "waits" or "done"."""
    fifo: str | None
    """The FIFO that it waits at."""
    ray: int | None
    """The ray that it is for."""
    since: int
    """The cycle since when."""
    until: int
    """The first cycle after it."""
    text: str
    """All of it, as a sentence."""

class CellState(TypedDict):
    """A cell that has run a program."""

    stopped: str | None
    """Why it stands still: "halted", or "x" or "y" for a word from there; None if it does not.

    Of a program that is run an instruction at a time also "done" (with a message) and "breakpoint".
    """
    messages: int
    """Messages that are done."""
    executed: int
    """Instructions that it executed."""
    cycles: int
    """Cycles that the last message took, if no word was waited for."""
    address: int
    """The next instruction."""
    x_read: int
    """How many words of X it read."""
    y_read: int
    """How many words of Y it read."""
    x_out: NDArray[np.uint32]
    """What it wrote to the right neighbour's X."""
    y_out: NDArray[np.uint32]
    """What it wrote to the right neighbour's Y."""
    registers: dict[str, int]
    """The registers that are not 0."""
    data: NDArray[np.uint32]
    """Its data memory."""
