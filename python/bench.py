"""Rates of ray queries beside embreex and trimesh: prints a Markdown table.

    python python/bench.py [--rays 1000000] [--repeats 5] [--write python/README.md]

Needs wavecrest, numpy, trimesh, embreex, rtree, and the command wavecrest on the path for the rate of `trace`. In each
round every program answers the same rays; the table has the fastest, in millions of rays per second. Answers are compared:
they must be equal to the command's, and to the others' but for neighbours at an edge and for one ray in ten thousand.
"""

import argparse
import json
import os
import platform
import struct
import subprocess
import sys
import tempfile
import time
from importlib.metadata import version
from pathlib import Path

# Instead of this folder, where the package has no native part.
sys.path[0] = str(Path(__file__).with_name("tests"))

import numpy as np
import trimesh
import wavecrest
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene
from trimesh.ray import ray_pyembree, ray_triangle

from test_rays import ten_meshes

# The share of rays for which programs that round may answer otherwise: those that lose a hit at an edge.
DIFFER = 1e-4
# Faces whose planes a ray meets at distances that differ by less than this part are neighbours at an edge.
NEAR = 1e-4
# Rays for trimesh's own intersector, which takes milliseconds for each.
FEW = 40
BEGIN, END = "<!-- bench.py -->\n", "<!-- end -->\n"


def cases():
    """Meshes with a kind of rays and the queries to list: a closed surface with bumps, a landscape, and small ones."""
    ball = trimesh.creation.icosphere(subdivisions=6)
    x, y, z = ball.vertices.T
    bumps = 1 + 0.05 * np.sin(9 * x) * np.sin(11 * y) + 0.02 * np.sin(40 * z)
    ball = trimesh.Trimesh((ball.vertices * bumps[:, None]).astype(np.float32), ball.faces, process=False)
    n = 500
    x, y = np.meshgrid(np.linspace(-1, 1, n + 1), np.linspace(-1, 1, n + 1))
    z = 0.2 * np.sin(4 * x) * np.cos(3 * y) + 0.03 * np.sin(40 * x + 9 * y) + 0.01 * np.sin(90 * y)
    a = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    faces = np.vstack([np.stack([a, a + 1, a + n + 2], 1), np.stack([a, a + n + 2, a + n + 1], 1)])
    points = np.stack([x, y, z], -1).reshape(-1, 3).astype(np.float32)
    for name, mesh in {"ball": ball, "landscape": trimesh.Trimesh(points, faces, process=False)}.items():
        for kind in ("camera", "random"):
            yield name, mesh, kind, ("closest", "any", "all")
    for name, mesh in ten_meshes().items():
        yield name, mesh, "random", ("closest",)


def rays(kind, count):
    """Rays of a camera, or from and to anywhere around the mesh; with directions of length 1, as others need."""
    rng = np.random.default_rng(5)
    if kind == "camera":
        side = int(count**0.5)
        x, y = np.meshgrid(np.linspace(-0.4, 0.4, side), np.linspace(0.4, -0.4, side))
        directions = np.stack([x, y, -np.ones_like(x)], -1).reshape(-1, 3) @ [[1, 0, 0], [0, 0.6, 0.8], [0, -0.8, 0.6]]
        origins = np.tile([0.0, -2.4, 1.8], (len(directions), 1)) @ np.diag([1, -1, 1])
        directions[:, 1] *= -1
    else:
        origins = rng.normal(size=(count, 3))
        origins *= 3 / np.linalg.norm(origins, axis=1, keepdims=True)
        directions = rng.uniform(-0.8, 0.8, (count, 3)) - origins
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return origins.astype(np.float32), directions.astype(np.float32)


def ours(mesh):
    """Queries of wavecrest by name."""
    return {"closest": mesh.closest, "any": mesh.any, "all": mesh.all}


def seconds(work):
    start = time.perf_counter()
    answer = work()
    return time.perf_counter() - start, answer


def on_one_thread(folder, repeats):
    """The fastest rounds of a process with one thread."""
    command = [sys.executable, __file__, "--child", folder, str(repeats)]
    run = subprocess.run(command, env={**os.environ, "RAYON_NUM_THREADS": "1"}, check=True, capture_output=True)
    return json.loads(run.stdout)


def child(folder, repeats):
    data = np.load(Path(folder, "rays.npz"))
    mesh = wavecrest.Mesh(Path(folder, "mesh.ply"))
    timed = {name: [seconds(lambda: query(data["o"], data["d"]))[0] for _ in range(int(repeats))]
             for name, query in ours(mesh).items()}
    print(json.dumps({name: min(all) for name, all in timed.items()}))


def trace(folder, mesh, origins, directions, any_hit, answers):
    """The seconds of a pass of `wavecrest trace`, whose answers must be these."""
    faces, distances = answers
    count = len(origins)
    row = np.zeros((count, 8), "<f4")
    row[:, :3], row[:, 4:7], row[:, 7] = origins, directions, np.inf
    path = Path(folder, "rays.rays")
    with open(path, "wb") as file:
        file.write(b"RAYDUMP1" + struct.pack("<IIQQ", 1, any_hit, count, len(mesh.faces)) + bytes(32))
        for part in (row, distances.astype("<f4"), faces.astype("<i4"), (faces >= 0).astype("u1")):
            file.write(part.tobytes())
    command = ["wavecrest", "trace", "--mesh", Path(folder, "mesh.ply"), "--rays", path, "--bvh", "fast", "--json",
               "--repeats", "1"]
    report = json.loads(subprocess.run(command, check=True, capture_output=True).stdout)
    assert not any(report["compared"].values()), report["compared"]
    return report["seconds"]


def embree(mesh):
    """embreex by itself, which has one thread and answers with faces, or 0 and -1 for a miss."""
    scene = EmbreeScene()
    TriangleMesh(scene=scene, vertices=mesh.vertices.astype(np.float32), indices=mesh.faces.astype(np.int32))
    return {"closest": lambda o, d: scene.run(o, d), "any": lambda o, d: scene.run(o, d, query="OCCLUDED")}


def counted(index_ray, count):
    return np.bincount(index_ray, minlength=count)


def at_edges(mesh, origins, directions, got, expected, distances):
    """The faces `got`, where those that were expected are as far and take their place."""
    differ = np.flatnonzero((got != expected) & (got >= 0) & (expected >= 0))
    a, b, c = mesh.vertices[mesh.faces[got[differ]]].astype(float).transpose(1, 0, 2)
    normals = np.cross(b - a, c - a)
    slope = (normals * directions[differ]).sum(axis=1)
    t = (normals * (a - origins[differ])).sum(axis=1) / slope
    near = differ[np.abs(t - distances[differ]) <= NEAR * t]
    same = got.copy()
    same[near] = expected[near]
    return same


def check(name, got, expected):
    share = np.count_nonzero(got != expected) / len(expected)
    assert share <= DIFFER, f"{name}: {share:.2%} of the answers differ"


def measure(mesh, origins, directions, repeats, folder):
    """The seconds of each program for each query."""
    count, few = len(origins), (origins[:: len(origins) // FEW], directions[:: len(origins) // FEW])
    # Both have the vertices of the file.
    mesh.export(Path(folder, "mesh.ply"))
    np.savez(Path(folder, "rays.npz"), o=origins, d=directions)
    wave, peer = ours(wavecrest.Mesh(Path(folder, "mesh.ply"))), embree(mesh)
    fast, slow = ray_pyembree.RayMeshIntersector(mesh), ray_triangle.RayMeshIntersector(mesh)
    programs = {
        ("wavecrest", name): lambda query=query: query(origins, directions) for name, query in wave.items()
    } | {
        ("embreex", name): lambda query=query: query(origins, directions) for name, query in peer.items()
    } | {
        ("trimesh, embreex", "closest"): lambda: fast.intersects_first(origins, directions),
        ("trimesh, embreex", "any"): lambda: fast.intersects_any(origins, directions),
        ("trimesh, embreex", "all"): lambda: fast.intersects_id(origins, directions)[1],
    }
    times, answers = {key: [] for key in programs}, {}
    for _ in range(repeats):
        for key, work in programs.items():
            spent, answers[key] = seconds(work)
            times[key].append(spent)
        faces, distances = answers["wavecrest", "closest"]
        for any_hit, name in enumerate(("closest", "any")):
            spent = trace(folder, mesh, origins, directions, any_hit, (faces, distances))
            times.setdefault(("trace", name), []).append(spent)
    result = {key: min(all) for key, all in times.items()}
    for name, query in {"closest": slow.intersects_first, "any": slow.intersects_any,
                        "all": lambda o, d: slow.intersects_id(o, d)[1]}.items():
        spent, answers["trimesh", name] = seconds(lambda: query(*few))
        result["trimesh", name] = spent * count / len(few[0])
    for name, spent in on_one_thread(folder, repeats).items():
        result["wavecrest, 1 thread", name] = spent
    assert ((faces >= 0) == answers["wavecrest", "any"]).all()
    for name in ("embreex", "trimesh, embreex"):
        check(name, at_edges(mesh, origins, directions, answers[name, "closest"], faces, distances), faces)
    check("embreex, any", answers["embreex", "any"] != -1, faces >= 0)
    crossings = counted(answers["wavecrest", "all"][0], count)
    check("trimesh with embreex, all", counted(answers["trimesh, embreex", "all"], count), crossings)
    step = count // FEW
    assert (answers["trimesh", "closest"] == faces[::step]).mean() > 0.99
    assert (counted(answers["trimesh", "all"], len(few[0])) == crossings[::step]).mean() > 0.99
    return result


def rate(value):
    return np.format_float_positional(value, precision=3, fractional=False, trim="-")


def table(count, repeats):
    programs = ["wavecrest", "wavecrest, 1 thread", "embreex", "trimesh, embreex", "trimesh", "trace"]
    lines = ["| mesh, rays | query | " + " | ".join(programs) + " | wavecrest / trace |",
             "|---|---|" + "--:|" * (len(programs) + 1)]
    for name, mesh, kind, queries in cases():
        origins, directions = rays(kind, count)
        with tempfile.TemporaryDirectory() as folder:
            result = measure(mesh, origins, directions, repeats, folder)
        for query in queries:
            cells = [result.get((program, query)) for program in programs]
            rates = ["" if spent is None else rate(len(origins) / spent / 1e6) for spent in cells]
            ratio = "" if cells[-1] is None else f"{cells[-1] / cells[0]:.2f}"
            first = f"{name} ({len(mesh.faces):,}), {kind}" if query == "closest" else ""
            lines.append("| " + " | ".join([first, query, *rates, ratio]) + " |")
    return "\n".join(lines) + "\n"


def machine():
    cpu = Path("/proc/cpuinfo")
    text = cpu.read_text() if cpu.exists() else ""
    model = text.partition("model name")[2].partition(":")[2].partition("\n")[0].strip() or platform.processor()
    wide = ", AVX-512" if "avx512f" in text else ""
    packages = ", ".join(f"{name} {version(name)}" for name in ("embreex", "trimesh", "numpy"))
    return f"{model}{wide}, {os.cpu_count()} threads; wavecrest {wavecrest.__version__}, {packages}."


def main():
    if sys.argv[1:2] == ["--child"]:
        return child(*sys.argv[2:])
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rays", type=int, default=1_000_000)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--write", metavar="FILE", help=f"put the table between {BEGIN.strip()} and {END.strip()} of it")
    options = parser.parse_args()
    text = f"Millions of rays per second on {machine()}\n\n{table(options.rays, options.repeats)}"
    print(text)
    if options.write:
        file = Path(options.write)
        before, _, rest = file.read_text().partition(BEGIN)
        file.write_text(before + BEGIN + text + END + rest.partition(END)[2])


if __name__ == "__main__":
    main()
