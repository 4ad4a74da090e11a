# SPDX-License-Identifier: MIT
"""What tells how far work is: a callable of the caller's, tqdm's bar, or one of our own."""
from __future__ import annotations

import contextlib
import sys
import time
from typing import Any, Callable, Iterator, Optional

Tell = Callable[[str, float], Any]

WIDTH = 30
PATIENCE = 0.5  # seconds before a bar shows: most fits are done by then


@contextlib.contextmanager
def callback(progress: Any) -> Iterator[Optional[Tell]]:
    """progress(stage, fraction) for the library: none, the caller's, or a bar that goes when the work is done."""
    if progress is None or progress is False:
        yield None
    elif progress is True:
        bar = _tqdm() or _Bar()
        try:
            yield bar.tell
        finally:
            bar.close()
    elif callable(progress):
        yield progress
    else:
        raise ValueError(f"progress: {progress!r} is neither callable nor True")


class _Bar:
    def __init__(self) -> None:
        self._begin = time.monotonic()
        self._drawn = False

    def tell(self, stage: str, fraction: float) -> None:
        if time.monotonic() - self._begin < PATIENCE and not self._drawn:
            return
        full = int(WIDTH * fraction)
        sys.stderr.write(f"\r{stage:<14}|{'█' * full}{' ' * (WIDTH - full)}| {100 * fraction:3.0f} %")
        sys.stderr.flush()
        self._drawn = True

    def close(self) -> None:
        if self._drawn:
            sys.stderr.write("\r" + " " * (WIDTH + 24) + "\r")
            sys.stderr.flush()


class _Tqdm:
    def __init__(self, tqdm: Any) -> None:
        self._bar = tqdm(total=100, unit="%", leave=False, delay=PATIENCE)

    def tell(self, stage: str, fraction: float) -> None:
        self._bar.set_description(stage, refresh=False)
        self._bar.update(100 * fraction - self._bar.n)

    def close(self) -> None:
        self._bar.close()


def _tqdm() -> Optional[_Tqdm]:
    try:
        from tqdm.auto import tqdm
    except ImportError:
        return None
    return _Tqdm(tqdm)
