# SPDX-License-Identifier: MIT
"""What goes wrong: data that can't be fitted, files that can't be read or written, work that was stopped."""
from __future__ import annotations

import os
import re
from typing import Optional, Tuple

_NUMBER = re.compile(r"(?<![\w.])[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?(?![\w])")
_PLACED = re.compile(r"^(?P<file>.+?): (?:line (?P<line>\d+)|byte (?P<byte>\d+)): (?P<reason>.*)$", re.DOTALL)


class FitRefused(ValueError):
    """Points that no geometry of the kind can be fitted to.

    Attributes
    ----------
    reason : str
        One sentence for people.
    numbers : tuple of float
        The numbers in that sentence, in its order.
    remedy : str or None
        What may help, as a keyword of the call: ``"base='sheet'"``.
    """

    def __init__(self, reason: str, remedy: str = "") -> None:
        super().__init__(reason + (f" (try {remedy})" if remedy else ""))
        self.reason = reason
        self.numbers: Tuple[float, ...] = tuple(float(word) for word in _NUMBER.findall(reason))
        self.remedy: Optional[str] = remedy or None

    def __reduce__(self):  # type: ignore[no-untyped-def]
        return type(self), (self.reason, self.remedy or "")


class ReadError(OSError):
    """A file that can't be read, or does not hold what its format promises.

    Attributes
    ----------
    file : str
        Its path, or several joined.
    line, byte : int or None
        Where it went wrong, from 1 and from 0.
    reason : str
        What is wrong there.
    """

    def __init__(self, message: str) -> None:
        super().__init__(message)
        self.line: Optional[int] = None
        self.byte: Optional[int] = None
        placed = _PLACED.match(message)
        if placed:
            self.file, self.reason = placed["file"], placed["reason"]
            self.line = int(placed["line"]) if placed["line"] else None
            self.byte = int(placed["byte"]) if placed["byte"] else None
            return
        ends = [at.start() for at in re.finditer(": ", message)] or [len(message)]
        end = next((e for e in ends if os.path.exists(message[:e])), ends[0])  # a path may hold ": "
        self.file, self.reason = message[:end], message[end + 2 :]

    def __str__(self) -> str:
        return str(self.args[0])


class WriteError(OSError):
    """A file that can't be written; nothing half-written is left.

    Attributes
    ----------
    file : str
        Its path.
    """

    def __init__(self, message: str) -> None:
        super().__init__(message)
        self.file = message.split(": ")[0]

    def __str__(self) -> str:
        return str(self.args[0])


class DoubtWarning(UserWarning):
    """A result may be wrong, and why, as ``report["doubt"]`` has it; the program ends with 4 then."""


class ReadWarning(UserWarning):
    """How a file was understood where that is not plain, or what of it was not read."""


class Cancelled(RuntimeError):
    """``progress`` returned False before there was anything to return."""
