"""Rates of ray queries beside embreex and Open3D: prints a Markdown table.

    python python/bench.py [--rays 1000000] [--repeats 5] [--write python/README.md]

Needs wavecrest, numpy, trimesh, embreex and open3d. For each number of threads a process asks every program for the closest
hits of the same rays, in turn; the table has the fastest of all rounds, in millions of rays per second. Faces must be equal
but for neighbours at an edge, and for one ray in ten thousand.
"""

import argparse
import json
import os
import platform
import subprocess
import sys
import time
from importlib.metadata import version
from pathlib import Path

# Instead of this folder, where the package has no native part.
sys.path[0] = str(Path(__file__).with_name("tests"))

import numpy as np
import open3d
import trimesh
import wavecrest
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene

from test_rays import ten_meshes

KINDS = ("camera", "random", "diffuse")
THREADS = (1, 2)
# The share of rays for which programs that round may answer otherwise: those that lose a hit at an edge.
DIFFER = 1e-4
# Faces whose planes a ray meets at distances that differ by less than this part are neighbours at an edge.
NEAR = 1e-4
BEGIN, END = "<!-- bench.py -->\n", "<!-- end -->\n"


def meshes():
    """Ten small meshes, and two large ones: a closed surface with bumps, and a landscape."""
    yield from ten_meshes().items()
    ball = trimesh.creation.icosphere(subdivisions=6)
    x, y, z = ball.vertices.T
    bumps = 1 + 0.05 * np.sin(9 * x) * np.sin(11 * y) + 0.02 * np.sin(40 * z)
    yield "ball", trimesh.Trimesh(ball.vertices * bumps[:, None], ball.faces, process=False)
    n = 500
    x, y = np.meshgrid(np.linspace(-1, 1, n + 1), np.linspace(-1, 1, n + 1))
    z = 0.2 * np.sin(4 * x) * np.cos(3 * y) + 0.03 * np.sin(40 * x + 9 * y) + 0.01 * np.sin(90 * y)
    a = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    faces = np.vstack([np.stack([a, a + 1, a + n + 2], 1), np.stack([a, a + n + 2, a + n + 1], 1)])
    yield "landscape", trimesh.Trimesh(np.stack([x, y, z], -1).reshape(-1, 3), faces, process=False)


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def rays(kind, vertices, faces, count):
    """Rays of a camera, from and to anywhere around the mesh, or from what a camera sees, by the cosine around its normals:
    with directions of length 1, as others need."""
    rng = np.random.default_rng(5)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    middle, size = (low + high) / 2, np.linalg.norm(high - low)
    if kind == "random":
        origins = middle + 1.5 * size * unit(rng.normal(size=(count, 3)))
        directions = rng.uniform(low, high, (count, 3)) - origins
        return origins.astype(np.float32), unit(directions).astype(np.float32)
    side = int(count**0.5)
    x, y = np.meshgrid(np.linspace(-0.4, 0.4, side), np.linspace(0.4, -0.4, side))
    directions = unit(np.stack([x, -np.ones_like(x), y], -1).reshape(-1, 3) @ [[1, 0, 0], [0, 0.8, 0.6], [0, -0.6, 0.8]])
    origins = np.broadcast_to(middle + size * np.array([0, 0.96, 0.72]), directions.shape)
    if kind == "diffuse":
        found, distances = wavecrest.Mesh(vertices, faces).closest(origins, directions)
        hit = rng.choice(np.flatnonzero(found >= 0), count)
        a, b, c = vertices[faces[found[hit]]].transpose(1, 0, 2)
        normals = unit(np.cross(b - a, c - a))
        normals *= -np.sign((normals * directions[hit]).sum(axis=1, keepdims=True))
        origins = origins[hit] + distances[hit, None] * directions[hit] + 1e-4 * size * normals
        directions = unit(normals + 0.999 * unit(rng.normal(size=(count, 3))))
    return origins.astype(np.float32), directions.astype(np.float32)


def programs(vertices, faces, origins, directions, threads):
    """What finds the faces that the rays meet first, or -1, by program; embreex has one thread."""
    ours = wavecrest.Mesh(vertices, faces)
    scene, both = open3d.t.geometry.RaycastingScene(), open3d.core.Tensor(np.hstack([origins, directions]))
    scene.add_triangles(open3d.core.Tensor(vertices), open3d.core.Tensor(faces.astype(np.uint32)))
    found = {
        "wavecrest": lambda: ours.closest(origins, directions)[0],
        "Open3D": lambda: scene.cast_rays(both, nthreads=threads)["primitive_ids"].numpy().astype(np.int32),
    }
    if threads == 1:
        peer = EmbreeScene()
        TriangleMesh(scene=peer, vertices=vertices, indices=faces.astype(np.int32))
        found["embreex"] = lambda: peer.run(origins, directions)
    return found


def at_edges(vertices, faces, origins, directions, got, expected):
    """The faces `got`, where those that were expected are as far and take their place."""
    differ = np.flatnonzero((got != expected) & (got >= 0) & (expected >= 0))
    def distance(found):
        a, b, c = vertices[faces[found[differ]]].astype(float).transpose(1, 0, 2)
        normals = np.cross(b - a, c - a)
        return (normals * (a - origins[differ])).sum(axis=1) / (normals * directions[differ]).sum(axis=1)
    t = distance(got)
    near = differ[np.abs(t - distance(expected)) <= NEAR * np.abs(t)]
    same = got.copy()
    same[near] = expected[near]
    return same


def rates(threads, count, repeats):
    """Millions of rays per second by mesh and kind, for each program; in this process, with so many threads."""
    rows = []
    for name, mesh in meshes():
        vertices, faces = np.asarray(mesh.vertices, np.float32), np.asarray(mesh.faces)
        for kind in KINDS:
            origins, directions = rays(kind, vertices, faces, count)
            times, answers = {}, {}
            for program, query in [*programs(vertices, faces, origins, directions, threads).items()] * repeats:
                start = time.perf_counter()
                answers[program] = query()
                times.setdefault(program, []).append(time.perf_counter() - start)
            for program, got in answers.items():
                same = at_edges(vertices, faces, origins, directions, got, answers["wavecrest"])
                share = np.mean(same != answers["wavecrest"])
                assert share <= DIFFER, f"{name}, {kind}, {program}: {share:.2%} of the faces differ"
            rows.append([f"{name} ({len(faces):,})", kind,
                         {program: len(origins) / min(all) / 1e6 for program, all in times.items()}])
    return rows


def table(count, repeats):
    found = []
    for threads in THREADS:
        command = [sys.executable, __file__, "--threads", str(threads), "--rays", str(count), "--repeats", str(repeats)]
        run = subprocess.run(command, env={**os.environ, "RAYON_NUM_THREADS": str(threads)}, check=True, stdout=subprocess.PIPE)
        found.append(json.loads(run.stdout))
    columns = [(program, threads) for threads, rows in zip(THREADS, found) for program in rows[0][2]]
    lines = ["| mesh | rays | " + " | ".join(f"{program}, {threads}" for program, threads in columns) + " | least ratio |",
             "|---|---|" + "--:|" * (len(columns) + 1)]
    for rows in zip(*found):
        name, kind, _ = rows[0]
        ratio = min(row[2]["wavecrest"] / rate for row in rows for program, rate in row[2].items() if program != "wavecrest")
        cells = [f"{row[2][program]:.3g}" for row in rows for program in row[2]]
        lines.append(f"| {name} | {kind} | " + " | ".join(cells) + f" | {ratio:.2f} |")
    return "\n".join(lines) + "\n"


def machine():
    cpu = Path("/proc/cpuinfo")
    text = cpu.read_text() if cpu.exists() else ""
    model = text.partition("model name")[2].partition(":")[2].partition("\n")[0].strip() or platform.processor()
    packages = ", ".join(f"{name} {version(name)}" for name in ("embreex", "open3d", "trimesh", "numpy"))
    return f"{model}, {os.cpu_count()} threads; wavecrest {wavecrest.__version__}, {packages}."


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rays", type=int, default=1_000_000)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--threads", type=int, help="print the rates of this process as JSON instead")
    parser.add_argument("--write", metavar="FILE", help=f"put the table between {BEGIN.strip()} and {END.strip()} of it")
    options = parser.parse_args()
    if options.threads:
        print(json.dumps(rates(options.threads, options.rays, options.repeats)))
        return
    text = f"Millions of rays per second on {machine()}\n\n{table(options.rays, options.repeats)}"
    print(text)
    if options.write:
        file = Path(options.write)
        before, _, rest = file.read_text().partition(BEGIN)
        file.write_text(before + BEGIN + text + END + rest.partition(END)[2])


if __name__ == "__main__":
    main()
