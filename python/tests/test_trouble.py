"""What is wrong is said in the command's words, and nothing is left behind."""

from __future__ import annotations

import contextlib
from pathlib import Path
from typing import Any, Callable

import numpy as np
import pytest

import pcs_sim

from .support import LOOP, command, words

MACHINE = "(clock_ns: 50.0, word_bytes: 4, fifo_wrods: 512)"

REFUSED: list[tuple[dict[str, Any], str]] = [
    ({"scene": "teapto"}, "--scene teapto"),
    ({"scene": "nowhere.ply"}, "--scene nowhere.ply"),
    ({"scene": "scene.gif"}, "--scene scene.gif"),
    ({"scene": "empty.obj"}, "--scene empty.obj"),
    ({"scene": "wrong.obj"}, "--scene wrong.obj"),
    ({"scene": "tetra", "size_factor": 40}, "--scene tetra --size-factor 40"),
    ({"scene": "room", "resolution": 8}, "--scene room --resolution 8"),
    ({"fifo_words": 0}, "--fifo-words 0"),
    ({"link_mb_s": 0}, "--link-mb-s 0"),
    ({"clock_ns": -5.0}, "--clock-ns=-5"),
    ({"grid_voxel": float("inf")}, "--grid-voxel inf"),
    ({"grid_coefficient": float("nan")}, "--grid-coefficient nan"),
    ({"mode": "broadcast", "cells": 0}, "--mode broadcast --cells 0"),
    ({"mode": "hybrid", "cells": 5}, "--mode hybrid --cells 5"),
    ({"mode": "pipeline", "cells": 6}, "--mode pipeline --cells 6"),
    ({"scene": "room", "mode": "broadcast", "cells": 64}, "--scene room --mode broadcast --cells 64"),
    ({"mode": "broadcast", "cells": 5000}, "--mode broadcast --cells 5000"),
    ({"scene": "room", "memory_words": 1000}, "--scene room --memory-words 1000"),
    ({"program": "nowhere.ron"}, "--program nowhere.ron"),
    ({"program": "hybird"}, "--program hybird"),
    ({"machine": "nowhere.ron"}, "--machine nowhere.ron"),
    ({"machine": "wrong.ron"}, "--machine wrong.ron"),
    ({"config": "nowhere.json"}, "--config nowhere.json"),
    ({"config": "wrong.ron"}, "--config wrong.ron"),
    ({"config": "image.json"}, "--config image.json"),
    ({"rays": "wrong.csv"}, "--rays wrong.csv --scene room"),
    ({"rays": "nowhere.csv"}, "--rays nowhere.csv --scene room"),
    ({"cells_run": "programs", "cell_programs": "nowhere"}, "--cells-run programs --cell-programs nowhere"),
    # What a run would not look at.
    ({"partition": "work"}, "--partition work"),
    ({"host_hit_us": 3.0}, "--host-hit-us 3"),
    ({"instruction_limit": 5}, "--instruction-limit 5"),
    ({"cells_run": "programs", "grid_start": 5.0}, "--cells-run programs --grid-start 5"),
]


@pytest.fixture
def files(folder: Path) -> Path:
    """A folder with files of all sorts."""
    (folder / "empty.obj").write_text("v 0 0 0\n")
    (folder / "wrong.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n")
    (folder / "wrong.ron").write_text(MACHINE)
    (folder / "wrong.csv").write_text("ox,oy,oz,dx,dy,dz\n0,0,0,0,0,1\n0,NaN,0,0,0,1\n")
    (folder / "loop.ops").write_text(LOOP)
    pcs_sim.image("room", size=2).save(stats="image.json")
    return folder


def said(error: pcs_sim.InputError, told: str) -> None:
    """Checks that what the command told has all of an error."""
    told = words(told)
    assert words(error.message) in told
    assert words(error.help or "") in told
    if error.file is not None:
        assert error.file in told
    if error.line is not None:
        assert f"{error.file}:{error.line}:{error.column}" in told


@pytest.mark.parametrize(("parameters", "arguments"), REFUSED, ids=[arguments for _, arguments in REFUSED])
def test_runs_that_are_refused(files: Path, parameters: dict[str, Any], arguments: str) -> None:
    before = sorted(files.iterdir())
    with pytest.raises(pcs_sim.InputError) as caught:
        pcs_sim.run(**{"scene": "teapot", **parameters}, ops="run.ops")
    assert isinstance(caught.value, ValueError)
    assert sorted(files.iterdir()) == before
    ended = command(files, *arguments.split(), "--ops", "run.ops")
    assert ended.status == 2
    said(caught.value, ended.err)


ELSEWHERE: list[tuple[Callable[[], object], str]] = [
    (lambda: pcs_sim.image("room", samples=99), "samples along a side of a pixel"),
    (lambda: pcs_sim.image("room", adaptive=True), "--adaptive has nothing to refine"),
    (lambda: pcs_sim.image("room", timing="off", policy="primaries"), "--policy is about the machine at work"),
    (lambda: pcs_sim.image("room", timing="off", ops="x.ops"), "--ops is about the machine at work"),
    (lambda: pcs_sim.image("room", policy="none"), "invalid value 'none' for policy"),
    (lambda: pcs_sim.image("room", rays="x.csv"), "unknown parameter `rays`"),  # type: ignore[call-arg]
    (lambda: pcs_sim.image("room", min_contribution=2), "least contribution is 2"),
    (lambda: pcs_sim.replay("nowhere.ops"), "cannot read the file"),
    (lambda: pcs_sim.replay("wrong.csv"), "wrong.csv"),
    (lambda: pcs_sim.replay("loop.ops", memory_words=5), "--memory-words is held against a scene"),
    (lambda: pcs_sim.replay("loop.ops", cells=5), "unknown parameter `cells`"),  # type: ignore[call-arg]
    (lambda: pcs_sim.replay(), "a replay needs a trace"),
    (lambda: pcs_sim.replay(config={"ops": 5}), "describes no replay"),
    (lambda: pcs_sim.farm(tasks="1..4"), "of one number of workers, not of a range"),  # type: ignore[arg-type]
    (lambda: pcs_sim.farm(tasks=0), "there must be at least 1 worker"),
    (lambda: pcs_sim.farm(tile=4), "--tile is about tiles"),
    (lambda: pcs_sim.farm(fifo_words=4), "unknown parameter `fifo_words`"),  # type: ignore[call-arg]
    (lambda: pcs_sim.farm(config="image.json"), "describes no farm"),
    (lambda: pcs_sim.model("room", mailbox=True), "the cost model knows no mailbox"),  # type: ignore[call-arg]
    (lambda: pcs_sim.model("room", predict_only=True, threads=2), "--threads is about the simulation"),
    (lambda: pcs_sim.model("room", predict_only=True, memory_words=2), "--memory-words is about the simulation"),
    (lambda: pcs_sim.model(config="image.json"), "that of a whole image"),
    (lambda: pcs_sim.run("room", fifo_wrods=8), r"did you mean `fifo_words`\?"),  # type: ignore[call-arg]
    (lambda: pcs_sim.run("room", samples=2), "unknown parameter `samples`"),  # type: ignore[call-arg]
    (lambda: pcs_sim.run("room", threads=0), "threads is 0"),
    (lambda: pcs_sim.run("room", ops="x.ops", ops_form="words"), "invalid value 'words' for ops_form"),
    (lambda: pcs_sim.run("room", size="12"), "invalid value '12' for size"),
    (lambda: pcs_sim.run("room", size=(8, 8, 8)), "expected a size"),  # type: ignore[arg-type]
    (lambda: pcs_sim.run("room", size=-3), "invalid value '-3x-3' for size"),
    (lambda: pcs_sim.run("room", size=2**70), "for size"),
    (lambda: pcs_sim.run("room", mailbox="perhaps"), "invalid value 'perhaps' for mailbox"),  # type: ignore[arg-type]
    (lambda: pcs_sim.run("room", cells=2.5), "invalid value '2.5' for cells"),  # type: ignore[arg-type]
    (lambda: pcs_sim.run("room", cells=[1, 2]), "expected a whole number"),  # type: ignore[arg-type]
    (lambda: pcs_sim.run("room", cells=np.arange(3)), "expected a whole number"),  # type: ignore[arg-type]
    (lambda: pcs_sim.run("room", scene=5), "multiple values"),  # type: ignore[misc, arg-type]
    (lambda: pcs_sim.run(5), "there is no built-in scene `5`"),  # type: ignore[arg-type]
    (lambda: pcs_sim.run(b"room"), "expected a text"),  # type: ignore[arg-type]
    (lambda: pcs_sim.run("room", mode="pipeline", program="hybrid"), "mode and program cannot both be given"),
    (lambda: pcs_sim.run("room", mode="pipeline", program=pcs_sim.Program("hybrid")), "cannot both be given"),
    (lambda: pcs_sim.run("room", cells=4, groups=2, mode="broadcast"), "cells and groups cannot both be given"),
    (lambda: pcs_sim.run("room", rays=np.ones((2, 6)), size=8), "rays and size cannot both be given"),
    (lambda: pcs_sim.run("room", rays=np.ones((2, 5))), "rays: expected n x 6 numbers"),
    (lambda: pcs_sim.run("room", rays=np.ones(6)), "not 6"),
    (lambda: pcs_sim.run("room", rays=np.zeros((2, 6))), "ray 0: the direction is zero"),
    (lambda: pcs_sim.run("room", rays=np.full((2, 6), np.nan)), "not a finite number"),
    (lambda: pcs_sim.run("room", rays=np.zeros((0, 6))), "from 1 to"),
    (lambda: pcs_sim.run("room", rays=[["a"]]), "rays: could not convert"),
    (lambda: pcs_sim.run("room", machine={"clock_ns": 50.0}), "describes no machine: missing field"),
    (lambda: pcs_sim.run("room", machine={**pcs_sim.Machine().to_dict(), "fifo_words": 0}), "impossible machine"),
    (lambda: pcs_sim.run("room", machine={"x": object()}), "expected a text, a number"),
    (lambda: pcs_sim.run("room", program={"name": "p", "groups": 0, "stages": [["grid"]]}), "the stages must run"),
    (lambda: pcs_sim.run(config={"x": 1}), "describes no run"),
    (lambda: pcs_sim.run(config={"x": float("nan")}), "not JSON compliant"),
    (lambda: pcs_sim.Machine(fifo_words=0), "impossible machine: fifo_words is 0"),
    (lambda: pcs_sim.Machine(cells=0), "unknown parameter `cells`"),  # type: ignore[call-arg]
    (lambda: pcs_sim.Program("nowhere.ron"), "cannot read the file"),
    (lambda: pcs_sim.Scene([[0, 0, 0]], []), "empty scene"),
    (lambda: pcs_sim.Scene([[0, 0]], [[0, 0, 0]]), "points: expected n x 3 numbers, not 1 x 2"),
    (lambda: pcs_sim.Scene(np.eye(3), [[0, 1, 3]]), "face 0: there is no point 3"),
    (lambda: pcs_sim.Scene(np.eye(3), [[0, 1, -1]]), "face 0: there is no point -1"),
    (lambda: pcs_sim.Scene(np.eye(3), [[0, 1.5, 2]]), "faces: expected rows of whole numbers"),
    (lambda: pcs_sim.Scene(np.eye(3), 5), "faces: expected rows of whole numbers"),
    (lambda: pcs_sim.Scene(np.full((3, 3), np.inf), [[0, 1, 2]]), "point 0: .* is not a finite number"),
    (lambda: pcs_sim.Scene(np.eye(3) * 1e30, [[0, 1, 2]]), "too large"),
    (lambda: pcs_sim.Scene(np.eye(3), [[0, 1, 2]], colors=np.eye(3)[:2]), "3 points and 2 colours"),
    (lambda: pcs_sim.Scene(np.eye(3), [[0, 1, 2]], colors=-np.eye(3)), "colour 0: -1 is negative"),
    (lambda: pcs_sim.Scene(np.eye(3), [[0, 1, 2]], eye=(1, 1, 1)), "both eye and at"),
    (lambda: pcs_sim.Scene(np.eye(3), [[0, 1, 2]], eye=(1, 1, 1), at=(1, 1, 1)), "the very point that it looks at"),
    (lambda: pcs_sim.Scene(np.eye(3), [[0, 1, 2]], eye=(1, 1, 1), at=(0, 0, 0), angle=180), "camera's angle"),
    (lambda: pcs_sim.run(pcs_sim.Scene(np.eye(3), [[0, 1, 2]]), size_factor=2), "size_factor is for scenes"),
    (lambda: pcs_sim.why("room", cell=0), "a moment is said by cell and either at or ray"),
    (lambda: pcs_sim.why("room", at=5), "a moment is said by cell and either at or ray"),
    (lambda: pcs_sim.why("room", cell="host", ray=5), "a moment is said by cell and either at or ray"),
    (lambda: pcs_sim.why("room", cell="x", at=5), "invalid value 'x' for cell: expected the number of a cell, or host"),
    (lambda: pcs_sim.why("room", cell=0, at="5 days"), "invalid value '5 days' for at: expected a cycle, or a time"),
    (lambda: pcs_sim.why("room", size=2, cell=9, at=5), "there is no cell 9"),
    (lambda: pcs_sim.why("room", size=2, cell=0, at="99s"), "the run is over before cycle"),
    (lambda: pcs_sim.why("room", ops="loop.ops"), "scene is about tracing a scene"),
    (lambda: pcs_sim.why(ops="loop.ops", mode="broadcast"), "--mode is about tracing a scene"),
    (lambda: pcs_sim.why(ops="nowhere.ops"), "cannot read the file"),
    (lambda: pcs_sim.size_fifos("room", fifo_words=4), "--fifo-words is what is sought here"),
    (lambda: pcs_sim.size_fifos("room", speed=101), "speeds are from 50 to 100 %"),
    (lambda: pcs_sim.size_fifos("room", speed="fast"), "speed: expected a number"),  # type: ignore[arg-type]
    (lambda: pcs_sim.size_fifos("room", ops="loop.ops"), "--scene is about what the trace has recorded"),
    (lambda: pcs_sim.size_fifos("room", size=2, speed=99).words(95), "no machine was sought for 95 %"),
    (lambda: pcs_sim.size_fifos("room", size=2, speed=99).save("t.txt"), "must end in .csv or .parquet"),
    (lambda: pcs_sim.image("room", size=2, timing="off", enough=True), "--enough is about the machine at work"),
    (lambda: pcs_sim.sweep({"fifo_wrods": [8]}), r"did you mean `fifo_words`\?"),
    (lambda: pcs_sim.sweep({"cells": [3]}, recording_memory="much"), "invalid value 'much' for recording_memory"),
    (lambda: pcs_sim.sweep({"fifo_words": "many"}), "fifo_words: .*expected a whole number"),
    (lambda: pcs_sim.sweep({"fifo_words": {"from": 1}}), "fifo_words: missing field"),
    (lambda: pcs_sim.sweep({"fifo_words": []}), "a list needs at least one value"),
    (lambda: pcs_sim.sweep({"fifo_words": {"from": 1, "to": 9}}), "a step above 0"),
    (
        lambda: pcs_sim.sweep({"size": list(range(1, 2000)), "fifo_words": list(range(1, 2000))}),
        "may have up to 1000000",
    ),
    (lambda: pcs_sim.sweep([1, 2]), "a sweep is"),  # type: ignore[arg-type]
    (lambda: pcs_sim.sweep("nowhere.ron"), "cannot read the file"),
    (lambda: pcs_sim.sweep({"scene": "room", "size": 2}, table="table.txt"), "must end in .csv or .parquet"),
    (lambda: pcs_sim.run("room", size=2).save(stats="nowhere/s.json"), "there is no folder nowhere"),
    (lambda: pcs_sim.run("room", size=2).save(stats="loop.ops"), "the file exists already"),
    (lambda: pcs_sim.run("room", size=2).save(image="picture.jpg"), "images end in .png or .pfm"),
    (lambda: pcs_sim.run("room", size=2).save(trace="t.txt"), "is no name of a trace"),
    (lambda: pcs_sim.run("room", size=2).save(trace="t.vcd", trace_window=(9, 9)), "trace_window has no cycle"),
    (lambda: pcs_sim.run("room", rays=np.ones((2, 6))).save(image="picture.png"), "none of a picture"),
]


@pytest.mark.parametrize(("call", "expected"), ELSEWHERE, ids=[expected for _, expected in ELSEWHERE])
def test_other_calls_that_are_refused(files: Path, call: Callable[[], object], expected: str) -> None:
    before = sorted(files.iterdir())
    with pytest.raises((pcs_sim.InputError, TypeError), match=expected) as caught:
        call()
    assert isinstance(caught.value, pcs_sim.InputError) or "multiple" in str(caught.value)
    assert sorted(files.iterdir()) == before


def test_results_are_replaced_only_if_that_is_meant(files: Path) -> None:
    run = pcs_sim.run("room", size=2)
    run.save(stats="s.json")
    before = (files / "s.json").read_bytes()
    with pytest.raises(pcs_sim.InputError, match="the file exists already"):
        pcs_sim.run("room", size=4).save(stats="s.json")
    assert (files / "s.json").read_bytes() == before
    pcs_sim.run("room", size=4).save(stats="s.json", force=True)
    assert (files / "s.json").read_bytes() != before


def test_a_deadlock(files: Path) -> None:
    with pytest.raises(pcs_sim.Deadlock) as caught:
        pcs_sim.replay("loop.ops")
    told = command(files, "replay", "loop.ops").err
    assert [line.strip() for line in told.splitlines()] == [
        "error: deadlock",
        *[wait["text"] for wait in caught.value.waits],
        f"= help: {caught.value.help}",
    ]
    assert caught.value.kind == "deadlock"
    first, second = caught.value.waits
    assert (first["actor"], first["on"], second["actor"], second["on"]) == ("cell 0", "cell 1", "cell 1", "cell 0")
    assert (first["for"], first["channel"], first["capacity"], first["since"]) == ("room", "Y", 512, 521)
    assert (second["for"], second["channel"], second["ray"], second["position"]) == ("word", "X", 0, 0)
    (files / "starved.ops").write_text("0 host w8\n0 0 x8 g20 o2\n0 1 x8 i3 o5\n")
    with pytest.raises(pcs_sim.Deadlock) as starved:
        pcs_sim.replay("starved.ops")
    assert starved.value.kind == "starved"


def test_a_fault_of_a_cells_program() -> None:
    with pytest.raises(pcs_sim.CellFault, match="instructions") as caught:
        pcs_sim.run("room", size=2, cells_run="programs", instruction_limit=10)
    assert caught.value.cell == 0


JUNK: list[Any] = [-1, 0, 2**70, -0.5, 1e300, float("nan"), "", "x", "\0", b"x", [], {}, object(), (1, 2), "é", True]


PARAMETERS = pcs_sim.parameters().to_dict()


@pytest.mark.parametrize(
    ("name", "of_run", "of_image"), list(zip(*(PARAMETERS[key] for key in ["name", "run", "image"])))
)
def test_no_value_brings_the_module_down(name: str, of_run: bool, of_image: bool) -> None:
    """Whatever a parameter is, the run ends, or says in the module's own exceptions why not."""
    call: Callable[..., object] = pcs_sim.run if of_run else pcs_sim.image if of_image else pcs_sim.farm
    scene = "room" if of_run or of_image else "rectangles"
    for value in JUNK:
        given = {"scene": scene, "size": 1, "threads": 1, name: value}
        if name == "rays":
            del given["size"]
        with contextlib.suppress(pcs_sim.InputError, pcs_sim.Deadlock, pcs_sim.CellFault):
            call(**given)
