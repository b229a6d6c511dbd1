# SPDX-License-Identifier: BSD-3-Clause
"""What goes wrong: one exception for each kind of error of the library, all of them slamdb.Error."""

import errno
import os
from typing import Any, Dict, Tuple, Type

from .words import in_python_words


class Error(Exception):
    """What slamdb raises. `path`: of the file; `place`: where in it; `problem`: what is wrong, and what to do."""

    kind = "internal"

    def __init__(self, problem: str = "", path: str = "", place: str = "") -> None:
        super().__init__(": ".join(part for part in (path, place, problem) if part))
        self.path = path
        self.place = place
        self.problem = problem

    def __str__(self) -> str:
        return str(self.args[0])

    def __reduce__(self) -> Tuple[Any, ...]:
        return type(self), (self.problem, self.path, self.place)


class _SystemError(Error, OSError):
    """What the system says, with the members of an OSError: `errno`, `strerror`, `filename`."""

    _errno = 0

    def __init__(self, problem: str = "", path: str = "", place: str = "") -> None:
        super().__init__(problem, path, place)
        self.errno = self._errno
        self.strerror = os.strerror(self._errno)
        self.filename = path or None


class NotFoundError(_SystemError, FileNotFoundError):
    """No such file, atlas of a store, or entity."""

    kind = "not found"
    _errno = errno.ENOENT


class AlreadyExistsError(_SystemError, FileExistsError):
    """The output is there, and `overwrite=True` was not given."""

    kind = "already exists"
    _errno = errno.EEXIST


class AccessDeniedError(_SystemError, PermissionError):
    """The system denies it."""

    kind = "permission"
    _errno = errno.EACCES


class DamagedError(Error):
    """Bytes that cannot be what they claim: `slamdb.recover` saves what is whole."""

    kind = "damaged"


class UnsupportedError(Error):
    """Sound, but of a newer version, or of another program."""

    kind = "unsupported"


class LockedError(Error):
    """Another program is at work on it; trying again later may help."""

    kind = "locked"


class OutOfResourcesError(Error):
    """Memory, disk space or open files do not suffice."""

    kind = "out of resources"


class UsageError(Error, ValueError):
    """Arguments that make no sense."""

    kind = "usage"


class NotPossibleError(Error):
    """Sensible, but these atlases do not allow it."""

    kind = "not possible"


class InternalError(Error):
    """A fault of slamdb."""


_KINDS: Dict[str, Type[Error]] = {
    known.kind: known
    for known in (
        NotFoundError, AlreadyExistsError, AccessDeniedError, DamagedError, UnsupportedError, LockedError,
        OutOfResourcesError, UsageError, NotPossibleError, InternalError,
    )
}  # fmt: skip


def make_error(kind: str, path: str, place: str, problem: str) -> Error:
    return _KINDS[kind](in_python_words(problem), path, place)


class SlamdbWarning(UserWarning):
    """The result may not be what one expects. It is there when the warning is given, also where a filter raises it."""


class LossWarning(SlamdbWarning):
    """The output does not hold all that the atlas does.

    `strict=True` refuses that. A filter that makes errors of warnings does not: warnings are given when the work is
    done, so that the output is written, or the atlas changed, when one is raised.
    """
