"""The rows of expected_slices.tsv, and what the scripts beside this one share."""

import os

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
COLUMNS = ["path", "tool", "outcome", "part", "component", "step", "type", "dims", "columns", "origin", "min", "max",
           "mean", "weighted", "probes", "steps", "warns", "note"]
ROWS = []
rng = np.random.default_rng(7)


def numbers(values):
    return " ".join(repr(float(v)) for v in np.ravel(values))


def add(path, tool, dtype, data, columns=np.eye(3), origin=(0, 0, 0), part="", component="", step="", steps=1,
        warns="", note=""):
    """`data` is z, y, x."""
    dims = data.shape[::-1]
    flat = data.ravel().astype(np.float64)
    at = [int(i) for i in np.linspace(0, flat.size - 1, 10)]
    probes = " ".join(f"{i}:{flat[i]!r}" for i in at).replace("np.float64(", "").replace(")", "")
    weighted = (flat * (np.arange(flat.size) % 1009)).mean()
    ROWS.append([path, tool, "ok", part, component, step, dtype, " ".join(map(str, dims)), numbers(columns),
                 numbers(origin), repr(float(flat.min())), repr(float(flat.max())), repr(float(flat.mean())),
                 repr(float(weighted)), probes, steps, warns, note])


def refuse(path, code, note, part="", warns=""):
    ROWS.append([path, "none", code, part, "", "", "", "", "", "", "", "", "", "", "", "", warns, note])


def folder(name):
    path = os.path.join(HERE, name)
    os.makedirs(path, exist_ok=True)
    return path


def random(shape, dtype, low=None, high=None):
    info = np.iinfo(dtype)
    return rng.integers(info.min if low is None else low, info.max if high is None else high, shape, dtype=dtype,
                        endpoint=True)
