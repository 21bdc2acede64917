#!/usr/bin/env python3
"""Tells whether two binaries of pcs-sim write the same bytes.

    tests/same_bytes.py OLD NEW [FILTER]      for all cases, or for those with FILTER in their names
    tests/same_bytes.py --list [FILTER]       lists the cases with their commands

Each case is a list of commands in an empty folder. All that both binaries print and write is compared byte for byte;
only the object `configuration` of statistics is left out. A line is printed for each file that differs, with the first
place where it does. The exit status is 1 if anything differs that ALLOWED does not name.

The inputs (machine files, cells' programs, scenes, sweeps) are those of the commit INPUTS, whatever the working tree
has: what was once read must be read still. A binary that knows `--ops-form` is asked for ops in priced cycles, the form
of those that do not.
"""

import fnmatch
import re
import shlex
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

INPUTS = "018386ab4b25f0198430d04a0f87f383ea2970c2"
PROCESSES = 2
TIMEOUT_S = 300


@dataclass
class Allowed:
    """A difference that is meant: in these files of these cases (patterns as a shell has them), and why.

    With `lines`, only lines in which this expression is found may differ, come or go; with `layout`, only spaces and the ends
    of lines; without, the whole file may. A file may have several such differences.
    """

    cases: str
    files: str
    why: str
    lines: str | None = None
    layout: bool = False


PLOTS_OF_TABLES = "no point of a plot is an average; titles, captions and sizes of plots are others"

ALLOWED = [
    Allowed("*", "*: stdout", "prose and tables fit 80 columns", layout=True),
    Allowed("cells/*", "*.lst", "listings fit 80 columns", layout=True),
    Allowed("*", "*.json", "a ray's latency begins with its first word", r'^ {8}"(min|mean|p50|p90|p99|max)": '),
    Allowed("*", "*: stdout", "a ray's latency begins with its first word, and has a table of its own",
            "^rays +number|^latency +min|^(primary|shadow|reflected|refracted) "),
    Allowed("*", "*: stdout", "a name in the model's table is wrapped",
            r"^cycles a ray, busiest|^(grid\+slabs\+intersection )?cell$"),
    Allowed("*", "*: stdout", "units stand above columns", "^Figure 7|^(grid|slabs|intersection), (start|a )"),
    Allowed("help/*", "*: stdout", "flags are added"),
    Allowed("scenes", "*: stdout", "scenes are added"),
    Allowed("scenes", "*: stderr", "one scene is told of if it is named"),
    Allowed("*", "*: std*", "scenes are added", "there is no built-in scene"),
    Allowed("sweep/failures", "t.[cj]*", "scenes are added", "there is no built-in scene"),
    Allowed("sweep/failures", "t.parquet", "scenes are added"),
    Allowed("scene-file/bad/*", "*: stderr", "a format is added", r"ends in \.ron"),
    Allowed("sweep/*", "*: stderr", "parameters are added", "known fields are"),
    Allowed("*", "*: stdout", "a plot of rays on their way is written too", "^wrote .*/space-time"),
    Allowed("*", "*: stdout", "a save file for GTKWave stands beside waves", r"^wrote .*\.gtkw$"),
    Allowed("*", "*.gtkw", "a save file for GTKWave stands beside waves"),
    Allowed("*", "*.vcd", "a wave has one name in all viewers", r"^\$var "),
    Allowed("*", "*.fst", "a wave has one name in all viewers"),
    Allowed("*", "*.pftrace", "FIFOs have the jobs inside them, and waits have arrows"),
    Allowed("*", "*.html", "pages have plots of rays on their way, windows and moments"),
    Allowed("*", "*plots/*", "plots are drawn anew: the partition, one scale a figure, cumulative latencies"),
    Allowed("replay/by-hand/*", "p[0-9]*/*", "plots are drawn anew: one scale a figure, cumulative latencies"),
    Allowed("*", "*.sweep.ron", "the sweep stands beside its table"),
    Allowed("sweep/*", "*: stdout", "the sweep stands beside its table", r"^wrote .*\.sweep\.ron$"),
    Allowed("sweep/*", "*: stderr", "what was made of scenes is said", "^note: "),
    Allowed("report/*", "*: stderr", "what was made of scenes is said", "^note: "),
    Allowed("sweep/*", "*-over-*", PLOTS_OF_TABLES),
    Allowed("plot/*", "[pqt]*.[sp][vn]g", PLOTS_OF_TABLES),
    Allowed("report/*", "reports/*.[sp][vn]g", PLOTS_OF_TABLES),
    *(Allowed(case, "*: [se]*", PLOTS_OF_TABLES)
      for case in ["sweep/ranges", "sweep/steps", "plot/of-a-sweep", "plot/x-mode-y-speed_up"]),
    Allowed("plot/x-cells", "*: stderr", "plots of tables are described in more words"),
    Allowed("sweep/bad/plots", "*: stderr", "plots of tables are described in more words"),
    Allowed("bad/commands", "*: stderr", "plots of tables are described in more words", "COLUMN|WORD|TABLE"),
    Allowed("compare*", "*: stdout", "ten lines tell what differs"),
    Allowed("compare*", "*: exit status", "the status tells whether anything differs"),
    Allowed("compare", "*: stderr", "it is said what cannot be read", "cannot"),
    Allowed("views/refused", "*: stderr", "windows are of pages and plots, too"),
]


@dataclass
class Case:
    """Commands to run one after the other in one folder, and the files that are there before.

    A command is pcs-sim's arguments. `OLD: ...` is run by the old binary in both folders, to make an input of the other
    commands; `sh FILE` is a script that takes the binary as its argument; ` < FILE` gives standard input.
    A trace named own.ops is in the binary's own form, and not compared.
    """

    name: str
    commands: list[str]
    files: dict[str, str] = field(default_factory=dict)


# ---------------------------------------------------------------------------------------------------------------- Cases

# Small enough to be quick, large enough to fill an array.
SCENES = {
    "balls": 1, "gears": 1, "lattice": 2, "mountain": 3, "rings": 1, "shells": 1, "sombrero": 1, "teapot": 3,
    "tetra": 4, "tree": 4, "room": 1, "reference": 2,
}  # fmt: skip

MODES = [
    "--mode pipeline",
    "--mode pipeline --mailbox",
    "--mode pipeline --grid-coefficient 2",
    "--mode pipeline --stop-words 1",
    "--mode pipeline --stop-words 8",
    "--mode pipeline --forward-ahead 3",
    "--mode broadcast --cells 1",
    "--mode broadcast",
    "--mode broadcast --cells 16",
    "--mode broadcast --cells 8 --partition polygons",
    "--mode broadcast --cells 16 --partition work",
    "--mode broadcast --cells 5 --partition work --forward-ahead 4 --mailbox",
    "--mode hybrid",
    "--mode hybrid --groups 8 --partition work",
    "--mode hybrid --cells 6 --partition polygons --stop-words 3 --forward-ahead 5",
    "--program hybrid-3",
    "--program hybrid-3 --groups 2 --partition work --mailbox --grid-coefficient 7",
    "--program pcs-programs/hybrid-3.ron --stop-words 2",
]

MACHINES = [
    "--fifo-words 1",
    "--fifo-words 4",
    "--fifo-words 16",
    "--fifo-words 1048576",
    "--link-mb-s 80 --rate-counts channel",
    "--link-mb-s 1",
    "--link-mb-s 13.7 --rate-counts channel",
    "--link-mb-s 0.05 --fifo-words 8",
    "--latency-cycles 0",
    "--latency-cycles 17",
    "--latency-cycles 5 --fifo-words 4 --link-mb-s 25",
    "--clock-ns 25 --link-mb-s 160",
    "--clock-ns 33.3",
    "--word-bytes 8",
    "--host-ray-us 20",
    "--machine pcs-programs/pcs.ron --fifo-words 64",
]

TIMES = [
    "--grid-start 0",
    "--grid-voxel 15.6 --slabs-polygon 1",
    "--intersection-start 12.5 --intersection-polygon 3",
    "--memory-words 1000000",
    "--memory-words 100",
]

FEW_MODES = [
    "--mode pipeline",
    "--mode pipeline --stop-words 2",
    "--mode broadcast --cells 4 --partition work",
    "--mode broadcast --cells 3 --forward-ahead 4",
    "--mode hybrid --cells 4",
    "--program hybrid-3 --groups 2",
]

TEAPOT = "--scene teapot --size-factor 3"
RESULTS = "--stats s.json --hits h.csv --ops a.ops"
VIEWS = ["--plot plots", "--page run.html", "--trace run.pftrace", "--trace run.vcd", "--trace run.fst"]
RAYS = "ox,oy,oz,dx,dy,dz,tmax\n5,2,1.5,-1,0,0,100\n5,2.5,1.5,-1,0.1,-0.2,2\n4,4,2,0,-1,-0.3,50\n4,1,2,0.1,1,-0.5,50\n"
OBJ = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 1\nf 1 2 3\nf 2 3 4\nf 1 3 4\n"
FIR = "pcs-programs/cells/fir.pcs"


def name(*parts: str) -> str:
    """A case's name from flags: without dashes, in one word."""
    return "/".join(re.sub(r"[^\w.]+", "-", part).strip("-") or "plain" for part in parts)


def runs():
    """Every scene in every mode; then larger ones, ray files and threads."""
    for scene, size_factor in SCENES.items():
        for mode in MODES:
            # The room and the hat have but one size to run in.
            factor = "" if scene == "room" else f" --size-factor {size_factor}"
            yield Case(name("run", scene, mode), [f"{mode} --scene {scene}{factor} --size 14x10 {RESULTS} --image i.png"])
    for scene in ["gears", "mountain", "teapot", "reference"]:
        yield Case(name("run", "full", scene), [f"--mode hybrid --scene {scene} --size 20x16 {RESULTS}"])
    for size in ["8x8", "64x64", "1x1", "33x7"]:
        yield Case(name("run", "size", size), [f"{mode} {TEAPOT} --size {size} {RESULTS}" for mode in MODES[:1]])
    for mode in FEW_MODES:
        run = f"{mode} --scene room"
        yield Case(name("run", "rays", mode), [f"{run} --rays rays.csv {RESULTS}"], {"rays.csv": RAYS})
        yield Case(name("run", "threads", mode), [f"{mode} {TEAPOT} --size 64x48 {RESULTS} --threads 3"])
    yield Case("run/resolution", [f"--scene {scene} --size-factor 2 --resolution 5 --size 8x8 {RESULTS} --force"
                                  for scene in ["balls", "lattice", "mountain", "rings", "shells", "tree"]])  # fmt: skip
    yield Case("run/nothing-asked", ["--scene room --size 8x6", "--scene room --size 4x4 --stats /dev/null"])


def machines():
    """The machine's flags and Figure 7's times, on each kind of array and on cells that run programs."""
    programs = [f"{mode} --cells-run programs" for mode in ["--mode pipeline", "--mode broadcast --cells 3", "--mode hybrid"]]
    for mode in FEW_MODES + programs:
        for flags in MACHINES + (TIMES if mode in FEW_MODES else []):
            yield Case(name("machine", mode, flags), [f"{mode} {TEAPOT} --size 12x9 {flags} {RESULTS}"])


def programs():
    """Cells that run programs, on every scene; programs of the user's own; limits."""
    modes = ["--mode pipeline", "--mode broadcast --cells 5", "--mode hybrid", "--program hybrid-3 --mailbox"]
    for scene, size_factor in SCENES.items():
        factor = "" if scene == "room" else f" --size-factor {size_factor}"
        for mode in modes:
            run = f"{mode} --cells-run programs --scene {scene}{factor} --size 10x8 {RESULTS}"
            yield Case(name("programs", scene, mode), [run])
    run = f"{TEAPOT} --size 10x8 --cells-run programs"
    yield Case("programs/own-folder", [f"{run} --cell-programs pcs-programs/cells {RESULTS}"])
    yield Case("programs/cycle-limit", [f"{run} --cycle-limit 500 {RESULTS}"])
    yield Case("programs/views", [f"{run} --plot plots --page run.html --trace run.vcd"])
    yield Case("programs/image", [f"image teapot --size-factor 3 --size 12x12 --cells-run programs -o i.png {RESULTS}"])
    yield Case("programs/refused", [f"{run} {flags}" for flags in [
        "--mode pipeline --stop-words 4", "--mode broadcast --forward-ahead 2", "--grid-start 5",
        "--cell-programs nowhere", "--cell-programs data"]] + ["--cycle-limit 5"])  # fmt: skip


def views():
    """Plots, pages and traces for viewers, of runs, replays and whole images."""
    for mode in FEW_MODES:
        for scene in ["--scene room --size 12x10 --fifo-words 16", f"{TEAPOT} --size 24x18"]:
            run = f"{mode} {scene}"
            yield Case(name("views", mode, scene), [f"{run} {view}" for view in VIEWS])
            ops = f"OLD: {run} --ops a.ops"
            yield Case(name("views", "replay", mode, scene), [ops] + [f"replay a.ops {view}" for view in VIEWS])
    yield Case("views/many-cells", [f"--mode broadcast --cells 40 --scene teapot --size 12x10 {view}" for view in VIEWS])
    yield Case("views/long", [f"--mode pipeline --scene teapot --size 64x64 {view}" for view in VIEWS])
    yield Case("views/few-rays", ["--scene room --rays rays.csv --plot plots --page run.html"], {"rays.csv": RAYS})
    for window in ["20000..30000", "..5000", "100000..", "99000000..", "7..7", "9..3", "x", "-5.."]:
        runs = [f"--mode hybrid --scene room --size 12x10 --trace run.{end} --trace-window={window}"
                for end in ["vcd", "fst", "pftrace"]]  # fmt: skip
        yield Case(name("views", "window", window), runs)
    image = "image room --size 10x10 -o i.png --force --policy generation"
    yield Case("views/image", [f"{image} {view}" for view in VIEWS])
    yield Case("views/refused", ["--scene room --trace a.json", "--scene room --trace-window 1..2",
                                 "image room -o a.png --timing off --trace a.vcd"])  # fmt: skip


def images():
    """Whole images: light, host and machine."""
    flags = [
        "", "--samples 2", "--samples 3 --adaptive", "--depth 0", "--depth 1 --samples 2", "--min-contribution 0.3",
        "--policy primaries", "--policy generation --samples 2", "--in-flight 1", "--in-flight 3 --policy primaries",
        "--open-samples 1", "--open-samples 7 --policy generation", "--host-ray-us 20 --host-hit-us 95.5",
        "--in-flight 40 --open-samples 16 --samples 2 --adaptive", "--machine pcs-programs/pcs-sun3.ron",
        "--fifo-words 16 --link-mb-s 20", "--fifo-words 2",
    ]  # fmt: skip
    scenes = ["room", "teapot --size-factor 3", "gears --size-factor 2", "data/glass.ron"]
    for scene in scenes:
        for more in flags:
            yield Case(name("image", scene, more), [f"image {scene} --size 12x10 -o i.png {RESULTS} {more}"])
        for mode in MODES:
            if "ahead" not in mode:
                yield Case(name("image", scene, mode), [f"image {scene} --size 9x8 {mode} -o i.pfm {RESULTS}"])
    for scene in [f"{scene} --size-factor {size}" for scene, size in SCENES.items() if scene != "room"]:
        run = f"image {scene} --size 32x24 --timing off"
        yield Case(name("image", scene, "untimed"), [f"{run} -o i.png", f"{run} --samples 2 --adaptive -o i.pfm --hits h.csv"])
    yield Case("image/large", [f"image room --size 64x64 --samples 2 -o i.png {RESULTS}"])
    yield Case("image/refused", [f"image room {rest}" for rest in [
        "-o a.jpg", "-o d.png --timing off --ops a.ops", "-o d.png --in-flight 0", "-o i.png --adaptive", "",
        "-o i.png --timing off --policy primaries", "-o i.png --timing off --fifo-words 4", "-o i.png --open-samples 0",
        "-o i.png --timing off --stats s.json", "-o i.png --samples 0", "-o i.png --min-contribution -1",
        "-o i.png --size 4x4 --mode broadcast --cells 2 --forward-ahead 2"]])  # fmt: skip


def replays():
    """Old traces under other machines, own traces, traces by hand: good, stuck and bad ones."""
    sources = [f"{mode} {TEAPOT} --size 12x9" for mode in FEW_MODES]
    sources += ["image room --size 8x8 -o i.png --force --in-flight 9", "image room --size 8x8 -o i.png --force --host-hit-us 50"]
    for source in sources:
        replays = [f"replay a.ops --stats {n}.json {flags}" for n, flags in enumerate([""] + MACHINES)]
        yield Case(name("replay", source), [f"OLD: {source} --ops a.ops"] + replays)
        yield Case(name("replay", "own", source), [f"{source} --ops own.ops", "replay own.ops --stats s.json",
                                                   "replay own.ops --fifo-words 24 --stats t.json"])  # fmt: skip
    good = {
        "any-order": "# two cells\n7 host w8\n7 0 x8 g10 o2\n7 1 x8 i2 o5\n3 host w8\n3 0 x8 o2\n3 1 x8 i2 n4 o5\n",
        "host": "0 host w8\n1 host a0 c10 w8\n0 0 x8 o5\n1 0 x8 o5\n",
        "last-hit": "0 host w8\n0 0 x8 o1 c5000\n0 1 x8 i1 o5\n",
        "loop": "0 host w8\n0 0 r8 o600 w8\n0 1 r8 i600 o5\n",
        "loop-of-words": "0 host w8\n0 0 x8 b1 o1\n0 1 x8 i1 z1 o5\n",
        "no-room-on-z": "0 host w8\n0 0 x8 b2 o1\n0 1 x8 z9 i1 o5\n",
        "host-waits": "0 host a1 w8\n1 host w8\n0 0 x8 o5\n1 0 x8 o5\n",
        "starves": "0 host w8\n0 0 x8 g20 o2\n0 1 x8 i3 o5\n",
        "too-few-rays": "4 host w8\n4 0 x8 o5\n5 0 x8 o5\n",
        "long-loop": "0 host w8\n0 0 x8 o1\n0 1 r8 i1 o9 w8\n0 2 r8 i9 w8 o1\n0 3 r8 i1 o5\n",
    }
    for which, trace in good.items():
        yield Case(f"replay/by-hand/{which}", [f"replay a.ops --stats s{n}.json {flags} --plot p{n} --trace t{n}.vcd"
                   for n, flags in enumerate(["", "--fifo-words 4", "--fifo-words 600", "--link-mb-s 3"])], {"a.ops": trace})
    bad = [
        "once upon a time\n", "0 host w8\n0 0 x8 q600 o5\n", "0 host x8\n0 0 x8 o5\n", "0 host w8\n0 0 x8 g o5\n",
        "0 host w8\n0 0 x8 g-5 o5\n", "0 host w8\n0 0 x8 g99999999999999999999 o5\n", "0 host w8\n0 99999 x8 o5\n",
        "0 host w8 a9\n0 0 x8 o5\n", "0 0 x8 o5\n", "0 host w8\n0 host w8\n0 0 x8 o5\n", "0 host w8\n0 0 x8 w8 o5\n",
        "0 host w8\n0 0 x8 z1 o5\n", "0 host w8\n0 0 x8 o1\n0 1 x8 i1 b1 o5\n", "", "0 host w8\n0 0 x8", "\0\1\2",
        "0 host w8\n0 0 x8 o5\n0 2 x8 o5\n", "0 host w8\n0 0 i1 x8 o5\n", "0 " * 100000, "0 host w0\n0 0 x0 o5\n",
    ]  # fmt: skip
    for n, trace in enumerate(bad):
        yield Case(f"replay/bad/{n}", ["replay a.ops --stats s.json"], {"a.ops": trace})
    flags = ["--grid-start 3", "--memory-words 3", "--fifo-words 0", "--machine data/glass.ron", "--stats a.ops --force"]
    yield Case("replay/refused", [f"replay a.ops {flag}" for flag in flags] + ["replay b.ops"], {"a.ops": good["host"]})


def models():
    """The cost model beside the run, and alone."""
    for scene, size_factor in SCENES.items():
        factor = "" if scene == "room" else f" --size-factor {size_factor}"
        for mode in ["--mode pipeline", "--mode broadcast", "--mode hybrid --partition work", "--program hybrid-3"]:
            yield Case(name("model", scene, mode), [f"model {scene}{factor} --size 12x9 {mode} --stats s.json"])
    for flags in ["", "--fifo-words 16 --link-mb-s 2", "--host-ray-us 5000", "--clock-ns 25 --grid-voxel 1",
                  "--latency-cycles 9 --rate-counts channel", "--partition work --mode broadcast --cells 16",
                  "--grid-coefficient 7", "--memory-words 100000"]:  # fmt: skip
        yield Case(name("model", "flags", flags), [f"model teapot --size-factor 3 --size 12x9 {flags} {alone}"
                                                   for alone in ["", "--predict-only"]])  # fmt: skip
    yield Case("model/rays", ["model room --rays rays.csv", "model room --rays rays.csv --predict-only"], {"rays.csv": RAYS})
    yield Case("model/refused", [f"model room --size 8x8 {flags}" for flags in [
        "--mailbox", "--mode pipeline --stop-words 2", "--forward-ahead 1", "--predict-only --fifo-words 64",
        "--predict-only --stats s.json", "--grid-coefficient 100000"]])  # fmt: skip


def tables():
    """Sweeps, plots of tables, comparisons of statistics."""
    sweep = """(
    scene: "room",
    size: "12x10",
    mode: ["pipeline", "broadcast"],
    fifo_words: (from: 2, to: 32, times: 4),
    link_mb_s: [80.0, 13],
)"""
    sweeps = {
        "ranges": sweep,
        "stop-words": '(scene: "room", size: "12x10", program: ["pipeline", "hybrid"], stop_words: [1, 4])',
        "failures": '(scene: ["room", "atlantis"], size: 4, fifo_words: [0, 4], mode: ["pipeline", "sideways"])',
        "steps": '(scene: "room", size: ["6x4", "4x6"], mailbox: [true, false], grid_coefficient: [0.5, 50],\n'
        " fifo_words: (from: 2, to: 8, step: 6), link_mb_s: [80, 0.1, 13.5])",
        "machine": '(scene: "teapot", size_factor: 3, size: 8, clock_ns: [25, 50], word_bytes: [4, 8], latency_cycles: [1, 9],\n'
        ' rate_counts: ["link", "channel"], host_ray_us: [0, 90], machine: "pcs-programs/pcs.ron")',
        "times": '(scene: "teapot", size_factor: 3, size: 8, mode: "hybrid", groups: [1, 3], grid_start: [1, 30],\n'
        " grid_voxel: [1, 9], slabs_start: 2, slabs_polygon: [2, 13], intersection_start: 3, intersection_polygon: [1, 30])",
        "programs": '(scene: "tetra", size_factor: 3, size: 8, program: ["broadcast", "pcs-programs/hybrid-3.ron"],\n'
        ' cells: [3, 6], partition: ["regular", "polygons", "work"], forward_ahead: [0, 3], memory_words: [1000, 1000000])',
        "cells-run": '(scene: "tetra", size_factor: 3, size: 8, cells_run: ["timings", "programs"], cycle_limit: [100, 1000000])',
        "files": '(scene: ["data/cube.obj", "data/everything.ron", "o.obj"], size: 6, resolution: [4, 8])',
        "rays": '(scene: "room", rays: "rays.csv", fifo_words: [4, 8])',
        "no-point-works": '(scene: "room", size: 8, fifo_words: [0])',
    }
    for which, text in sweeps.items():
        files = {"sweep.ron": text, "rays.csv": RAYS, "o.obj": OBJ}
        plot = "--plot x=fifo_words y=cycles" if "fifo_words" in text else ""
        yield Case(f"sweep/{which}", [f"sweep sweep.ron -o t.csv {plot}", "sweep sweep.ron -o t.parquet",
                                      f"sweep sweep.ron -o t.csv --force {plot}"], files)  # fmt: skip
    plots = "--plot x=fifo_words y=rays_per_second by=mode --plot x=mode y=cycles --plot x=link_mb_s y=mean_works"
    draw = "plot t.csv x=fifo_words y=cycles by=mode"
    yield Case("plot/of-a-sweep", [f"sweep sweep.ron -o t.csv {plots}", f"{draw} -o p --title Rooms", f"{draw} -o p",
                                   f"{draw} link_mb_s=80 -o q"], {"sweep.ron": sweep})  # fmt: skip
    table = "cells,mode,scene,speed_up\n1,a,room,1\n2,a,room,1.9\n4,a,room,3.7\n1,b,room,0.9\n4,b,tree,2\n8,b,room,1e3\n"
    for columns in ["x=cells y=speed_up", "x=cells y=speed_up by=mode", "x=cells y=speed_up by=mode scene=room",
                    "x=mode y=speed_up", "x=cell y=speed_up", "x=cells y=mode", "x=cells", "x=cells y=speed_up scene=x"]:  # fmt: skip
        yield Case(name("plot", columns), [f"plot t.csv {columns} -o p --title Rooms"], {"t.csv": table})
    for n, text in enumerate(["(fifo_word: [1, 2])", "(fifo_words: (from: 1, to: 9))", '(\n    fifo_words: [1, "many"],\n)',
                              "(cells: (from: 1, to: 3, step: 0.5))", "(fifo_words: [])", "(", "()", '(scene: 5)',
                              '(scene: "room", size: 8, scene: "tree")', '(size: "8x")', "(stats: 1)"]):  # fmt: skip
        yield Case(f"sweep/bad/{n}", ["sweep sweep.ron -o t.csv", "sweep sweep.ron -o t.xls"], {"sweep.ron": text})
    yield Case("sweep/bad/plots", [f"sweep sweep.ron -o t.csv --plot {plot}" for plot in [
        "x=fifo_word y=cycles", "x=fifo_words y=seconds by=modes", "x=fifo_words y=mode", "x=fifo_words by=mode",
        "x=fifo_words y=cycles z=mode", "x=fifo_words y=cycles y=seconds"]], {"sweep.ron": sweep})  # fmt: skip
    yield Case("sweep/bad/files", ["sweep sweep.ron -o t.csv", "sweep sweep.ron -o u.csv", "sweep no.ron -o v.csv"],
               {"sweep.ron": sweep, "t.csv": "precious", "u.journal": "my thoughts\n"})  # fmt: skip
    runs = ["--stats a.json", "--fifo-words 4 --stats b.json", "--mode broadcast --cells 3 --stats c.json",
            "--cells-run programs --stats d.json"]  # fmt: skip
    compare = [f"compare a.json {other}.json" for other in "abcd"] + ["compare a.json no.json", "compare a.json x.json"]
    yield Case("compare", [f"--scene room --size 8x6 {run}" for run in runs] + compare, {"x.json": "{"})
    image = "image room --size 8x6 --force -o i.png --stats"
    yield Case("compare/images", [f"{image} a.json", f"{image} b.json --policy primaries", "compare a.json b.json"])


def reports(inputs: Path):
    """Each report's run.sh with all of its sweeps, tables and plots, at a reduced size."""
    for folder in sorted(path.parent for path in inputs.glob("reports/*/run.sh")):
        # What reference-image measures is time on the clock.
        if folder.name == "reference-image":
            continue
        kept = [*folder.glob("*.ron"), *folder.glob("*.sh"), *folder.glob("*.awk"), *folder.glob("published.csv")]
        kept += [inputs / "reports/columns.awk", inputs / "reports/sweeps.sh"]
        files = {str(path.relative_to(inputs)): reduced(path.read_text()) for path in kept}
        yield Case(f"report/{folder.name}", [f"sh reports/{folder.name}/run.sh"], files)


def reduced(text: str) -> str:
    """A report's sweep or script with few pixels, polygons and cells, that keeps all that a sweep writes."""
    text = re.sub(r"^    scene: \[", r"    size_factor: 2,\g<0>", text, flags=re.M)
    if "    size:" not in text:
        text = re.sub(r"^    size_factor: 2,", r"\g<0>\n    size: 8,\n", text, flags=re.M)
    text = re.sub(r'size: \["64x64".*\]', 'size: ["4x4", "8x8"]', text)
    text = text.replace("to: 256", "to: 16").replace(", 96, 192]", "]")
    text = text.replace("cells: [16, 64]", "cells: [4, 16]")
    text = text.replace("for size in 1 3 10 30 100 300 1000", "for size in 1 3 10")
    text = text.replace("--size 512x512", "--size 8x8").replace("--size 256x256", "--size 8x8")
    return text.replace('    rm "$1.parquet" "$1.journal"\n', "")


def cells():
    """The commands about cells: figure7, calibrate, asm, disasm, step."""
    sun = "--machine pcs-programs/pcs-sun3.ron"
    folder = "--cell-programs pcs-programs/cells"
    yield Case("cells/figure7", ["figure7", f"figure7 {sun}", f"figure7 {folder}", "figure7 --cell-programs nowhere"])
    yield Case("cells/calibrate", ["calibrate", f"calibrate {sun} {folder} -o m.ron", "calibrate -o m.ron",
                                   "figure7 --machine m.ron", "--scene room --size 8x6 --machine m.ron"])  # fmt: skip
    names = ["broadcast", "fir", "grid", "grid-intersection", "grid-slabs", "intersection", "pass-through", "slabs",
             "slabs-intersection"]  # fmt: skip
    for program in names:
        source = f"pcs-programs/cells/{program}.pcs"
        yield Case(f"cells/asm/{program}", [f"asm {source}", f"asm {source} -o p.obj --listing p.lst", f"disasm {source}",
                   f"asm {source} --listing {sun}", "disasm p.obj", "asm p.obj", f"asm {source} -o p.obj"])  # fmt: skip
    words = {"x.txt": "1.0, 0 0x0\n-2.5 ; the end", "bad.txt": "1, 2\n3, x ; x", "large.txt": "1 4294967296"}
    scripts = [
        "run\nqueues\n", "help\n", "step 2 ; comment\nregisters\nlist\n", "break tap\nbreak\nrun\nrun\nregisters\nqueues\nquit\n",
        "step\nstpe 2\n", "step 2 3\n", "break tpa\n", "break 1000\n", "break @1000\n", "memory tap\n", "memory taps 3\n",
    ]  # fmt: skip
    for n, script in enumerate(scripts):
        step = f"step {FIR} --x x.txt"
        yield Case(f"cells/step/{n}", [f"{step} --script script.txt", f"{step} < script.txt"], words | {"script.txt": script})
    yield Case("cells/step/documented", [f"step {FIR} --x cell/samples.txt --script cell/session.txt",
                                         f"step {FIR} --script cell/help.txt"])  # fmt: skip
    yield Case("cells/step/bad-words", [f"step {FIR} --x {x} < x.txt" for x in ["bad.txt", "large.txt", "no.txt", "-"]], words)
    sources = {
        "fault": "li r1, 1\ndiv r1, r1, r0\n", "message": "mov r1, x\nadd y, r1, r1\ndone\n", "empty": "",
        "unknown": "mvo r1, x\n", "register": "mov r99, x\n", "jump": "b nowhere\n", "twice": "a: done\na: done\n",
        "include": '.include "nowhere.pcs"\n', "object": "pcs object\ncode\n01f00000\nff000000\n",
        "bad-object": "pcs object\ncode\n01f0000\n",
    }  # fmt: skip
    for which, source in sources.items():
        files = {"p.pcs": source, "script.txt": "run\nregisters\nmemory 0\nlist\nqueues\n", "x.txt": "1 2"}
        yield Case(f"cells/source/{which}", ["asm p.pcs", "asm p.pcs --listing", "disasm p.pcs",
                                             "step p.pcs --x x.txt --script script.txt"], files)  # fmt: skip


def scene_files():
    """Scene files of each format, good and bad."""
    for scene in ["cube.obj", "cube.ply", "everything.ron", "glass.ron", "painted.ron", "shapes.nff"]:
        run = f"data/{scene} --size 12x9"
        yield Case(name("scene-file", scene), [f"--scene {run} {RESULTS}", f"image {run} -o i.png --samples 2",
                                               f"model {run} --mode broadcast --cells 2"])  # fmt: skip
    bad = {
        "s.obj": ["", "v 0 0 0\n", "v 0 0\n", "v 1 2 zwei\n", "v 0 0 nan\n", "v 0 0 1e400\n", "v 0 0 0\nv 1 0 0\nf 1 2\n",
                  "v 0 0 0\nf 1 1 2\n", "v 0 0 0\n  usemlt wood\n", "mtllib no.mtl\nv 0 0 0\nf 1 1 1\n", "ply\n"],
        "s.ply": ["", "solid cube\n", "ply\nformat ascii 1.0\n", "ply\nend_header\n", "ply\nformat asci 1.0\nend_header\n"],
        "s.nff": ["", "p 3\n0 0 0\n", "v\nfrom 0 0\n", "s 0 0 0 -1\n", "q 1\n"],
        "s.ron": ["", "Scene(", "Scene()", "Scene(meshes: [])", 'Scene(meshes: [(shape: File("no.obj"))])',
                  'Scene(camera: Camera(from: (0, 0, 0)), meshes: [(shape: Builtin(name: "teapto"))])'],
        "s.xyz": ["?"],
    }  # fmt: skip
    for file, texts in bad.items():
        for n, text in enumerate(texts):
            yield Case(f"scene-file/bad/{file}/{n}", [f"--scene {file} --size 4x4", f"image {file} -o i.png"], {file: text})


def refusals(inputs: Path):
    """Bad usage and bad files: machine and program files, rays, flags, outputs."""
    machine = (inputs / "pcs-programs/pcs.ron").read_text()
    program = (inputs / "pcs-programs/hybrid.ron").read_text()
    for n, (old, new) in enumerate([
        ("fifo_words", "fifo_wrods"), ("512", '"many"'), ("word_bytes: 4,", ""), ("512", "0"), ("clock_ns: 50.0", "clock_ns: NaN"),
        ("7.8", "inf"), ("80.0", "1e-13"), ("rate_counts: Link", "rate_counts: Both"), ("memory_words: None", "memory_words: 7"),
        ("integer: 4", "integer: 0"), ("branch: 6", "brunch: 6"), ("host_hit_us: 0.0", "host_hit_us: -1"), ("latency_cycles: 1", "latency_cycles: 0"),
    ]):  # fmt: skip
        yield Case(f"bad/machine/{n}", ["--machine m.ron --scene room --size 4x4"], {"m.ron": machine.replace(old, new)})
    cut = {"m.ron": machine[:-40]}
    yield Case("bad/machine/cut", [f"{command} --machine m.ron" for command in ["--scene room", "figure7", "calibrate"]], cut)
    for n, (old, new) in enumerate([
        ("slabs", "slab"), ("grid, slabs", "slabs, grid"), ("groups: 4", "groups: 0"), ("50.0", "-1.0"), ("stop_words: None", "stop_words: Some(0)"),
        ("partition: regular", "partition: irregular"), ("name:", "nmae:"), ("[intersection]", "[]"), ("mailbox: false", "mailbox: 0"),
    ]):  # fmt: skip
        yield Case(f"bad/program/{n}", ["--program p.ron --scene room --size 4x4"], {"p.ron": program.replace(old, new)})
    for n, rays in enumerate([
        "x,y,z,dx,dy,dz\n0,0,0,0,0,1\n", "ox,oy,oz,dx,dy,dz\n0,0,0,0,0,1\n0,0,0\n", "ox,oy,oz,dx,dy,dz\n0,0, zero,0,0,1\n",
        "ox,oy,oz,dx,dy,dz\n0,NaN,0,0,0,1\n", "ox,oy,oz,dx,dy,dz\n0,0,0,0,0,0\n", "ox,oy,oz,dx,dy,dz\n", "",
        "ox,oy,oz,dx,dy,dz,tmax\n0,0,0,0,0,1,-3\n",
    ]):  # fmt: skip
        yield Case(f"bad/rays/{n}", ["--rays r.csv --scene room"], {"r.csv": rays})
    flags = [
        "--fifo-words 0", "--mode broadcast --cells 0", "--mode hybrid --cells 5", "--mode pipeline --cells 6", "--size 12",
        "--mode broadcast --cells 64", "--mode pipeline --memory-words 1000", "--grid-coefficient 1e9 --size 2x2", "--threads 0",
        "--program pipeline --groups 3", "--partition work", "--rays rays.csv --size 4x4", "--resolution 8", "--host-hit-us 5",
        "--mode broadcast --stop-words 4", "--mode pipeline --stop-words 64 --fifo-words 31", "--rays rays.csv --image i.png",
        "--stats nowhere/s.json", "--stats .", "--stats s.out --hits s.out", "--stats s.out --hits ./s.out", "--mdoe pipeline",
        "--mode", "--mode sideways", "--clock-ns -1", "--clock-ns x", "--link-mb-s 0", "--link-mb-s nan", "--size 0x4", "--machine no.ron",
        "--program no.ron", "--program data", "--latency-cycles -1", "--rate-counts both", "--cells 4 --groups 4", "--grid-voxel -1",
        "--mode broadcast --cells 5000", "--scene tree", "--image i.jpg", "--size 99999x99999", "extra", "--mode hybrid --program hybrid",
    ]  # fmt: skip
    for flag in flags:
        yield Case(name("bad/flag", flag), [f"--scene room {flag}"], {"rays.csv": RAYS})
    yield Case("bad/scene", ["--scene teapto", "--scene tetra --size-factor 40", "--scene no.ply", "--scene", "image teapto -o i.png"])
    keep = "--scene room --size 4x4 --stats s.json"
    yield Case("bad/kept", [keep, f"{keep} --force", f"{keep} --machine s.json"], {"s.json": "precious"})


def texts():
    """Lists and help."""
    yield Case("scenes", ["scenes", "scenes x"])
    yield Case("help/version", ["--version"])
    commands = ["image", "replay", "sweep", "model", "plot", "compare", "figure7", "calibrate", "asm", "disasm", "step", "scenes"]
    for command in ["", *commands]:
        yield Case(name("help", command), [f"{command} --help", f"{command} -h"])
    yield Case("bad/commands", commands[:-1] + ["sweeep", "image room", "compare a.json", "plot t.csv -o p"])


def all_cases(inputs: Path) -> list[Case]:
    """All cases; the long ones first, so that both processes have work to the end."""
    kinds = [reports(inputs), runs(), machines(), programs(), views(), images(), replays(), models(), tables(), cells(),
             scene_files(), refusals(inputs), texts()]  # fmt: skip
    return [case for kind in kinds for case in kind]


# -------------------------------------------------------------------------------------------------------------- Running


@dataclass
class Binary:
    """A binary of pcs-sim, and what it is asked beside a case's flags."""

    path: Path
    prices_ops: bool

    @staticmethod
    def at(path: str) -> "Binary":
        """The binary at a path."""
        absolute = Path(path).resolve()
        help_text = subprocess.run([absolute, "--help"], capture_output=True, check=True).stdout
        return Binary(absolute, b"--ops-form" in help_text)

    def arguments(self, command: str) -> list[str]:
        """A command's words for this binary."""
        words = shlex.split(command)
        if words[:1] == ["sh"]:
            return ["sh", Path(words[1]).name, str(self.path)]
        priced = self.prices_ops and "--ops" in words and "own.ops" not in words
        return [str(self.path), *words, *(["--ops-form", "priced"] if priced else [])]


def run(case: Case, binary: Binary, old: Binary, inputs: Path) -> dict[str, bytes]:
    """Runs a case in a folder of its own: all that is printed and all files that are there in the end."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for path, text in case.files.items():
            (folder / path).parent.mkdir(parents=True, exist_ok=True)
            (folder / path).write_text(text)
        for link, target in {"pcs-programs": "pcs-programs", "data": "tests/data", "cell": "docs/cell"}.items():
            (folder / link).symlink_to(inputs / target)
        seen: dict[str, bytes] = {}
        for number, command in enumerate(case.commands, 1):
            by = old if command.startswith("OLD: ") else binary
            for what, output in printed(command.removeprefix("OLD: "), by, folder).items():
                seen[f"{number}: {what}"] = output
        files = (path for path in sorted(folder.rglob("*")) if path.is_file() and not path.is_symlink())
        seen.update((str(path.relative_to(folder)), path.read_bytes()) for path in files if path.name != "own.ops")
        return seen


def printed(command: str, binary: Binary, folder: Path) -> dict[str, bytes]:
    """What one command prints, and how it ends."""
    command, _, stdin = command.partition(" < ")
    where = folder / Path(command.split()[1]).parent if command.startswith("sh ") else folder
    given = (folder / stdin).read_bytes() if stdin else b""
    try:
        done = subprocess.run(binary.arguments(command), cwd=where, input=given, capture_output=True, timeout=TIMEOUT_S)
        status = str(done.returncode)
        return {"stdout": done.stdout, "stderr": done.stderr, "exit status": status.encode()}
    except subprocess.TimeoutExpired:
        return {"exit status": f"none after {TIMEOUT_S} s".encode()}


# ------------------------------------------------------------------------------------------------------------ Comparing


def compared(file: str, content: bytes) -> bytes:
    """What is compared of a file: of statistics all but their `configuration`; of journals the lines, in any order."""
    if file.endswith(".journal"):
        # Points are written down as they finish, on several threads.
        return b"".join(sorted(content.splitlines(keepends=True)))
    if not file.endswith(".json"):
        return content
    return re.sub(rb'(?ms),?\n  "configuration": \{.*?^  \}(?=,?\n)', b"", content)


def difference(file: str, old: bytes | None, new: bytes | None) -> str | None:
    """The first difference of two files, in words; None if there is none."""
    if old is None or new is None:
        return f"only {'the new' if old is None else 'the old'} binary writes it"
    old, new = compared(file, old), compared(file, new)
    if old == new:
        return None
    at = next((n for n, (a, b) in enumerate(zip(old, new)) if a != b), min(len(old), len(new)))
    if b"\0" in old + new:
        return f"byte {at}: {old[at : at + 8].hex(' ')} | {new[at : at + 8].hex(' ')}; {len(old)} and {len(new)} bytes"
    line = old.count(b"\n", 0, at) + 1
    start = old.rfind(b"\n", 0, at) + 1
    start = max(start, at - 40)
    shown = [text[start : start + 100].split(b"\n")[0].decode(errors="replace") for text in (old, new)]
    return f"line {line}: {shown[0]} | {shown[1]}"


def allowed(case: str, file: str, old: bytes | None, new: bytes | None) -> str | None:
    """Why a difference is meant; None if ALLOWED does not name it."""
    entries = [entry for entry in ALLOWED if fnmatch.fnmatch(case, entry.cases) and fnmatch.fnmatch(file, entry.files)]
    for entry in entries:
        if not entry.lines and not entry.layout:
            return entry.why
    if old is None or new is None:
        return None
    layout = any(entry.layout for entry in entries)
    lines = "|".join(entry.lines for entry in entries if entry.lines)
    for passed_over in ["", lines]:
        if kept(passed_over, layout, file, old) == kept(passed_over, layout, file, new):
            return "; ".join(entry.why for entry in entries if passed_over or entry.layout)
    return None


def kept(passed_over: str, layout: bool, file: str, content: bytes) -> list[bytes]:
    """The lines of a file in which an expression, if there is one, is not found; only their words, if the layout may differ."""
    lines = compared(file, content).splitlines()
    lines = [line for line in lines if not (passed_over and re.search(passed_over.encode(), line))]
    return b"\n".join(lines).split() if layout else lines


def report(case: Case, old: dict[str, bytes], new: dict[str, bytes]) -> tuple[int, int]:
    """Prints how a case's files differ: how many do so as they may not, and as they may."""
    wrong = right = 0
    for file in sorted(old.keys() | new.keys()):
        was, now = old.get(file), new.get(file)
        if (what := difference(file, was, now)) is None:
            continue
        if why := allowed(case.name, file, was, now):
            right += 1
            print(f"allowed: {case.name}: {file}: {why}", flush=True)
        else:
            wrong += 1
            print(f"DIFFERS: {case.name}: {file}: {what}", flush=True)
    if wrong:
        print("         " + "\n         ".join(f"{n}: {command}" for n, command in enumerate(case.commands, 1)), flush=True)
    return wrong, right


def old_inputs(into: Path) -> Path:
    """Unpacks the inputs as the commit INPUTS has them."""
    top = Path(__file__).resolve().parent.parent
    archive = subprocess.run(["git", "archive", INPUTS, "pcs-programs", "tests/data", "docs/cell", "reports"],
                             cwd=top, capture_output=True, check=True).stdout  # fmt: skip
    subprocess.run(["tar", "x", "-C", into], input=archive, check=True)
    return into


def main(arguments: list[str]) -> int:
    """Runs the cases by both binaries and says what differs."""
    listing = arguments[:1] == ["--list"]
    if len(arguments) not in ([1, 2] if listing else [2, 3]):
        print(__doc__, file=sys.stderr)
        return 2
    wanted = (arguments[1:2] if listing else arguments[2:3]) or [""]
    with tempfile.TemporaryDirectory() as name:
        inputs = old_inputs(Path(name))
        cases = [case for case in all_cases(inputs) if wanted[0] in case.name]
        if listing:
            print("\n".join(f"{case.name}: {'; '.join(case.commands)}" for case in cases))
            return 0
        return compare_all(cases, Binary.at(arguments[0]), Binary.at(arguments[1]), inputs)


def compare_all(cases: list[Case], old: Binary, new: Binary, inputs: Path) -> int:
    """Runs and compares the cases, and sums up."""
    compared_files = wrong = right = 0
    with ThreadPoolExecutor(PROCESSES) as pool:
        both = pool.map(lambda case: [run(case, binary, old, inputs) for binary in (old, new)], cases)
        for case, (was, now) in zip(cases, both):
            compared_files += len(was.keys() | now.keys())
            counts = report(case, was, now)
            wrong, right = wrong + counts[0], right + counts[1]
    commands = sum(len(case.commands) for case in cases)
    print(f"{len(cases)} cases, {commands} commands, {compared_files} outputs: {wrong} differ, {right} as they may")
    return 1 if wrong or not cases else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
