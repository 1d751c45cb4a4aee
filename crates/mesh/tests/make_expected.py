"""Writes expected_meshes.tsv and expected_distances.tsv beside this script.

    python make_expected.py MESH_FOLDER        (needs: pip install trimesh scipy rtree)

expected_meshes.tsv has a row per mesh of the test data: what trimesh counts with equal vertices merged.
expected_distances.tsv has 50 points per mesh, in its bounds grown by a fifth, with trimesh's signed distance
(turned round: negative inside). Where the mesh has holes or parts, trimesh tells inside by the parity of rays
and `sign` is empty: there is no one answer then.
"""

import gzip
import os
import sys

import numpy as np
import trimesh
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

HERE = os.path.dirname(os.path.abspath(__file__))
MESHES = ["armadillo_libigl.obj.gz", "bunny_trimesh.ply.gz", "dragon_starsx.obj.gz", "stanford-bunny.obj.gz"]


def parts(mesh):
    """Parts that share no edge. trimesh's own adjacency leaves edges of more than two faces out."""
    _, edge = np.unique(mesh.edges_sorted, axis=0, return_inverse=True)
    face = np.repeat(np.arange(len(mesh.faces)), 3)
    size = len(mesh.faces) + edge.max() + 1
    graph = coo_matrix((np.ones(len(face)), (face, len(mesh.faces) + edge.ravel())), shape=(size, size))
    return connected_components(graph, directed=False)[0]


def main(folder):
    random = np.random.default_rng(20)
    counts = ["file\tvertices\ttriangles\tmerged\teuler\twatertight\toriented\tboundary\tcomponents\tvolume\tlo\thi"]
    points = ["file\tpoint\tdistance\tsign"]
    for name in MESHES:
        kind = name.split(".")[-2]
        with gzip.open(os.path.join(folder, name)) as file:
            raw = trimesh.load(file, file_type=kind, process=False, maintain_order=True)
        mesh = raw.copy()
        mesh.merge_vertices(merge_tex=True, merge_norm=True, digits_vertex=17)
        uses = np.bincount(np.unique(mesh.edges_sorted, axis=0, return_counts=True)[1])
        boundary = int(uses[1]) if len(uses) > 1 else 0
        components = parts(mesh)
        volume = float(mesh.volume)
        closed = mesh.is_watertight and mesh.is_winding_consistent and components == 1
        flat = lambda v: " ".join(repr(float(x)) for x in v)  # noqa: E731
        counts.append("\t".join(map(str, [
            name, len(raw.vertices), len(raw.faces), len(mesh.vertices), mesh.euler_number, mesh.is_watertight,
            mesh.is_winding_consistent, boundary, components, repr(volume), flat(mesh.bounds[0]), flat(mesh.bounds[1])])))
        lo, hi = mesh.bounds
        grow = (hi - lo) * 0.1
        p = random.uniform(lo - grow, hi + grow, (50, 3))
        # Half of them near the surface, where signs are hard.
        p[::2] = mesh.sample(25, seed=7) + random.normal(0, 0.01, (25, 3)) * (hi - lo).max()
        # trimesh takes squared distances that differ by 1e-8 for equal: right for large meshes alone.
        scale = 1e4 / (hi - lo).max()
        large = trimesh.Trimesh(mesh.vertices * scale, mesh.faces, process=False)
        distance = -trimesh.proximity.signed_distance(large, p * scale) / scale
        for at, d in zip(p, distance):
            sign = ("-" if d < 0 else "+") if closed else ""
            points.append("\t".join([name, flat(at), repr(float(abs(d))), sign]))
    for name, rows in [("meshes", counts), ("distances", points)]:
        with open(os.path.join(HERE, f"expected_{name}.tsv"), "w") as file:
            file.write("\n".join(rows) + "\n")


main(sys.argv[1])
