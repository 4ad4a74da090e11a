# SPDX-License-Identifier: MIT
"""Arrays from what callers hold, each refusal naming the argument."""
from __future__ import annotations

import math
import os
from typing import Any, List, Optional, Sequence, Tuple, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
Path = Union[str, "os.PathLike[str]"]


def is_path(value: Any) -> bool:
    return isinstance(value, (str, os.PathLike))


def path_bytes(name: str, path: Any) -> bytes:
    try:
        given = os.fsencode(path)
    except TypeError:
        raise ValueError(f"{name}: {path!r} is not a path") from None
    if b"\0" in given:
        raise ValueError(f"{name}: {path!r} holds a zero byte")
    return given


def plain(name: str, value: Any) -> NDArray[Any]:
    """The value as an array of real numbers, of whatever kind they are."""
    if isinstance(value, np.ma.MaskedArray):
        if np.any(value.mask):
            raise ValueError(f"{name}: holds masked values; leave them out with .compressed() or a row mask")
        value = value.data
    try:
        array = np.asarray(value)
    except ValueError as error:
        raise ValueError(f"{name}: is no array of numbers ({error})") from None
    kind = array.dtype.kind
    if kind == "O":
        try:
            array = array.astype(np.float64)
        except (TypeError, ValueError) as error:
            raise ValueError(f"{name}: is no array of numbers ({error})") from None
    elif kind not in "fiu":
        raise ValueError(f"{name}: an array of real numbers is needed, not of {array.dtype}")
    return array


def doubles(name: str, value: Any, *shape: Optional[int]) -> Floats:
    """C-contiguous doubles; with a shape given, of that (None: any length)."""
    array = np.asarray(plain(name, value), dtype=np.float64, order="C")
    if shape and (array.ndim != len(shape) or any(want not in (None, have) for want, have in zip(shape, array.shape))):
        wanted = ", ".join("N" if want is None else str(want) for want in shape) + ("," if len(shape) == 1 else "")
        raise ValueError(f"{name}: an array of shape ({wanted}) is needed, not {array.shape}")
    return array


def finite(name: str, value: Any, *shape: Optional[int]) -> Floats:
    array = doubles(name, value, *shape)
    if not np.isfinite(array).all():
        raise ValueError(f"{name}: not all numbers are finite")
    return array


def broadcast(u: ArrayLike, v: ArrayLike) -> Tuple[Floats, Floats, Tuple[int, ...]]:
    """u and v as flat arrays of one size, and the shape that they have together."""
    a, b = doubles("u", u), doubles("v", v)
    if a.shape != b.shape:
        try:
            first, second = np.broadcast_arrays(a, b)
        except ValueError:
            raise ValueError(f"u, v: shapes {a.shape} and {b.shape} do not go together") from None
        a, b = np.ascontiguousarray(first), np.ascontiguousarray(second)
        return a.reshape(-1), b.reshape(-1), first.shape
    return a.reshape(-1), b.reshape(-1), a.shape


def whole(name: str, value: Any, least: Optional[int] = None) -> int:
    try:
        if isinstance(value, (bool, np.bool_)):
            raise TypeError
        number = int(value.__index__())
    except (AttributeError, TypeError):
        raise ValueError(f"{name}: {value!r} is not a whole number") from None
    if least is not None and number < least:
        raise ValueError(f"{name}: {number} is below {least}")
    if abs(number) > 2**31 - 1:
        raise ValueError(f"{name}: {number} is out of range")
    return number


def wholes(name: str, value: Any) -> List[int]:
    """Whole numbers of any array, one after the other."""
    return [whole(name, one) for one in np.asarray(plain(name, value)).reshape(-1).tolist()]


def range_of(name: str, value: Any) -> Tuple[float, float]:
    a, b = finite(name, value, 2)
    return float(a), float(b)


def in_space(name: str, value: Any, dimension: int) -> Floats:
    """A point of so many coordinates with z = 0 where it is missing."""
    given = finite(name, value, dimension)
    return np.concatenate([given, np.zeros(3 - dimension)])


def number(name: str, value: Any) -> float:
    try:
        given = math.nan if isinstance(value, (bool, np.bool_, str)) else float(value)
    except (TypeError, ValueError):
        given = math.nan
    if math.isnan(given):
        raise ValueError(f"{name}: {value!r} is not a number")
    return given


def plane_numbers(name: str, plane: Any) -> Tuple[float, float, float, float]:
    a, b, c, d = finite(name, plane, 4)
    if a == b == c == 0:
        raise ValueError(f"{name}: a, b and c are all zero: no normal")
    return float(a), float(b), float(c), float(d)


def one_of(name: str, value: Any, words: Sequence[str]) -> str:
    if not isinstance(value, str) or value not in words:
        raise ValueError(f"{name}: {value!r} is none of " + ", ".join(repr(word) for word in words))
    return value
