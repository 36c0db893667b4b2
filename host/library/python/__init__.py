# SPDX-License-Identifier: MIT
"""Finds a shoe's bite line, and plans a robot's path along it.  Lengths in mm, angles in rad; see help(biteline.find_line)."""
from ._native import *  # noqa: F401,F403
from ._native import __version__  # noqa: F401


class Error(Exception):
    """A failure that the world caused; str() is one line: what, and where.  next_step: what a person can do."""

    next_step = ""


class Refused(Error):
    """Input that can be read, and gives no result to trust.  reason_code: a name that stays."""

    reason_code = ""


from . import _native as _native  # noqa: E402

_native._raise_as(Error, Refused)  # noqa: F405
