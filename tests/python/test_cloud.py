# SPDX-License-Identifier: MIT
"""Clouds from whatever holds points, and what can't be one."""
import copy
import gc
import pickle

import numpy as np
import pytest

import batten
from conftest import sheet


class Wrapped:
    """What Open3D, laspy and others have."""

    def __init__(self, array):
        self.array = array

    def __array__(self, dtype=None):
        return np.asarray(self.array, dtype=dtype)


class Table(dict):
    """What pandas has."""

    @property
    def columns(self):
        return list(self)


BASE = np.random.default_rng(3).random((40, 3))
WIDE = np.random.default_rng(4).random((80, 7))

SAME = {
    "C order": lambda: BASE.copy(),
    "Fortran order": lambda: np.asfortranarray(BASE),
    "every second row": lambda: np.repeat(BASE, 2, axis=0)[::2],
    "columns of a wider one": lambda: np.hstack([BASE, BASE])[:, :3],
    "transposed": lambda: np.ascontiguousarray(BASE.T).T,
    "backwards": lambda: BASE[::-1].copy()[::-1],
    "read-only": lambda: np.frombuffer(BASE.tobytes()).reshape(-1, 3),
    "big endian": lambda: BASE.astype(">f8"),
    "objects": lambda: BASE.astype(object),
    "list": lambda: BASE.tolist(),
    "__array__": lambda: Wrapped(BASE),
    "record array": lambda: np.rec.fromarrays(BASE.T, names="x,y,z"),
    "table": lambda: Table(intensity=[0] * 40, x=BASE[:, 0], y=BASE[:, 1], z=BASE[:, 2]),
    "masked, nothing masked": lambda: np.ma.masked_array(BASE, mask=False),
    "memory map": lambda: BASE.view(np.memmap),
    "long double": lambda: BASE.astype(np.longdouble),
    "cloud": lambda: batten.Cloud(BASE),
}


@pytest.mark.parametrize("kind", SAME)
def test_the_same_points_from_anything(kind):
    given = SAME[kind]()
    if isinstance(given, batten.Cloud):
        given = np.asarray(given)
    cloud = batten.Cloud(given)
    assert np.array_equal(cloud.points, BASE) and len(cloud) == 40 and cloud.dimension == 3


@pytest.mark.parametrize("dtype", [np.float32, np.float16, np.int8, np.int64, np.uint16])
@pytest.mark.parametrize("order", ["C", "F", "strided"])
def test_every_kind_of_number(dtype, order):
    numbers = np.random.default_rng(5).integers(0, 100, size=(30, 3)).astype(dtype)
    given = {"C": numbers, "F": np.asfortranarray(numbers), "strided": np.repeat(numbers, 3, axis=0)[::3]}[order]
    assert np.array_equal(batten.Cloud(given).points, numbers.astype(np.float64))


@pytest.mark.parametrize(
    "points, words",
    [
        (np.zeros((0, 3)).tolist(), "shape"),
        (np.zeros(3), "shape"),
        (np.zeros((4, 4)), "shape"),
        (np.zeros((2, 2, 2)), "shape"),
        (7, "shape"),
        (None, "points"),
        ("no such array", "points"),
        (np.full((5, 3), np.nan), "row 0 is not finite"),
        (np.vstack([BASE, [1, np.inf, 0]]), "row 40 is not finite"),
        (np.asfortranarray(np.vstack([BASE, [1, np.inf, 0]])), "row 40 is not finite"),
        (np.vstack([BASE, [1, np.nan, 0]]).astype(np.float32), "row 40 is not finite"),
        (BASE + 1j, "real numbers"),
        (BASE > 0.5, "real numbers"),
        (np.array([["a", "b", "c"]]), "real numbers"),
        (np.array([[1, 2, "x"]], dtype=object), "numbers"),
        ([[1, 2, 3], [1, 2]], "numbers|shape"),
        (np.ma.masked_array(BASE, mask=BASE > 0.5), "masked"),
        ({"x": 1}, "numbers|shape"),
        (np.zeros(3, dtype="datetime64[s]"), "real numbers"),
    ],
)
def test_what_is_no_cloud_names_points(points, words):
    with pytest.raises(ValueError, match="points: .*(" + words + ")|points: " if words == "points" else "(" + words + ")") as error:
        batten.Cloud(points)
    assert str(error.value).startswith("points")


def test_no_points_are_a_cloud_of_none():
    for empty in (np.zeros((0, 3)), np.zeros((0, 2)), np.zeros((0, 3), dtype=np.float32, order="F")):
        cloud = batten.Cloud(empty)
        assert len(cloud) == 0 and cloud.points.shape == empty.shape
        with pytest.raises(ValueError):
            cloud.statistics()
        with pytest.raises(ValueError):
            cloud.parts()


def test_attributes_and_their_refusals():
    n = np.tile([0.0, 0, 1], (40, 1))
    cloud = batten.Cloud(BASE, normals=n, weights=np.ones(40), colours=np.full((40, 3), 7, np.uint8), parameters=BASE[:, :2])
    assert np.array_equal(cloud.normals, n) and cloud.colours.dtype == np.uint8 and cloud.weights.shape == (40,)
    assert np.array_equal(cloud.parameters, BASE[:, :2]) and "normals, weights, colours, parameters" in repr(cloud)
    assert batten.Cloud(BASE).normals is None
    for name, value in [
        ("normals", n[:5]),
        ("normals", np.full((40, 3), np.nan)),
        ("weights", -np.ones(40)),
        ("weights", np.ones(39)),
        ("colours", np.zeros((40, 3))),
        ("colours", np.full((40, 3), 300)),
        ("parameters", np.zeros((40, 3))),
        ("parameters", np.zeros(3)),
    ]:
        with pytest.raises(ValueError, match=name):
            batten.Cloud(BASE, **{name: value})


def test_picked_points_keep_their_attributes():
    cloud = batten.Cloud(BASE, weights=np.arange(1.0, 41))
    some = cloud.pick([5, 3, 39])
    assert np.array_equal(some.points, BASE[[5, 3, 39]]) and np.array_equal(some.weights, [6, 4, 40])
    assert np.array_equal(cloud.pick(BASE[:, 0] > 0.5).points, BASE[BASE[:, 0] > 0.5])
    for wrong in ([40], [-1], [0.5], np.ones(39, bool), [[1]]):
        with pytest.raises(ValueError, match="which"):
            cloud.pick(wrong)


def test_far_points_keep_their_digits():
    far = BASE + [4.5e5, 5.4e6, 100]
    cloud = batten.Cloud(far)
    assert any(cloud.origin) and np.array_equal(cloud.points, far)


def test_memory_is_shared_and_outlives_the_cloud():
    cloud = batten.Cloud(BASE)
    points, again = cloud.points, cloud.points
    assert points.__array_interface__["data"] == again.__array_interface__["data"]
    assert not points.flags.writeable and points.flags.c_contiguous
    with pytest.raises(ValueError):
        points[0] = 0
    del cloud, again
    gc.collect()
    assert np.array_equal(points, BASE)


def test_values():
    cloud = batten.Cloud(BASE, weights=np.ones(40))
    for other in (pickle.loads(pickle.dumps(cloud)), copy.copy(cloud), copy.deepcopy(cloud)):
        assert cloud == other and hash(cloud) == hash(other)
    assert cloud != batten.Cloud(BASE) and cloud != BASE.tolist().__len__()
    assert np.array_equal(np.asarray(cloud), BASE) and np.asarray(cloud, dtype=np.float32).dtype == np.float32
    with pytest.raises(AttributeError):
        cloud.points = BASE


def test_statistics_know_spacing_noise_and_outliers():
    points = sheet(4000, 1e-3)
    points[:20, 2] += 0.5
    spacing, noise, outliers = batten.Cloud(points).statistics()
    assert spacing == pytest.approx(4000**-0.5, rel=0.3) and noise == pytest.approx(1e-3, rel=0.3)
    assert outliers[:20].all() and outliers.sum() < 40


def test_parts_are_told_apart():
    both = np.vstack([sheet(600), sheet(300) + [5, 0, 0]])
    first, second = batten.cloud_parts(both)
    assert set(first) == set(range(600)) and set(second) == set(range(600, 900))


def test_samples_lie_on_the_shape():
    cloud = batten.make.sphere(2.0).sample(500)
    assert len(cloud) == 500 and np.allclose(np.linalg.norm(cloud.points, axis=1), 2)
    assert cloud == batten.make.sphere(2.0).sample(500) != batten.make.sphere(2.0).sample(500, seed=2)
    noisy = batten.make.circle(1.0, center=(0, 0)).sample(500, noise=0.01)
    assert noisy.dimension == 2 and 0.005 < np.std(np.linalg.norm(noisy.points, axis=1)) < 0.02
    for keywords, name in [({"count": 0}, "count"), ({"noise": -1}, "noise"), ({"outliers": 2}, "outlier"), ({"seed": -1}, "seed")]:
        with pytest.raises(ValueError, match=name):
            batten.make.sphere(1).sample(**keywords)
