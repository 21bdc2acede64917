"""The simulator itself."""

from collections.abc import Iterable, Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import Any, final

import numpy as np
from numpy.typing import ArrayLike, NDArray
from typing_extensions import Unpack

from ._parameters import (
    CubeParameters,
    FarmParameters,
    ImageParameters,
    MachineChanges,
    MachineParameters,
    ModelParameters,
    RunParameters,
)
from ._types import CellState, Counts, Doing, FewColors, Graphs, Timelines, Wait

_Path = str | PathLike[str]
_Point = tuple[float, float, float]
_Words = _Path | Iterable[float]

__version__: str

class InputError(ValueError):
    """A mistake in an input: what is wrong, where, and what to do about it. Its text is the command's."""

    message: str
    """What is wrong."""
    help: str | None
    """What to do about it."""
    file: str | None
    """The file that it stands in."""
    line: int | None
    """Its line there, from 1."""
    column: int | None
    """Its column, from 1."""

class Deadlock(RuntimeError):
    """The array can go no further."""

    kind: str
    """"deadlock" if the waits form a loop, "starved" if the last one waits for what is never done."""
    waits: list[Wait]
    """The waits, each for the actor of the next one."""
    help: str
    """What to do about it."""

class CellFault(RuntimeError):
    """A cell's program cannot go on."""

    cell: int
    """The cell, from 0."""
    ray: int
    """The ray that it worked on."""
    address: int
    """The address of the instruction."""

@final
class Table:
    """A table in memory, by columns, which any library that knows Arrow takes without copies."""

    @property
    def columns(self) -> list[str]:
        """The names of the columns."""
    def __len__(self) -> int: ...
    def __getitem__(self, column: str, /) -> Any:
        """A column: a NumPy array of numbers (NaN where a number is missing), or a list."""
    def to_dict(self) -> dict[str, list[Any]]:
        """The columns as lists, by name, with None where there is no value."""
    def __arrow_c_stream__(self, requested_schema: object = None) -> object:
        """The table as a stream of Arrow data."""
    def __arrow_c_schema__(self) -> object:
        """What the columns hold, as an Arrow schema."""
    def _repr_html_(self) -> str: ...

@final
class Picture:
    """A picture, as SVG and as PNG. A notebook shows it."""

    @property
    def name(self) -> str:
        """What it shows, in a word."""
    @property
    def svg(self) -> str:
        """As SVG."""
    @property
    def png(self) -> bytes:
        """As PNG."""
    def save(self, path: _Path, *, force: bool = False) -> None:
        """Writes the picture: a name that ends in .svg, .png or .pdf says as what."""
    def _repr_png_(self) -> bytes: ...

@final
class Machine:
    """A machine: PCS, that of a file or of a dict, with changes."""

    def __new__(
        cls, machine: _Path | Mapping[str, Any] | Machine | None = None, **changes: Unpack[MachineChanges]
    ) -> Machine: ...
    def to_dict(self) -> dict[str, Any]:
        """What the machine's file has."""

@final
class Program:
    """An array program: a standard one by name, that of a file or of a dict."""

    def __new__(cls, program: _Path | Mapping[str, Any] | Program) -> Program: ...
    def to_dict(self) -> dict[str, Any]:
        """What the program's file has."""

@final
class Scene:
    """A scene of arrays.

    `points` are n x 3 numbers. `faces` are m x k numbers of points, from 0, or a list of such rows of any lengths;
    faces that are concave or not flat are cut into triangles. `colors` (n x 3, linear RGB) colour the points, `lights`
    (n x 3) are points of white light; `background` is black. The camera is at `eye` and looks at `at`; without, it
    frames the scene. `up` is the direction that is up in the image (z), `angle` the angle of view of its height, in
    degrees.
    """

    def __new__(
        cls,
        points: ArrayLike,
        faces: ArrayLike | Sequence[Sequence[int]],
        *,
        colors: ArrayLike | None = None,
        lights: ArrayLike | None = None,
        background: _Point = ...,
        eye: _Point | None = None,
        at: _Point | None = None,
        up: _Point = ...,
        angle: float = 40.0,
        name: str = "scene",
    ) -> Scene: ...
    @property
    def name(self) -> str:
        """What it is called."""
    @property
    def notes(self) -> list[str]:
        """What reading the arrays changed, one sentence each."""
    @property
    def polygons(self) -> int:
        """How many polygons it has."""

@final
class Run:
    """A run that is over: of primary rays, of a whole image, of a recorded trace, or of a farm.

    What a run over time looked like (`timelines`, `plot`, `page`) is found out when it is first asked for: by running
    it again under a probe, which changes nothing.
    """

    @property
    def cycles(self) -> int:
        """Simulated time, in cycles."""
    @property
    def seconds(self) -> float:
        """Simulated time, in seconds."""
    @property
    def rays(self) -> int:
        """How many rays the host sent."""
    @property
    def rays_per_second(self) -> float:
        """Rays a second of simulated time."""
    @property
    def bottleneck(self) -> str:
        """One sentence on what limits the machine."""
    @property
    def counts(self) -> Counts:
        """How often the kernels did their work. A replay has none."""
    @property
    def cells(self) -> Table:
        """Where every cell's cycles went: a row a cell, a column a state. A cell's states sum to the run's cycles."""
    @property
    def fifos(self) -> Table:
        """What every FIFO held: a row a FIFO.

        `capacity`, `words` (through it), `max` and `mean` are in words; `full` and `empty` are shares of the run. Asked
        for by `enough`, that is the depth from which nothing changes any more, in words.
        """
    @property
    def hits(self) -> NDArray[np.void]:
        """Each ray's first hit, in the order of the rays' numbers (of pixels, line by line).

        Those of an image are in the order in which the host sent the rays. A structured array of `t` (inf on a miss),
        `polygon` (the number of the scene's face, -1 on a miss), `alpha` and `beta`. A replay has none.
        """
    @property
    def image(self) -> NDArray[np.float32] | None:
        """The picture: height x width x 3, linear light, line by line from the top left.

        None if the rays are no camera's.
        """
    def few_colors(self, colors: int, palette: str | None = None) -> FewColors:
        """The picture in so many `colors` at the most, from 1 to 65536.

        They are chosen by a `palette`: peano (the default), peano-large, fixed, popularity, median-cut or gervautz.
        """
    @property
    def timelines(self) -> Timelines:
        """The run over time."""
    def graphs(self, *, of: str = "regions", pixels: tuple[tuple[int, int], tuple[int, int]] | None = None) -> Graphs:
        """The graphs of the run, as `--graphs` writes them to JSON.

        `of` is what G_r has beside the scene's parts: regions (nothing), objects or polygons. With `pixels`, the
        columns and the lines from the first to before the last as ((10, 20), (40, 44)), G_v has each ray of these.
        They are found out by running it again. A replay and a farm have none.
        """
    @property
    def stats(self) -> dict[str, Any]:
        """All statistics: what `--stats` writes."""
    @property
    def config(self) -> dict[str, Any]:
        """What was run, with every default filled in: `config=` repeats it."""
    @property
    def notes(self) -> list[str]:
        """What the user should know: what had to be rounded, cut or assumed."""
    def plots(self) -> dict[str, Picture]:
        """All pictures of the run over time, by name."""
    def plot(self, name: str | None = None) -> Picture:
        """A picture of the run over time: `cells`, `fifos`, `fifo-histograms`, `rays` or `latency`.

        The first, or of a farm `tasks`, if none is named. Of many FIFOs there is one for each channel: `fifos-x`, ...
        """
    def page(self) -> str:
        """The page that shows the run in a browser, as HTML."""
    def save(
        self,
        *,
        stats: _Path | None = None,
        hits: _Path | None = None,
        image: _Path | None = None,
        colors: int | None = None,
        palette: str | None = None,
        page: _Path | None = None,
        plot: _Path | None = None,
        trace: _Path | None = None,
        trace_window: tuple[int, int] | None = None,
        force: bool = False,
    ) -> list[Path]:
        """Writes results as the command does, and gives the files that it wrote.

        `colors` writes the picture in so many at the most, chosen by a `palette`, as `few_colors` has it.

        Statistics, hits, the picture, the page, a folder of plots, a trace for viewers (.pftrace, .vcd, .fst) of the
        cycles from `trace_window[0]` to before `trace_window[1]`. Files that exist are replaced only with `force`.
        """
    def _repr_html_(self) -> str: ...

@final
class Model:
    """What the cost model says of a run, and whether it is right."""

    @property
    def quantities(self) -> Table:
        """The quantities, a row each: by the `paper`'s formulas, by the `model`, as `counted` and as `measured`.

        `error` is by which share the model is above what was measured, or else counted.
        """
    @property
    def stats(self) -> dict[str, Any]:
        """What `pcs-sim model --stats` writes."""
    @property
    def notes(self) -> list[str]:
        """What the user should know: what had to be rounded, cut or assumed."""
    def save(self, stats: _Path, *, force: bool = False) -> None:
        """Writes the statistics."""
    def _repr_html_(self) -> str: ...

@final
class CellProgram:
    """A cell's program, assembled."""

    @property
    def object(self) -> str:
        """The object file's text."""
    @property
    def listing(self) -> str:
        """Addresses, words, source lines, and cycles of instructions and loops."""
    @property
    def disassembly(self) -> str:
        """Source text that assembles to the same words."""
    def save(self, *, object: _Path | None = None, listing: _Path | None = None, force: bool = False) -> list[Path]:
        """Writes the object file, the listing."""
    def step(
        self,
        x: _Words | None = None,
        y: _Words | None = None,
        *,
        instructions: int | None = None,
        instruction_limit: int | None = None,
    ) -> CellState:
        """Runs the program on words that come on X and Y.

        Words are integers, floating-point numbers, or a file as `pcs-sim step` takes it. It goes on from message to
        message until it halts, wants a word where no more come, or has executed so many `instructions`.
        """
    def start(
        self, x: _Words | None = None, y: _Words | None = None, *, instruction_limit: int | None = None
    ) -> Stepping:
        """Begins to run the program on words, an instruction at a time."""

@final
class Stepping:
    """A cell's program under way, an instruction at a time, on words that may come later.

    `CellProgram.start` makes it. What a cell does depends on its words alone, so all that is kept is how far it is:
    each call runs the program from its start to there.
    """

    def step(self, instructions: int = 1) -> CellState:
        """Executes so many instructions, or fewer if the cell then stands still or comes to a breakpoint.

        Gives what `CellProgram.step` does; `stopped` may also be "done" (with a message) and "breakpoint".
        """
    def run(self) -> CellState:
        """Goes on to a breakpoint, or until the cell stands still.

        It does when it is done with a message, has halted, or is without a word that it wants.
        """
    def feed(self, x: _Words | None = None, y: _Words | None = None) -> None:
        """Lets more words come on X and Y."""
    def break_at(self, *places: int | str) -> None:
        """Sets breakpoints, in place of those that were set.

        They are addresses, labels, or lines of the program's own file as texts.
        """
    @property
    def state(self) -> CellState:
        """What the cell is at now, without executing anything."""

@final
class Why:
    """Why a run took as long as it did: its critical path, or what happened in one moment of it."""

    @property
    def run(self) -> Run:
        """The run: its statistics, plots and page have the critical path, too."""
    @property
    def cycles(self) -> int:
        """The length of the run and of the path, in cycles."""
    @property
    def sentence(self) -> str:
        """What the path is made of, for the most part."""
    @property
    def times(self) -> Table:
        """The machine's times on the path, the longest first.

        The `time`, the cell that it is `at` (with `by_cell`), `count` (how often it lies there, so by how many cycles
        the run gets shorter if it does by one), `each` in cycles, `cycles` of all, and whether it `varies` from machine
        to machine.
        """
    @property
    def parts(self) -> Table:
        """The parts of the path by place and cause.

        Who it is `at`, the `cause`, the `fifo` if it is about one, `count`, `cycles`, and the `share` of the run. The
        cycles sum to the run.
        """
    @property
    def waits(self) -> list[Doing] | None:
        """Who waits for whom in the moment that was asked for, down to one that does not wait. None without one."""
    def _repr_html_(self) -> str: ...

@final
class Sizes:
    """The fewest words that the FIFOs of a run need for each speed."""

    @property
    def table(self) -> Table:
        """What was found, as the command writes it.

        A row for the unlimited depths, for each speed, for each of its FIFOs with a word fewer, and for the least
        machine.
        """
    @property
    def replays(self) -> int:
        """How often the recording was timed."""
    def words(self, speed: float) -> dict[str, int]:
        """The depths of the FIFOs for a speed, by their names."""
    def machine(self, speed: float) -> Machine:
        """The machine for a speed."""
    def plots(self) -> dict[str, Picture]:
        """Pictures.

        `front` is the speed over the words of all FIFOs, `depths` that of each FIFO for each speed.
        """
    def save(self, table: _Path, *, plot: bool = False, machines: bool = False, force: bool = False) -> list[Path]:
        """Writes the table, as CSV and as Parquet, and beside it the pictures and the machine of each speed.

        Gives the files that it wrote.
        """
    def _repr_html_(self) -> str: ...

def assemble(file: _Path, *, machine: _Path | Mapping[str, Any] | Machine | None = None) -> CellProgram:
    """Assembles a cell's program: source text, or an object file. `machine` says what instructions cost."""

def run(
    scene: _Path | Scene | None = None,
    *,
    config: _Path | Mapping[str, Any] | Run | None = None,
    ops: _Path | None = None,
    ops_form: str = "units",
    why: bool = False,
    enough: bool = False,
    force: bool = False,
    threads: int | None = None,
    progress: bool | None = None,
    **parameters: Unpack[RunParameters],
) -> Run:
    """Runs a scene's primary rays on the array.

    Takes every parameter of the command, by the name of its flag with underscores (`pcs_sim.parameters()` lists them);
    what is left out is as the command has it. `scene` is a built-in scene, a file or a `Scene`; `rays` a file or an
    array; `machine` and `program` a file, a dict, or a `Machine` or `Program`. `config` is a run to be repeated, with
    changes: a file of statistics, `Run.stats`, or a `Run`. `ops` names a file for what every cell did, for `replay`.
    `why` and `enough` add to text, statistics, plots and page what the command's flags of these names do.
    """

def image(
    scene: _Path | Scene | None = None,
    *,
    config: _Path | Mapping[str, Any] | Run | None = None,
    ops: _Path | None = None,
    ops_form: str = "units",
    why: bool = False,
    enough: bool = False,
    force: bool = False,
    threads: int | None = None,
    progress: bool | None = None,
    **parameters: Unpack[ImageParameters],
) -> Run:
    """Makes a whole image: the host shades the hits and sends shadow, reflected and refracted rays.

    Takes the parameters of `run`, but for `rays`, and those of light and host (`samples`, `depth`, `timing`, ...).
    """

def farm(
    scene: _Path | None = None,
    *,
    config: _Path | Mapping[str, Any] | Run | None = None,
    why: bool = False,
    threads: int | None = None,
    progress: bool | None = None,
    **parameters: Unpack[FarmParameters],
) -> Run:
    """Runs a farm: a master and workers that share an image, on CAPITAN.

    Takes the parameters of farms, by the names of the flags of `pcs-sim farm`; `tasks` is a number of workers (`sweep`
    makes tables of many). `config` is a farm to be repeated. `why` adds the critical path to what is seen and saved.
    """

def ipsc2(
    scene: _Path | None = None,
    *,
    config: _Path | Mapping[str, Any] | Run | None = None,
    why: bool = False,
    threads: int | None = None,
    progress: bool | None = None,
    **parameters: Unpack[CubeParameters],
) -> Run:
    """Makes an image on the nodes of an iPSC/2, a hypercube.

    Takes the parameters by the names of the flags of `pcs-sim ipsc2`. `config` is an image to be made again. `why` adds
    the critical path to what is seen and saved.
    """

def replay(
    ops: _Path | None = None,
    *,
    config: _Path | Mapping[str, Any] | Run | None = None,
    why: bool = False,
    enough: bool = False,
    progress: bool | None = None,
    **parameters: Unpack[MachineParameters],
) -> Run:
    """Times a recorded activity trace again, under any machine, without its scene.

    `ops` is a file that `run(ops=...)` or the command's `--ops` wrote. Takes the parameters of the machine; `config` is
    a replay to be repeated.
    """

def model(
    scene: _Path | Scene | None = None,
    *,
    config: _Path | Mapping[str, Any] | Run | None = None,
    predict_only: bool = False,
    threads: int | None = None,
    progress: bool | None = None,
    **parameters: Unpack[ModelParameters],
) -> Model:
    """Predicts a run by the paper's cost model, and holds the prediction against the run.

    Takes the parameters of `run`, but for those of cells that run programs. With `predict_only` nothing is simulated:
    seconds where the simulation may take minutes.
    """

def why(
    scene: _Path | Scene | None = None,
    *,
    ops: _Path | None = None,
    config: _Path | Mapping[str, Any] | Run | None = None,
    by_cell: bool = False,
    cell: int | str | None = None,
    at: int | str | None = None,
    ray: int | None = None,
    enough: bool = False,
    threads: int | None = None,
    progress: bool | None = None,
    **parameters: Unpack[RunParameters],
) -> Why:
    """Finds out why a run, or a recorded trace, took as long as it did.

    Takes the parameters of `run`; or `ops`, a recorded trace to be timed again, and those of the machine. `by_cell`
    tells the times of each cell by themselves. With `cell` (a number, or "host") it is about one moment, and who then
    waits for whom: `at` a cycle or a time as "12.3ms", or in the middle of the longest wait of the cell while it is at
    a `ray`.
    """

def size_fifos(
    scene: _Path | Scene | None = None,
    *,
    ops: _Path | None = None,
    config: _Path | Mapping[str, Any] | Run | None = None,
    speed: float | Sequence[float] | None = None,
    progress: bool | None = None,
    **parameters: Unpack[RunParameters],
) -> Sizes:
    """Finds the fewest words that the FIFOs of a run, or of a recorded trace, need for some speeds.

    Takes the parameters of `run`, but for the FIFOs' depths; or `ops`, a recorded trace, and parameters of the machine.
    `speed` is a percentage of the speed with unlimited FIFOs, or several (100, 99.9, 99, 95 and 90).
    """

def sweep(
    sweep: _Path | Mapping[str, Any],
    *,
    table: _Path | None = None,
    force: bool = False,
    threads: int | None = None,
    recording_memory: str | None = None,
    progress: bool | None = None,
) -> Table:
    """Runs every combination of parameters, and gives one table: a row a run, the parameters first.

    `sweep` is a file as `pcs-sim sweep` takes it, or a dict: for each parameter a value, a list of values, or a range
    as {"from": 1, "to": 64, "times": 2}. With `table` the rows go to TABLE.csv and TABLE.parquet as points finish, and
    a sweep that was stopped goes on where it was; one that is done is not run again. A point that fails says why in
    the column `error`. `recording_memory` is the memory that a recording may take, which points share, such as "8GB";
    points of a larger one are timed while its rays are traced.
    """

def parameters() -> Table:
    """The parameters.

    `name`, `kind` (text, size, truth, whole, whole or word, number), what it is (`label`, with its unit), for each call
    whether it takes it (`run`, `image`, `replay`, `model`, `farm`, `ipsc2`), and whether it is one of a `machine`.
    """

def scenes() -> Table:
    """The built-in scenes.

    `name`, the default `size_factor`, how many `polygons` they then have, and what they show (`about`).
    """
