"""Tables and arrays, as other libraries read them, and those that are handed in."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import duckdb
import numpy as np
import pandas as pd
import polars as pl
import pytest

import pcs_sim

from .support import command


@pytest.fixture(scope="module")
def run() -> pcs_sim.Run:
    return pcs_sim.run("room", size="24x18", mode="broadcast", cells=4)


def rows(query: str, **tables: pcs_sim.Table) -> list[Any]:
    """What DuckDB finds in tables."""
    with duckdb.connect() as connection:
        for name, table in tables.items():
            connection.register(name, table)
        return connection.execute(query).fetchall()


def test_tables_in_other_libraries(run: pcs_sim.Run) -> None:
    sweep = pcs_sim.sweep({"scene": "room", "size": 8, "cells": [3, 4], "mailbox": [True, False]})
    for given in [run.cells, run.fifos, sweep, pcs_sim.parameters(), pcs_sim.scenes()]:
        columns = given.to_dict()
        by_polars = pl.DataFrame(given)
        assert by_polars.to_dict(as_series=False) == columns
        by_pandas = pd.DataFrame.from_arrow(given)
        assert list(by_pandas.columns) == given.columns
        assert by_pandas.astype(object).where(by_pandas.notna(), None).to_dict("list") == columns
        by_duckdb = rows("SELECT * FROM given", given=given)
        assert by_duckdb == list(zip(*columns.values()))
        # A stream can be asked for any number of times.
        assert pl.DataFrame(given).equals(by_polars)


def test_queries(run: pcs_sim.Run) -> None:
    fifos = run.fifos
    found = rows("SELECT max(words) FROM fifos WHERE channel = 'Y'", fifos=fifos)
    stats = [fifo["words"] for fifo in run.stats["fifos"] if fifo["name"].startswith("Y")]
    assert found == [(max(stats),)]
    by_its_name = duckdb.sql("SELECT count(*) FROM fifos")
    assert by_its_name is not None
    assert by_its_name.fetchall() == [(len(fifos),)]
    assert list(fifos["name"]) == [fifo["name"] for fifo in run.stats["fifos"]]
    assert list(fifos["mean"]) == [fifo["mean"] for fifo in run.stats["fifos"]]


def test_states_sum_to_the_run(run: pcs_sim.Run) -> None:
    cells = run.cells
    states = [np.asarray(cells[name]) for name in cells.columns[2:]]
    assert (np.sum(states, axis=0) == run.cycles).all()
    lines = run.timelines
    assert sum(int(cycles.sum()) for cycles in lines["cells"].values()) == 4 * run.cycles
    for state, cycles in lines["cells"].items():
        assert list(cycles.sum(axis=1)) == list(cells[state])
    assert lines["rays"].sum() == run.rays
    assert list(lines["fifos"]["max"].max(axis=1)) == list(run.fifos["max"])
    assert list(lines["start"]) == [number * lines["bin"] for number in range(len(lines["rays"]))]
    lengths = np.diff([*lines["start"], run.cycles])
    np.testing.assert_allclose((lines["fifos"]["mean"] * lengths).sum(axis=1) / run.cycles, run.fifos["mean"])


def test_the_timelines_of_a_hypercube_sum_to_the_run() -> None:
    run = pcs_sim.ipsc2("room", size=16, nodes=4)
    lines = run.timelines
    assert sum(int(cycles.sum()) for cycles in lines["cells"].values()) == 5 * run.cycles, "four nodes and the host"
    for state, cycles in lines["cells"].items():
        assert list(cycles.sum(axis=1)) == list(run.cells[state])
    assert list(lines["fifos"]["max"].max(axis=1)) == list(run.fifos["max"])
    lengths = np.diff([*lines["start"], run.cycles])
    np.testing.assert_allclose((lines["fifos"]["mean"] * lengths).sum(axis=1) / run.cycles, run.fifos["mean"])


def test_the_picture(run: pcs_sim.Run) -> None:
    image = run.image
    assert image is not None
    assert image.shape == (18, 24, 3)
    assert image.dtype == np.float32
    assert run.plot().svg == run.plots()["cells"].svg
    assert run.plot("fifos").png.startswith(b"\x89PNG")
    assert "<svg" in run._repr_html_()
    assert "uPlot" in run.page()
    with pytest.raises(KeyError, match="there is no picture 'x'"):
        run.plot("x")
    run.plot().save("cells.svg")
    assert Path("cells.svg").read_text(encoding="utf-8") == run.plot().svg
    with pytest.raises(pcs_sim.InputError, match=r"pictures end in \.svg, \.png or \.pdf"):
        run.plot().save("cells.gif")


POINTS = [[0, 0, 0], [4, 0, 0], [4, 4, 0], [0, 4, 0], [2, 2, 3]]
FACES = [[0, 3, 2, 1], [0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]
OBJ = "".join(f"v {x} {y} {z}\n" for x, y, z in POINTS) + "".join(
    "f " + " ".join(str(point + 1) for point in face) + "\n" for face in FACES
)


def test_scenes_of_arrays(folder: Path) -> None:
    (folder / "scene.obj").write_text(OBJ)
    # Whatever an OBJ file has no word for is left out: its vertical is Y.
    scene = pcs_sim.Scene(np.array(POINTS, dtype=float), FACES, up=(0, 1, 0))
    assert scene.polygons == 5
    read, given = pcs_sim.run("scene.obj", size=24), pcs_sim.run(scene, size=24)
    assert (read.hits == given.hits).all()
    assert (read.cycles, read.counts) == (given.cycles, given.counts)
    assert given.config["scene"] == "scene (arrays)"
    triangles = pcs_sim.Scene(np.array(POINTS), np.array(FACES[1:]), eye=(9, 9, 9), at=(2, 2, 1), angle=30, name="roof")
    run = pcs_sim.image(triangles, size=12)
    assert run.image is not None
    assert run.image.max() > 0
    assert "scene roof (4 polygons)" in str(run)


def test_rays_of_arrays(folder: Path) -> None:
    random = np.random.default_rng(1)
    rays = random.normal(size=(200, 6)) + np.array([5, 5, 5, 0, 0, 0])
    text = "ox,oy,oz,dx,dy,dz\n" + "".join(",".join(repr(float(x)) for x in ray) + "\n" for ray in rays)
    (folder / "rays.csv").write_text(text)
    read, given = pcs_sim.run("room", rays="rays.csv"), pcs_sim.run("room", rays=rays)
    assert (read.hits == given.hits).all()
    assert read.cycles == given.cycles
    assert given.image is None
    short = np.column_stack([rays, np.full(200, 1e-3)])
    assert pcs_sim.run("room", rays=short).counts["hits"] < given.counts["hits"]
    assert command(folder, "--scene", "room", "--rays", "rays.csv", "--hits", "hits.csv").status == 0
    given.save(hits="ours.csv")
    assert (folder / "ours.csv").read_bytes() == (folder / "hits.csv").read_bytes()


def test_values_of_numpy() -> None:
    expected = pcs_sim.run("room", size="8x8", mode="broadcast", cells=2, mailbox=True, grid_voxel=3.9).stats
    given: dict[str, Any] = {
        "size": np.int64(8),
        "cells": np.uint8(2),
        "mailbox": np.bool_(True),
        "grid_voxel": np.float64(3.9),
    }
    assert pcs_sim.run("room", mode="broadcast", **given).stats == expected
    assert pcs_sim.run("room", mode="broadcast", **{**given, "size": (8, 8)}).stats == expected
    table = pcs_sim.sweep({"scene": "room", "size": 8, "fifo_words": np.array([8, 16])})
    assert list(table["fifo_words"]) == [8, 16]
    assert list(pcs_sim.sweep({"scene": "room", "size": 8, "fifo_words": range(8, 10)})["fifo_words"]) == [8, 9]
