"""Threads, signals, memory, speed, notebooks, and what the module says of itself."""

from __future__ import annotations

import os
import re
import signal
import statistics
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import nbformat
import pytest
from nbclient import NotebookClient

import pcs_sim

from .support import ROOT, command


def test_four_threads_at_once() -> None:
    asked: list[dict[str, Any]] = [{"fifo_words": words, "size": "64x48"} for words in [8, 16, 32, 64]] * 3
    alone = [pcs_sim.run("room", **parameters).stats for parameters in asked]
    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(lambda parameters: pcs_sim.run("room", **parameters).stats, asked))
    assert together == alone


def test_the_lock_is_released() -> None:
    counted, ended = 0, threading.Event()

    def count() -> None:
        nonlocal counted
        while not ended.is_set():
            counted += 1
            time.sleep(0.001)

    other = threading.Thread(target=count)
    other.start()
    start = time.perf_counter()
    pcs_sim.run("teapot", size=256)
    seconds = time.perf_counter() - start
    ended.set()
    other.join()
    # It is asleep for most of the time; a thread that waits for the lock would count to 2 or so.
    assert counted > 20 * seconds
    assert counted > 3


def test_the_results_do_not_depend_on_the_threads() -> None:
    assert pcs_sim.run("room", size=64, threads=1).stats == pcs_sim.run("room", size=64, threads=5).stats


STOPPED = """
import pcs_sim, sys, time
print("begun", flush=True)
try:
    {call}
except KeyboardInterrupt:
    print("stopped", flush=True)
print(pcs_sim.run("room", size=8).cycles)
"""


@pytest.mark.parametrize(
    "call",
    [
        'pcs_sim.run("reference", size=2000, ops="run.ops")',
        'pcs_sim.image("room", size=2000, samples=8)',
        'pcs_sim.sweep({"scene": "teapot", "size": list(range(400, 900))}, table="table.csv")',
        'pcs_sim.model("teapot", size=4000)',
        'pcs_sim.run("balls", size_factor=5, resolution=10)',
        'pcs_sim.farm("balls", size_factor=5, resolution=10)',
        'pcs_sim.ipsc2("balls", size_factor=5, resolution=10)',
        'pcs_sim.why("reference", size=1000)',
        'pcs_sim.size_fifos("teapot", size=256, mode="broadcast", cells=8)',
    ],
)
def test_control_c(folder: Path, call: str) -> None:
    """It stops at once, leaves nothing half-written, and the module goes on."""
    program = [sys.executable, "-c", STOPPED.format(call=call)]
    process = subprocess.Popen(program, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=folder)
    assert process.stdout is not None
    assert process.stdout.readline() == "begun\n"
    time.sleep(1.5)
    process.send_signal(signal.SIGINT)
    start = time.perf_counter()
    out, err = process.communicate(timeout=60)
    assert (process.returncode, err) == (0, "")
    assert out.splitlines() == ["stopped", str(pcs_sim.run("room", size=8).cycles)]
    assert time.perf_counter() - start < 10
    assert [path.name for path in folder.iterdir() if path.suffix in {".ops", ".part"}] == []


MEMORY = """
import pcs_sim

def resident():
    with open("/proc/self/statm") as statm:
        return int(statm.read().split()[1]) * 4096

def some(count):
    for number in range(count):
        run = pcs_sim.run("room", size=16, fifo_words=8 + number % 8)
        run.stats, run.cells, run.hits, run.image, str(run)
        if number % 50 == 0:
            run.timelines
            pcs_sim.replay
some(200)
before = resident()
some(1000)
print(resident() - before)
"""


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="Linux tells how much memory a process has")
def test_memory_is_flat_over_a_thousand_runs() -> None:
    grown = int(subprocess.check_output([sys.executable, "-c", MEMORY], text=True))
    # A run of this size is some 100 KB; one in a hundred that stayed would show.
    assert grown < 4 << 20


def test_a_call_costs_next_to_nothing() -> None:
    """All that the smallest of runs takes is less than 2 % of 75 ms, and so is what the call takes of it."""

    def seconds() -> float:
        start = time.perf_counter()
        pcs_sim.run("room", size=1, threads=1)
        return time.perf_counter() - start

    seconds()
    assert statistics.median(seconds() for _ in range(200)) < 0.02 * 0.075


def test_progress(monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> None:
    pcs_sim.run("teapot", size=512, progress=True)
    assert "rays" in capfd.readouterr().err
    pcs_sim.run("teapot", size=512)
    assert capfd.readouterr().err == "", "nobody looks"
    monkeypatch.setitem(sys.modules, "tqdm", None)
    monkeypatch.setitem(sys.modules, "tqdm.auto", None)
    pcs_sim.run("teapot", size=512, progress=True)
    assert capfd.readouterr().err == ""


def test_every_flag_is_a_parameter(folder: Path) -> None:
    """Every parameter is a flag of the command, and every flag that is about the run a parameter."""
    known = pcs_sim.parameters().to_dict()
    results = set(
        "json quiet config stats force watch plot plot-format page trace trace-window why enough image hits ops "
        "ops-form threads colors palette against refined show-rectangles check-rules graphs "
        "graph-format graph-of graph-pixels".split()
    )
    # The module works where it is, and on no cluster.
    clusters = set(
        "engine shards at-once detach slurm-account slurm-memory slurm-partition slurm-time sbatch-arg sbatch-file "
        "sshlogin hosts parallel-arg".split()
    )
    others = {"help", "version", "output", "predict-only"} | results | clusters
    for call in ["run", "image", "model", "replay", "farm"]:
        told = command(folder, *([] if call == "run" else [call]), "--help").out
        flags = {
            next(word for word in words if word.startswith("--")).rstrip(",.").split("=")[0]
            for words in flag_lines(told)
        }
        names = {"--" + name.replace("_", "-") for name, taken in zip(known["name"], known[call]) if taken}
        assert names - {"--scene"} <= flags, call
        assert flags - names <= {f"--{other}" for other in others}, call


def flag_lines(told: str) -> list[list[str]]:
    """The words of the lines of a help that begin with a flag."""
    lines = [line.split() for line in told.splitlines()]
    return [words for words in lines if words and (words[0].startswith("--") or re.fullmatch("-[a-zA-Z],", words[0]))]


def test_the_stubs_are_up_to_date() -> None:
    ended = subprocess.run(
        [sys.executable, "-c", "import write_stubs; print(write_stubs.text(), end='')"],
        cwd=ROOT / "python",
        capture_output=True,
        text=True,
        check=True,
    )
    stubs = (ROOT / "python" / "lib" / "pcs_sim" / "_parameters.pyi").read_text(encoding="utf-8")
    assert stubs == ended.stdout, "python/write_stubs.py writes them"


def test_everything_is_documented() -> None:
    for name in pcs_sim.__all__:
        thing = getattr(pcs_sim, name)
        assert name == "__version__" or thing.__doc__
        if isinstance(thing, type) and not issubclass(thing, Exception):
            for attribute in vars(thing):
                assert attribute.startswith("_") or getattr(thing, attribute).__doc__, f"{name}.{attribute}"
    manual = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
    for name in set(pcs_sim.__all__) - {"__version__"}:
        assert f"`{name}" in manual or f"pcs_sim.{name}" in manual, name


def test_the_manuals_examples_run(folder: Path) -> None:
    """Every example of the manual runs, each after those before it."""
    manual = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
    (folder / "examples.py").write_text(
        "\n".join(part.split("```")[0] for part in manual.split("```python\n")[1:]), encoding="utf-8"
    )
    subprocess.run([sys.executable, "examples.py"], cwd=folder, check=True, capture_output=True)


@pytest.mark.parametrize("path", sorted((ROOT / "examples").glob("*.ipynb")), ids=lambda path: path.name)
def test_notebooks_run_from_top_to_bottom(folder: Path, path: Path) -> None:
    notebook = nbformat.read(path, as_version=4)  # type: ignore[no-untyped-call]
    assert all(not cell.get("outputs") for cell in notebook.cells), "a notebook is kept without its outputs"
    os.environ.setdefault("MPLBACKEND", "module://matplotlib_inline.backend_inline")
    NotebookClient(notebook, timeout=120, resources={"metadata": {"path": str(folder)}}).execute()
    pictures = [
        output for cell in notebook.cells for output in cell.get("outputs", []) if "image/png" in output.get("data", {})
    ]
    assert pictures
