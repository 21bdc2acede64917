#!/usr/bin/env python3
"""Holds the benches' times of the working tree against those of a commit.

    benches/compare.py REV [ROUNDS [BENCH...]]      3 rounds of all benches by default

Builds the benches of both (REV's in a worktree of its own, below target/compare), then runs each in turn, REV's first,
ROUNDS times. For each row that both have it prints the medians of both, and the median of the ratios round by round:
above 1, the working tree's number is the larger, which is better for rates and worse for seconds.
"""

import re
import subprocess
import sys
import tempfile
from pathlib import Path
from statistics import median

TOP = Path(__file__).resolve().parent.parent

# The numbers at the end of each row that are measured; what is before them names the row.
MEASURED = {
    "timing": ["Mwords/s", "Mwords/s with probe", "Mwords/s with path"],
    "instructions": ["seconds", "Minstructions/s"],
    "whole_run": ["functional s", "whole s", "ratio", "Mwords/s"],
}


def build(folder: Path, target: Path) -> dict[str, Path]:
    """Builds a tree's benches: the executable of each."""
    command = ["cargo", "bench", "--no-run", "--benches", "--target-dir", target]
    done = subprocess.run(command, cwd=folder, stderr=subprocess.PIPE, text=True)
    if done.returncode != 0:
        sys.exit(done.stderr)
    built = re.findall(r"Executable benches/(\w+)\.rs \((.+)\)", done.stderr)
    return {name: folder / path for name, path in built}


def printed(executable: Path) -> str:
    """Runs a bench: what it prints."""
    return subprocess.run([executable], cwd=TOP, stdout=subprocess.PIPE, text=True, check=True).stdout


def rows(text: str, columns: int) -> dict[str, list[float]]:
    """The measured numbers of each row that a bench printed, by the row's name."""
    found = {}
    for line in text.splitlines():
        name, *numbers = line.rsplit(None, columns)
        if len(numbers) == columns and all(re.fullmatch(r"[\d.]+", number) for number in numbers):
            found[" ".join(name.split())] = [float(number) for number in numbers]
    return found


def compare(bench: str, old: Path, new: Path, rounds: int):
    """Runs a bench of both in turn, and prints a table."""
    columns = MEASURED[bench]
    texts = [(printed(old), printed(new)) for _ in range(rounds)]
    names = rows(texts[0][1], len(columns)).keys()
    # An older bench may measure less, and has then fewer numbers behind a row's name.
    known = max(range(len(columns), 0, -1), key=lambda count: len(names & rows(texts[0][0], count).keys()))
    pairs = [(rows(was, known), rows(now, len(columns))) for was, now in texts]
    print(f"\n{bench:<32} {'measured':<20} {'old':>10} {'new':>10} {'new/old':>8}")
    for row in [row for row in pairs[0][0] if row in pairs[0][1]]:
        for column, measured in enumerate(columns[:known]):
            values = [(was[row][column], now[row][column]) for was, now in pairs]
            ratio = median(now / was if was else float("nan") for was, now in values)
            was, now = (median(side) for side in zip(*values))
            print(f"{row:<32} {measured:<20} {was:>10g} {now:>10g} {ratio:>8.3f}", flush=True)


def main(arguments: list[str]):
    """Builds both trees' benches and compares them."""
    if not arguments or arguments[0].startswith("-"):
        sys.exit(__doc__)
    rev, rounds, benches = arguments[0], int((arguments[1:2] or ["3"])[0]), arguments[2:] or list(MEASURED)
    with tempfile.TemporaryDirectory() as folder:
        git = ["git", "-C", TOP, "worktree"]
        subprocess.run([*git, "add", "--quiet", "--detach", f"{folder}/old", rev], check=True)
        try:
            new = build(TOP, TOP / "target")
            # Not among the working tree's own files, or its binary would be overwritten.
            old = build(Path(folder) / "old", TOP / "target/compare")
            for bench in benches:
                compare(bench, old[bench], new[bench], rounds)
        finally:
            subprocess.run([*git, "remove", "--force", f"{folder}/old"], check=True)


if __name__ == "__main__":
    main(sys.argv[1:])
