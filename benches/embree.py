#!/usr/bin/env python3
"""Holds the functional half against Embree: the same rays on the same polygons, one thread each.

    pip install embreex numpy
    benches/embree.py [BENCH]      BENCH is an executable of `one_cell` that has been built already

A bumpy ring of 202 520 triangles, and 1 048 576 rays through the pixels of an image. Ours is broadcast on one cell, which also notes what
the cell does for each ray; Embree only finds the hits.
"""

import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene

TOP = Path(__file__).resolve().parent.parent
AROUND, ACROSS = 332, 305
WIDTH = 1024
REPEATS = 5


def ring() -> tuple[np.ndarray, np.ndarray]:
    """Points, and triangles of them: a ring whose thickness varies."""
    i, j = np.meshgrid(np.arange(AROUND), np.arange(ACROSS), indexing="ij")
    u, v = 2 * np.pi * i / AROUND, 2 * np.pi * j / ACROSS
    thick = 1 + 0.1 * np.sin(9 * u) * np.sin(7 * v)
    out = 2.5 + thick * np.cos(v)
    points = np.stack([out * np.cos(u), out * np.sin(u), thick * np.sin(v)], axis=-1).reshape(-1, 3).astype(np.float32)
    at = lambda i, j: (i % AROUND) * ACROSS + j % ACROSS
    corners = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]
    triangles = [np.stack([corners[0], corners[k], corners[k + 1]], axis=-1).reshape(-1, 3) for k in (1, 2)]
    return points, np.concatenate(triangles).astype(np.int32)


def rays() -> tuple[np.ndarray, np.ndarray]:
    """Origins and directions, line by line."""
    eye = np.array([0, -7, 5], np.float32)
    ahead = -eye / np.linalg.norm(eye)
    right = np.array([1, 0, 0], np.float32)
    up = np.cross(right, ahead)
    x, y = np.meshgrid((np.arange(WIDTH) + 0.5) / WIDTH - 0.5, 0.5 - (np.arange(WIDTH) + 0.5) / WIDTH)
    towards = ahead + x[..., None] * right + y[..., None] * up
    towards = (towards / np.linalg.norm(towards, axis=-1, keepdims=True)).reshape(-1, 3).astype(np.float32)
    return np.tile(eye, (len(towards), 1)), towards


def write(folder: Path, points: np.ndarray, triangles: np.ndarray, origins: np.ndarray, towards: np.ndarray):
    """The files that `one_cell` reads."""
    with open(folder / "ring.obj", "w") as obj:
        obj.writelines(f"v {x!r} {y!r} {z!r}\n" for x, y, z in points.tolist())
        obj.writelines(f"f {a} {b} {c}\n" for a, b, c in (triangles + 1).tolist())
    with open(folder / "rays.csv", "w") as table:
        table.write("ox,oy,oz,dx,dy,dz\n")
        table.writelines(",".join(map(repr, ray)) + "\n" for ray in np.hstack([origins, towards]).tolist())


def ours(bench: str | None, folder: Path) -> dict[str, float]:
    """What `one_cell` tells."""
    command = [bench] if bench else ["cargo", "bench", "--quiet", "--bench", "one_cell", "--"]
    command += [str(folder / "ring.obj"), str(folder / "rays.csv")]
    told = subprocess.run(command, cwd=TOP, stdout=subprocess.PIPE, text=True, check=True).stdout
    return {name: float(number) for name, number in re.findall(r"^(prepared|traced|hits) ([\d.]+)", told, re.MULTILINE)}


def embree(points: np.ndarray, triangles: np.ndarray, origins: np.ndarray, towards: np.ndarray) -> dict[str, float]:
    """The same of Embree."""
    start = time.perf_counter()
    scene = EmbreeScene()
    TriangleMesh(scene, points[triangles])
    scene.run(origins[:1], towards[:1])
    prepared, traced, hits = time.perf_counter() - start, float("inf"), 0
    for _ in range(REPEATS):
        start = time.perf_counter()
        found = scene.run(origins, towards)
        traced, hits = min(traced, time.perf_counter() - start), int((found >= 0).sum())
    return {"prepared": prepared, "traced": traced, "hits": hits}


def main():
    """Prints both, and how many times as long ours takes."""
    points, triangles = ring()
    origins, towards = rays()
    with tempfile.TemporaryDirectory() as folder:
        write(Path(folder), points, triangles, origins, towards)
        own = ours(sys.argv[1] if len(sys.argv) > 1 else None, Path(folder))
    other = embree(points, triangles, origins, towards)
    print(f"{len(triangles)} triangles, {len(origins)} rays, one thread; seconds")
    print(f"{'':<10} {'one cell':>10} {'Embree':>10} {'ratio':>8}")
    for name in ("prepared", "traced"):
        print(f"{name:<10} {own[name]:>10.3f} {other[name]:>10.3f} {own[name] / other[name]:>8.1f}")
    print(f"{'hits':<10} {own['hits']:>10.0f} {other['hits']:>10.0f}")


if __name__ == "__main__":
    main()
