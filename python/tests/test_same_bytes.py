"""The module gives the bytes that the command gives for the same parameters."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import networkx
import numpy as np
import pytest

import pcs_sim

from .support import LOOP, command, flags

RUNS: list[dict[str, Any]] = [
    {"scene": "room", "size": "24x18"},
    {"scene": "room", "size": "24x18", "mode": "broadcast", "cells": 4, "fifo_words": 16, "link_mb_s": 40.0},
    {"scene": "tetra", "size": "20x20", "mode": "hybrid", "cells": 4, "partition": "work", "grid_coefficient": 5.5},
    {"scene": "room", "size": "16x12", "program": "hybrid-3", "groups": 2, "mailbox": True, "y_fifo_words": 64},
    {
        "scene": "room",
        "size": "16x12",
        "mode": "broadcast",
        "partition": "measured",
        "numbering": "front",
        "bounded_walk": True,
    },
    {"scene": "room", "size": "24x18", "mode": "broadcast", "cells": 8, "order": "shuffle:5"},
    {"scene": "room", "size": "6x4", "cells_run": "programs", "instruction_limit": 100000, "early_slabs": True},
    {"scene": "tree", "size_factor": 2, "size": "16x12", "screen_rectangles": "objects", "host_filter_us": 2.5},
    {"scene": "room", "size": "12x9", "mode": "broadcast", "cells": 8, "masks": "rectangles", "host_mask_us": 1.0},
    {"scene": "balls", "size_factor": 1, "resolution": 8, "size": "16x16", "clock_ns": 25.0, "stop_words": 4},
]

IMAGES: list[dict[str, Any]] = [
    {"scene": "room", "size": "16x12"},
    {"scene": "tetra", "size": "12x12", "mode": "broadcast", "cells": 2, "samples": 2, "adaptive": True, "depth": 2},
    {"scene": "room", "size": "12x8", "policy": "generation", "in_flight": 5, "host_hit_us": 10.0},
    {"scene": "room", "size": "12x8", "samples": 2, "adaptive_by": "whitted", "threshold": 30, "masks": "boxes"},
    {
        "scene": "balls",
        "size_factor": 1,
        "size": "12x8",
        "samples": 2,
        "adaptive_by": "lao",
        "screen_rectangles": "scene",
    },
]

FILES = ["stats.json", "hits.csv", "image.png", "page.html", "trace.vcd"]


def same(folder: Path, names: list[str]) -> None:
    """Compares the files in two folders."""
    for name in names:
        ours, theirs = (folder / "ours" / name).read_bytes(), (folder / "theirs" / name).read_bytes()
        assert ours == theirs, f"{name} differs"


@pytest.fixture
def two(folder: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Two folders: ours, which is the current one, and theirs, the command's."""
    for name in ["ours", "theirs"]:
        (folder / name).mkdir()
    monkeypatch.chdir(folder / "ours")
    return folder


@pytest.mark.parametrize("parameters", RUNS)
def test_runs(two: Path, parameters: dict[str, Any]) -> None:
    run = pcs_sim.run(**parameters, ops="run.ops")
    written = run.save(
        stats="stats.json", hits="hits.csv", image="image.png", page="page.html", plot="plots", trace="trace.vcd"
    )
    results = "--stats stats.json --hits hits.csv --image image.png --page page.html --plot plots --trace trace.vcd"
    ended = command(two / "theirs", *flags(parameters), *results.split(), "--ops", "run.ops")
    assert ended.status == 0, ended.err
    names = sorted(path.relative_to(two / "theirs").as_posix() for path in (two / "theirs").rglob("*.*"))
    assert sorted([*(path.as_posix() for path in written), "run.ops"]) == names
    same(two, names)
    assert ended.out.startswith(str(run))
    assert run.stats == json.loads((two / "theirs" / "stats.json").read_text())
    noted = [line.removeprefix("note: ") for line in ended.err.splitlines() if line.startswith("note: ")]
    assert run.notes == [note for note in noted if "trace" not in note]


def test_few_colors(two: Path) -> None:
    run = pcs_sim.image("room", size="24x16", timing="off")
    assert run.image is not None
    for palette in ["peano", "peano-large", "fixed", "popularity", "median-cut", "gervautz"]:
        few = run.few_colors(24, palette)
        assert few["colors"].dtype == np.uint8
        assert few["pixels"].shape == (16, 24)
        assert len(few["colors"]) <= 24
        assert few["pixels"].max() < len(few["colors"])
        linear = np.clip(run.image, 0, 1)
        screen = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055) * 255
        off = few["colors"][few["pixels"]].astype(float) - np.round(screen)
        assert abs(float((off**2).sum(axis=2).mean()) - few["mean_square"]) < 1
        run.save(image=f"{palette}.png", colors=24, palette=palette)
        made = "image room --size 24x16 --timing off --colors 24 --palette".split()
        assert command(two / "theirs", *made, palette, "-o", f"{palette}.png").status == 0
        same(two, [f"{palette}.png"])
    for colors, palette in [(0, "peano"), (1 << 17, "peano"), (9, "oil")]:
        with pytest.raises(pcs_sim.InputError):
            run.few_colors(colors, palette)
    with pytest.raises(pcs_sim.InputError):
        run.save(colors=9)


@pytest.mark.parametrize("parameters", IMAGES)
def test_images(two: Path, parameters: dict[str, Any]) -> None:
    run = pcs_sim.image(**parameters, ops="run.ops")
    run.save(stats="stats.json", hits="hits.csv", image="image.png", page="page.html", plot="plots")
    run.save(image="image.pfm")
    rest = flags({name: value for name, value in parameters.items() if name != "scene"})
    results = "--stats stats.json --hits hits.csv -o image.png --page page.html --plot plots --ops run.ops"
    ended = command(two / "theirs", "image", parameters["scene"], *rest, *results.split())
    assert ended.status == 0, ended.err
    again = command(two / "theirs", "image", parameters["scene"], *rest, "-o", "image.pfm")
    assert again.status == 0, again.err
    same(two, ["stats.json", "hits.csv", "image.png", "image.pfm", "page.html", "plots/cells.svg", "run.ops"])
    assert ended.out.startswith(str(run))
    pfm = (two / "theirs" / "image.pfm").read_bytes()
    assert run.image is not None
    assert pfm.endswith(run.image[::-1].astype("<f4").tobytes())


def test_an_image_without_timing(two: Path) -> None:
    run = pcs_sim.image("room", size=8, timing="off")
    run.save(image="image.png")
    assert command(two / "theirs", *"image room --size 8x8 --timing off -o image.png".split()).status == 0
    same(two, ["image.png"])
    assert not hasattr(run, "cycles")
    assert "image without timing" in run._repr_html_()


def test_replays(two: Path) -> None:
    for folder in ["ours", "theirs"]:
        pcs_sim.run("room", size="16x12", ops=two / folder / "run.ops")
    run = pcs_sim.replay("run.ops", fifo_words=8, grid_voxel=3.9)
    run.save(stats="stats.json", page="page.html", trace="trace.fst")
    arguments = "replay run.ops --fifo-words 8 --grid-voxel 3.9 --stats stats.json --page page.html --trace trace.fst"
    ended = command(two / "theirs", *arguments.split())
    assert ended.status == 0, ended.err
    same(two, ["stats.json", "page.html", "trace.fst"])
    assert ended.out.startswith(str(run))
    repeated = pcs_sim.replay(config=run, fifo_words=16)
    arguments = "replay --config stats.json --fifo-words 16 --stats again.json"
    assert command(two / "theirs", *arguments.split()).status == 0
    repeated.save(stats="again.json")
    same(two, ["again.json"])
    assert pcs_sim.replay("run.ops", fifo_words=512).cycles == pcs_sim.run("room", size="16x12").cycles


def test_a_replay_on_a_machine_at_hand(two: Path) -> None:
    for folder in ["ours", "theirs"]:
        pcs_sim.run("room", size="8x8", ops=two / folder / "run.ops")
    machine = {**pcs_sim.Machine().to_dict(), "fifo_words": 9}
    machine["times_us"] = {**machine["times_us"], "grid_voxel": 3.0}
    (two / "theirs" / "m.ron").write_text("(" + json.dumps(machine)[1:-1].replace('"Link"', "Link") + ")")
    ours = pcs_sim.replay("run.ops", machine=machine)
    assert ours.cycles == pcs_sim.run("room", size=8, machine=pcs_sim.Machine(machine)).cycles
    assert ours.cycles != pcs_sim.run("room", size=8, fifo_words=9).cycles


def test_models(two: Path) -> None:
    model = pcs_sim.model("room", size="24x18", mode="broadcast", cells=4)
    model.save("model.json")
    ended = command(two / "theirs", *"model room --size 24x18 --mode broadcast --cells 4 --stats model.json".split())
    assert ended.status == 0, ended.err
    same(two, ["model.json"])
    assert ended.out.startswith(str(model))
    alone = pcs_sim.model("room", size="24x18", predict_only=True)
    ended = command(two / "theirs", *"model room --size 24x18 --predict-only".split())
    assert ended.out == str(alone)


@pytest.mark.parametrize(
    "parameters",
    [
        {"size": "32x32", "tasks": 3},
        {"scene": "room", "size": "16x12", "tasks": 2, "items": "tiles", "tile": 4, "samples": 2},
    ],
)
def test_farms(two: Path, parameters: dict[str, Any]) -> None:
    run = pcs_sim.farm(**parameters)
    run.save(stats="stats.json", page="page.html", plot="plots", trace="trace.pftrace")
    arguments = [parameters.get("scene", "rectangles"), *flags({**parameters, "scene": None})]
    del arguments[arguments.index("--scene") : arguments.index("--scene") + 2]
    results = "--stats stats.json --page page.html --plot plots --trace trace.pftrace"
    ended = command(two / "theirs", "farm", *arguments, *results.split())
    assert ended.status == 0, ended.err
    same(two, ["stats.json", "page.html", "plots/tasks.svg", "plots/latency.svg", "trace.pftrace"])
    assert ended.out.startswith(str(run))
    assert run.plot().name == "tasks"
    assert "<svg" in run._repr_html_()
    assert run.stats["workers"] == parameters["tasks"]
    assert pcs_sim.farm(config=run).stats == run.stats
    assert list(run.cells["runs"]) == [task["name"] for task in run.stats["tasks"]]
    for name in ["hits", "counts", "image", "rays", "rays_per_second"]:
        assert not hasattr(run, name)


def test_why_farms_take_as_long(two: Path) -> None:
    run = pcs_sim.farm(size=24, tasks=2, why=True)
    run.save(stats="stats.json", page="page.html", plot="plots")
    asked = "farm rectangles --size 24x24 --tasks 2 --why --stats stats.json --page page.html --plot plots"
    ended = command(two / "theirs", *asked.split())
    assert ended.status == 0, ended.err
    same(two, ["stats.json", "page.html", "plots/critical-path.svg"])
    assert ended.out.startswith(str(run))
    assert sum(part["cycles"] for part in run.stats["why"]["parts"]) == run.stats["cycles"]


def test_why_a_hypercube_takes_as_long(two: Path) -> None:
    run = pcs_sim.ipsc2("room", size=16, nodes=4, why=True)
    run.save(stats="stats.json")
    ended = command(two / "theirs", *"ipsc2 room --size 16x16 --nodes 4 --why --stats stats.json".split())
    assert ended.status == 0, ended.err
    same(two, ["stats.json"])
    assert sum(part["cycles"] for part in run.stats["why"]["parts"]) == run.stats["cycles"]


def test_sweeps_of_farms() -> None:
    table = pcs_sim.sweep({"size": 16, "tasks": [1, 2, 4], "items": "lines"})
    assert list(table["tasks"]) == [1, 2, 4]
    assert list(table["seconds"]) == [pcs_sim.farm(size=16, tasks=tasks, items="lines").seconds for tasks in [1, 2, 4]]


SWEEP: dict[str, Any] = {
    "scene": "room",
    "size": [8, "16x12"],
    "mode": ["pipeline", "broadcast"],
    "fifo_words": {"from": 8, "to": 32, "times": 2},
    "cells": 3,
    "memory_words": [1000, 100000],
}


def test_sweeps(two: Path) -> None:
    ron = """(scene: "room", size: [8, "16x12"], mode: ["pipeline", "broadcast"],
        fifo_words: (from: 8, to: 32, times: 2), cells: 3, memory_words: [1000, 100000])"""
    (two / "theirs" / "sweep.ron").write_text(ron)
    ended = command(two / "theirs", "sweep", "sweep.ron", "-o", "table.csv")
    assert (ended.status, "12 of 24" in ended.err) == (1, True), "points that fail are counted"
    table = pcs_sim.sweep(SWEEP, table="table.csv")
    same(two, ["table.csv", "table.parquet"])
    assert len(table) == 24
    assert any(table.to_dict()["error"])
    assert pcs_sim.sweep(SWEEP).to_dict() == table.to_dict()
    assert pcs_sim.sweep(SWEEP, recording_memory="0kB").to_dict() == table.to_dict()
    # The command goes on with what the module began, and the other way round.
    journal = (two / "ours" / "table.journal").read_bytes()
    assert sorted(journal.splitlines()) == sorted((two / "theirs" / "table.journal").read_bytes().splitlines())
    (two / "ours" / "table.journal").write_bytes(b"".join(journal.splitlines(keepends=True)[:7]))
    assert pcs_sim.sweep(SWEEP, table="table.csv").to_dict() == table.to_dict()
    same(two, ["table.csv", "table.parquet"])
    begun = journal.splitlines(keepends=True)[:9]
    (two / "theirs" / "table.journal").write_bytes(b"".join(begun))
    ended = command(two / "theirs", "sweep", "sweep.ron", "-o", "table.csv")
    done = sum(not json.loads(point)[1][-1] for point in begun[1:])
    assert f"({24 - done} now)" in ended.out, "points that failed are tried again"
    same(two, ["table.csv", "table.parquet"])
    assert pcs_sim.sweep(two / "theirs" / "sweep.ron").to_dict() == table.to_dict()


def test_configurations(two: Path) -> None:
    run = pcs_sim.run("room", size=8, mode="broadcast", cells=2)
    run.save(stats=two / "theirs" / "stats.json")
    ended = command(two / "theirs", *"--config stats.json --fifo-words 7 --stats again.json".split())
    assert ended.status == 0, ended.err
    expected = json.loads((two / "theirs" / "again.json").read_text())
    for config in [run, run.stats, run.config, run.stats["configuration"], two / "theirs" / "stats.json"]:
        assert pcs_sim.run(config=config, fifo_words=7).stats == expected


def test_machines_and_programs_as_values(two: Path) -> None:
    expected = pcs_sim.run("room", size=8, mode="hybrid", cells=4, fifo_words=20).stats
    machine, program = pcs_sim.Machine(fifo_words=20), pcs_sim.Program("hybrid")
    (two / "ours" / "p.ron").write_text(
        '(name: "hybrid", groups: 4, stages: [[grid, slabs], [intersection]], partition: regular)'
    )
    machines: list[Any] = [machine, machine.to_dict(), pcs_sim.Machine(machine.to_dict()), pcs_sim.Machine(machine)]
    programs: list[Any] = [program, program.to_dict(), "hybrid", pcs_sim.Program(program.to_dict())]
    for given, known in zip(machines, programs):
        assert pcs_sim.run("room", size=8, machine=given, program=known, cells=4).stats == expected
    assert pcs_sim.Program("p.ron").to_dict()["stages"] == program.to_dict()["stages"]
    assert machine == pcs_sim.Machine(machine)
    assert machine != pcs_sim.Machine()


GRAPHS: list[tuple[str, dict[str, Any], dict[str, Any], str]] = [
    ("run", {"size": "16x12", "mode": "broadcast", "cells": 3}, {}, ""),
    (
        "run",
        {"size": "16x12"},
        {"of": "polygons", "pixels": ((3, 9), (2, 5))},
        "--graph-of polygons --graph-pixels 3..9,2..5",
    ),
    (
        "image",
        {"size": "16x12", "rules": "own+a4b", "mode": "broadcast", "cells": 4},
        {"of": "objects", "pixels": ((3, 9), (2, 5))},
        "--graph-of objects --graph-pixels 3..9,2..5",
    ),
    ("ipsc2", {"size": "16x12", "nodes": 4}, {"pixels": ((3, 9), (2, 5))}, "--graph-pixels 3..9,2..5"),
]


@pytest.mark.parametrize(("call", "parameters", "asked", "asked_for"), GRAPHS)
def test_graphs(two: Path, call: str, parameters: dict[str, Any], asked: dict[str, Any], asked_for: str) -> None:
    run = getattr(pcs_sim, call)("room", **parameters)
    graphs = run.graphs(**asked)
    words = {"run": ["--scene", "room"], "image": ["image", "room", "-o", "i.png"], "ipsc2": ["ipsc2", "room"]}[call]
    results = f"--graphs g --graph-format json,graphml {asked_for}"
    ended = command(two / "theirs", *words, *flags(parameters), *results.split())
    assert ended.status == 0, ended.err
    folder = two / "theirs" / "g"
    assert graphs == {
        name: json.loads((folder / f"{name}.json").read_text()) for name in ["G_r", "G_v", "G_p", "classification"]
    }
    # What libraries read of both forms is one graph.
    for name in ["G_r", "G_v", "G_p"]:
        graph = networkx.node_link_graph(graphs[name], edges="edges")
        read = networkx.read_graphml(folder / f"{name}.graphml")
        assert dict(graph.nodes(data=True)) == dict(read.nodes(data=True))
        assert sorted(map(str, graph.edges(data=True))) == sorted(map(str, read.edges(data=True)))
    pixels = graphs["G_v"]["nodes"]
    assert any("start_cycle" in node for node in pixels) == ("pixels" in asked)


def test_graphs_that_there_are_not() -> None:
    run = pcs_sim.run("room", size=8)
    wrong: list[dict[str, Any]] = [{"of": "lights"}, {"pixels": ((4, 4), (0, 2))}, {"pixels": ((4, 9), (0, 2))}]
    for asked in wrong:
        with pytest.raises(pcs_sim.InputError):
            run.graphs(**asked)
    for none in [pcs_sim.farm(size=16, tasks=2), pcs_sim.image("room", size=8, timing="off")]:
        with pytest.raises(AttributeError, match="graphs"):
            none.graphs()


def test_hits(two: Path) -> None:
    run = pcs_sim.run("tetra", size="16x12")
    run.save(hits="hits.csv")
    rows = [line.split(",") for line in (two / "ours" / "hits.csv").read_text().splitlines()[1:]]
    hits = run.hits
    assert len(hits) == len(rows) == run.rays
    assert [np.float32(row[1] or "inf") for row in rows] == list(hits["t"])
    assert [int(row[2] or -1) for row in rows] == list(hits["polygon"])
    assert (hits["polygon"] >= 0).sum() == run.counts["hits"]


def test_what_a_replay_does_not_have() -> None:
    Path("loop.ops").write_text(LOOP)
    run = pcs_sim.replay("loop.ops", fifo_words=600)
    for name in ["hits", "counts", "image"]:
        assert not hasattr(run, name)


def test_why(two: Path) -> None:
    parameters: dict[str, Any] = {"scene": "room", "size": "16x12", "mode": "broadcast", "cells": 3, "fifo_words": 16}
    why = pcs_sim.why(**parameters, enough=True)
    why.run.save(stats="stats.json", page="page.html", plot="plots")
    results = "--enough --stats stats.json --page page.html --plot plots"
    ended = command(two / "theirs", "why", *flags(parameters), *results.split())
    assert ended.status == 0, ended.err
    same(two, ["stats.json", "page.html", "plots/critical-path.svg"])
    assert ended.out.startswith(str(why))
    told = why.run.stats["why"]
    assert (told["sentence"], why.cycles) == (why.sentence, why.run.cycles)
    for table, rows in [(why.times, told["times"]), (why.parts, told["parts"])]:
        assert sum(table["cycles"]) == why.cycles
        assert list(table["cycles"]) == [row["cycles"] for row in rows]
        assert list(table["count"]) == [row["count"] for row in rows]
    assert list(why.run.fifos["enough"]) == [fifo["enough"] for fifo in why.run.stats["fifos"]]
    by_cell = pcs_sim.why(**parameters, by_cell=True)
    assert command(two / "theirs", "why", *flags(parameters), "--by-cell").out == str(by_cell)
    assert set(by_cell.times["at"]) > {"cell 0", "cell 1"}
    run = pcs_sim.run(**parameters, why=True, ops="run.ops")
    assert run.stats["why"] == told
    again = pcs_sim.why(ops="run.ops", fifo_words=16)
    assert list(again.parts["cycles"]) == list(why.parts["cycles"])
    assert pcs_sim.replay("run.ops", fifo_words=16, why=True, enough=True).stats["fifos"] == why.run.stats["fifos"]
    image = pcs_sim.image("room", size=8, why=True, enough=True)
    ended = command(two / "theirs", *"image room --size 8x8 -o a.png --why --enough".split())
    assert ended.out.startswith(str(image))


def test_why_in_one_moment(two: Path) -> None:
    parameters: dict[str, Any] = {"scene": "room", "size": "16x12", "mode": "broadcast", "cells": 3, "fifo_words": 16}
    moments: list[dict[str, Any]] = [{"cell": 0, "ray": 100}, {"cell": "host", "at": "0.2ms"}, {"cell": 2, "at": 5000}]
    for asked in moments:
        why = pcs_sim.why(**parameters, **asked)
        assert command(two / "theirs", "why", *flags({**parameters, **asked})).out == str(why)
        assert why.waits is not None
        assert [wait["text"] for wait in why.waits] == str(why).replace("\n  ", " ").splitlines()[-len(why.waits) :]
        assert why.waits[0]["actor"] == ("the host" if asked["cell"] == "host" else f"cell {asked['cell']}")
        assert all(wait["does"] == "waits" for wait in why.waits[:-1])
    assert pcs_sim.why(**parameters).waits is None


@pytest.mark.parametrize("speed", [None, 99, [99, 97.5]])
def test_sizes(two: Path, speed: Any) -> None:
    parameters: dict[str, Any] = {"scene": "room", "size": "16x12", "mode": "broadcast", "cells": 3}
    sizes = pcs_sim.size_fifos(**parameters, speed=speed)
    written = sizes.save("t.csv", plot=True, machines=True)
    asked = [] if speed is None else [f"--speed={one}" for one in (speed if isinstance(speed, list) else [speed])]
    results = "-o t.csv --plot --machines"
    ended = command(two / "theirs", "size-fifos", *flags(parameters), *asked, *results.split())
    assert ended.status == 0, ended.err
    same(two, [path.name for path in written])
    assert ended.out == f"{sizes}" + "".join(f"wrote {path}\n" for path in written)
    fewest = sizes.words(99)
    assert sizes.machine(99).to_dict()["fifo_words_of"] == fewest
    run = pcs_sim.run(**parameters, machine=sizes.machine(99))
    assert dict(zip(run.fifos["name"], run.fifos["capacity"])) == fewest
    table = sizes.table.to_dict()
    row = next(row for row, wanted in enumerate(table["speed_wanted"]) if wanted == 0.99)
    assert table["cycles"][row] == run.cycles
    assert set(sizes.plots()) == {"front", "depths"}
    pcs_sim.run(**parameters, ops="run.ops")
    assert pcs_sim.size_fifos(ops="run.ops", speed=speed).table.to_dict() == sizes.table.to_dict()
