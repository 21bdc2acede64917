"""Programs of cells, assembled and run on words, against the command."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import pcs_sim

from .support import ROOT, command

FIR = ROOT / "pcs-programs" / "cells" / "fir.pcs"


def test_assembling(folder: Path) -> None:
    program = pcs_sim.assemble(FIR)
    program.save(object="fir.obj", listing="fir.txt")
    ended = command(folder, "asm", str(FIR), "-o", "theirs.obj", "--listing", "theirs.txt")
    assert ended.status == 0, ended.err
    assert (folder / "fir.obj").read_bytes() == (folder / "theirs.obj").read_bytes()
    assert (folder / "fir.txt").read_bytes() == (folder / "theirs.txt").read_bytes()
    assert program.disassembly == command(folder, "disasm", "theirs.obj").out
    assert pcs_sim.assemble("fir.obj").object == program.object
    machine = pcs_sim.Machine().to_dict()
    machine["instruction_cycles"]["float_multiply"] += 1
    assert pcs_sim.assemble(FIR, machine=machine).listing != program.listing


def test_running(folder: Path) -> None:
    taps, words = [0.5, 0.25, 0.125, 0.125], np.arange(12, dtype=np.float32)
    program = pcs_sim.assemble(FIR)
    state = program.step(words)
    written = state["x_out"].view(np.float32)
    expected = np.convolve(words, taps)[: len(written)]
    np.testing.assert_allclose(written, expected, rtol=1e-6)
    assert (state["stopped"], state["x_read"]) == ("x", 12)
    (folder / "words.txt").write_text(" ".join(f"{word:.1f}" for word in words))
    (folder / "script.txt").write_text("run\nqueues\n")
    told = command(folder, "step", str(FIR), "--x", "words.txt", "--script", "script.txt").out
    assert f"{state['executed']} instructions, cycle {state['cycles']} of message 0: waits for X" in told
    assert f"X out  {len(written)} written" in told
    assert (program.step("words.txt")["x_out"] == state["x_out"]).all()
    some = program.step(words, instructions=7)
    assert (some["stopped"], some["executed"]) == (None, 7)


def test_an_instruction_at_a_time(folder: Path) -> None:
    program, words = pcs_sim.assemble(FIR), np.arange(12, dtype=np.float32)
    cell, whole = program.start(words), program.step(words)
    (folder / "words.txt").write_text(" ".join(f"{word:.1f}" for word in words))
    (folder / "script.txt").write_text("step\nstep 5\nlist\n")
    arguments = ["step", str(FIR), "--x", "words.txt", "--script", "script.txt"]
    told = command(folder, *arguments).out
    first = cell.step()
    assert (first["executed"], first["stopped"]) == (1, None)
    assert cell.step(5)["executed"] == 6
    assert str(cell) in told
    assert cell.state["executed"] == 6
    while (state := cell.run())["stopped"] == "done":
        pass
    assert state["stopped"] == whole["stopped"] == "x"
    assert all(np.array_equal(state[key], whole[key]) for key in whole)  # type: ignore[literal-required]
    # More words come, and it goes on as if they had always been there.
    cell.feed(x=[5.0, 7.0])
    while (state := cell.run())["stopped"] == "done":
        pass
    more = program.step(np.append(words, [5.0, 7.0]).astype(np.float32))
    assert all(np.array_equal(state[key], more[key]) for key in more)  # type: ignore[literal-required]


def test_breakpoints(folder: Path) -> None:
    (folder / "count.pcs").write_text(
        "        addi r1, r0, 3\nagain:  addi r1, r1, -1\n        bne r1, r0, again\n        halt\n"
    )
    cell = pcs_sim.assemble("count.pcs").start()
    places: list[int | str] = ["again", 1, "2"]
    for place in places:
        cell.break_at(place)
    seen = []
    while (state := cell.run())["stopped"] == "breakpoint":
        seen.append((state["address"], state["registers"]["r1"]))
    assert seen == [(1, 3), (1, 2), (1, 1)]
    assert state["stopped"] == "halted"
    assert cell.run()["stopped"] == "halted"
    wrong: list[int | str] = ["nowhere", 99, "99"]
    for place in wrong:
        with pytest.raises(pcs_sim.InputError, match=r"no label|ends before|no instruction"):
            cell.break_at(place)


def test_what_is_refused(folder: Path) -> None:
    (folder / "wrong.pcs").write_text("add r1, r2\n")
    with pytest.raises(pcs_sim.InputError) as caught:
        pcs_sim.assemble("wrong.pcs")
    assert (caught.value.file, caught.value.line) == ("wrong.pcs", 1)
    assert command(folder, "asm", "wrong.pcs").status == 2
    program = pcs_sim.assemble(FIR)
    for words in [[2**32], ["a"], 5, [None], [-(2**31) - 1]]:
        with pytest.raises(pcs_sim.InputError, match=r"x: expected words of 32 bits"):
            program.step(words)  # type: ignore[arg-type]
    with pytest.raises(pcs_sim.InputError, match="cannot read the file"):
        program.step("nowhere.txt")
    (folder / "loop.pcs").write_text("again:  beq r0, r0, again\n")
    with pytest.raises(pcs_sim.CellFault, match="instructions"):
        pcs_sim.assemble("loop.pcs").step(instruction_limit=100)
