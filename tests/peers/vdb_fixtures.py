"""Volumes written and described by OpenVDB, for the tests of the crate `tyndall-scene-io`, which run
this if the module is there (Debian: python3-openvdb):

    python3 vdb_fixtures.py write FOLDER    fixtures, and FOLDER/expected.json that says what they hold
    python3 vdb_fixtures.py read FILE...    what files hold, as the same JSON each, in a list

What they hold is OpenVDB's word: of each grid its active voxels, their sum, minimum and maximum, the
background, the images of the origin and the axes, and the values of some voxels, active or not.
"""

import json
import math
import random
import sys
from pathlib import Path

try:
    import openvdb as vdb
except ImportError:
    import pyopenvdb as vdb

# How many voxels to look up within how far from the origin.
POINTS = {12: 150, 300: 100, 9000: 50, 2**30: 5}


def channels(value):
    return list(value) if isinstance(value, tuple) else [float(value)]


def kind(grid):
    half = grid.saveFloatAsHalf
    return {"float": "half" if half else "float", "vec3s": "vec3h" if half else "vec3s"}.get(
        grid.valueTypeName, grid.valueTypeName
    )


def points(grid):
    numbers, values = random.Random(1), grid.getConstAccessor()
    voxels = [
        tuple(numbers.randint(-reach, reach) for _ in range(3))
        for reach, count in POINTS.items()
        for _ in range(count)
    ]
    return [[voxel, channels(values.getValue(voxel))] for voxel in voxels]


def describe(grid):
    known = {
        "name": grid.name,
        "kind": kind(grid),
        "class": grid.gridClass,
        "wanted": grid.valueTypeName in ("float", "vec3s") and grid.transform.isLinear,
    }
    if not known["wanted"]:
        return known
    sums, low, high = [], [], []
    for item in grid.citerOnValues():
        value = channels(item.value)
        sums.append([x * item.count for x in value])
        low = [min(pair) for pair in zip(low or value, value)]
        high = [max(pair) for pair in zip(high or value, value)]
    at = grid.transform.indexToWorld
    origin = at((0, 0, 0))
    axes = [[a - o for a, o in zip(at(axis), origin)] for axis in ((1, 0, 0), (0, 1, 0), (0, 0, 1))]
    return known | {
        "voxels": grid.activeVoxelCount(),
        "sum": [math.fsum(column) for column in zip(*sums)],
        "min": low,
        "max": high,
        "background": channels(grid.background),
        "matrix": [x for row in [*axes, origin] for x in row],
        "points": points(grid),
    }


def scalar(x):
    return x


def vector(x):
    return (x, -2 * x, x * x)


def cloud(make, value, background, inactive):
    """A ball of waves, tiles of all sizes, and `inactive(i)` inside the ball."""
    grid = make(value(background))
    grid.name = "density"
    voxels = grid.getAccessor()
    for i in range(-9, 14):
        for j in range(-9, 12):
            for k in range(-5, 9):
                r = math.sqrt(i * i + j * j + k * k)
                x = 1 + math.sin(0.3 * i) * math.cos(0.2 * j + 0.1 * k)
                if r < 6 and inactive:
                    voxels.setValueOff((i, j, k), value(inactive(i)))
                elif r < 13:
                    voxels.setValueOn((i, j, k), value(x))
    # Of 8³, 128³ and 4096³ voxels.
    grid.fill((40, 40, 40), (47, 47, 47), value(4.0), True)
    grid.fill((-48, 40, 40), (-41, 47, 47), value(5.0), False)
    grid.fill((128, 128, 0), (255, 255, 127), value(0.5), True)
    grid.fill((-256, 128, 0), (-129, 255, 127), value(0.75), False)
    grid.fill((4096, 0, 0), (8191, 4095, 4095), value(0.25), True)
    grid.fill((-8192, 0, 0), (-4097, 4095, 4095), value(2.0), False)
    return grid


# What inactive voxels hold; each is compressed in a way of its own.
INACTIVE = {
    "background": (0.0, None),
    "minus": (1.5, lambda i: -1.5),
    "one": (1.5, lambda i: 7.0),
    "minus_or_background": (1.5, lambda i: (-1) ** i * 1.5),
    "one_or_background": (1.5, lambda i: (1.5, 7.0)[i % 2]),
    "two": (1.5, lambda i: (3.0, 7.0)[i % 2]),
    "all": (1.5, lambda i: 1.0 + i % 5),
}

MAPS = {
    "uniform": [[0.1, 0, 0, 0], [0, 0.1, 0, 0], [0, 0, 0.1, 0], [0, 0, 0, 1]],
    "scale": [[1, 0, 0, 0], [0, 2, 0, 0], [0, 0, 3, 0], [0, 0, 0, 1]],
    "uniform_translate": [[0.1, 0, 0, 0], [0, 0.1, 0, 0], [0, 0, 0.1, 0], [1, 2, 3, 1]],
    "scale_translate": [[1, 0, 0, 0], [0, -2, 0, 0], [0, 0, 3, 0], [4, 5, 6, 1]],
    "translate": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [-4, 5, 6.5, 1]],
    "turned": [[0.6, 0.8, 0, 0], [-0.8, 0.6, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]],
    "sheared": [[2, 0, 0, 0], [0.5, -3, 0, 0], [0.25, 1, 4, 0], [5, 6, 7, 1]],
    "tiny": 1e-4,
    "huge": 1e6,
}


def ball(radius):
    grid = vdb.FloatGrid()
    grid.name = "density"
    grid.fill((-radius,) * 3, (radius,) * 3, 0.5, True)
    return grid


def noise(make, value):
    """Does not compress."""
    grid = make()
    grid.name = "density"
    voxels, numbers = grid.getAccessor(), random.Random(1)
    for i in range(16):
        for j in range(8):
            for k in range(8):
                voxels.setValueOn((i, j, k), value(numbers.gauss(0, 10.0 ** numbers.randint(-4, 1))))
    return grid


def families():
    """Several grids: of one name, with a shared tree, of types and transforms that are not read."""
    density = ball(9)
    density["answer"] = 42
    density["where"] = (1.0, 2.0, 3.0)
    density["text"] = "a\x1e1"
    density.gridClass = vdb.GridClass.FOG_VOLUME
    shared = density.copy()
    shared.transform = vdb.createLinearTransform(0.5)
    again = density.deepCopy()
    again.fill((0, 0, 0), (3, 3, 3), 9.0, True)
    mask = vdb.BoolGrid()
    mask.name = "mask"
    mask.fill((0, 0, 0), (9, 9, 9), True, True)
    velocity = noise(vdb.Vec3SGrid, vector)
    velocity.name = "velocity"
    velocity.gridClass = vdb.GridClass.STAGGERED
    frustum = ball(3)
    frustum.name = "frustum"
    frustum.transform = vdb.createFrustumTransform((0, 0, 0), (9, 9, 9), 0.5, 2, 0.1)
    unnamed = ball(2)
    unnamed.name = ""
    return [mask, density, shared, velocity, frustum, again, unnamed]


def fixtures():
    """Names and grids."""
    for name, (make, value) in {
        "float": (vdb.FloatGrid, scalar),
        "vec3s": (vdb.Vec3SGrid, vector),
    }.items():
        for half in (False, True):
            kind = name + "_half" * half
            for inactive, (background, values) in INACTIVE.items():
                grid = cloud(make, value, background, values)
                grid.saveFloatAsHalf = half
                yield f"{kind}_{inactive}", [grid]
            grid = noise(make, value)
            grid.saveFloatAsHalf = half
            yield f"{kind}_noise", [grid]
    for name, matrix_or_size in MAPS.items():
        grid = ball(5)
        grid.transform = vdb.createLinearTransform(matrix_or_size)
        yield f"map_{name}", [grid]
    sphere = vdb.createLevelSetSphere(5.0, (1, 2, 3), 0.3)
    sphere.name = "surface"
    empty = vdb.FloatGrid(0.25)
    empty.name = "empty"
    dot = vdb.FloatGrid()
    dot.name = "dot"
    dot.getAccessor().setValueOn((2**31 - 1, -(2**31), 0), 3.0)
    yield "sphere", [sphere]
    yield "empty", [empty]
    yield "dot", [dot]
    yield "families", families()


def write(folder):
    expected = {}
    for name, grids in fixtures():
        path = folder / f"{name}.vdb"
        vdb.write(str(path), grids=grids, metadata={"author": "OpenVDB", "year": 2012})
        # As read back: halves have been rounded.
        back = read(path)
        assert len(back) == len(grids), name
        expected[path.name] = back
    (folder / "expected.json").write_text(json.dumps(expected))


def read(path):
    return [describe(grid) for grid in vdb.readAll(str(path))[0]]


if __name__ == "__main__":
    match sys.argv[1:]:
        case ["write", folder]:
            write(Path(folder))
        case ["read", *paths]:
            json.dump([read(path) for path in paths], sys.stdout)
        case _:
            sys.exit(__doc__)
