"""Errors and warnings, with the messages of the command line."""


class Error(Exception):
    """Base class of all errors of Slump."""


class InputError(Error, ValueError):
    """A value that is not allowed. The message names the field, the value and the allowed values."""


class FileError(Error, OSError):
    """A file that cannot be read or written, or has the wrong form."""


class NotFiniteError(Error, ArithmeticError):
    """A state that is no longer finite. The simulation keeps this state for inspection."""


class SlumpWarning(UserWarning):
    """A problem that does not stop the simulation. The message names the most likely remedy."""
