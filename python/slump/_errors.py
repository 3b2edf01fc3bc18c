"""Exceptions and warnings of the package. Their messages are the same as on the command line."""


class Error(Exception):
    """Base class of all errors of Slump."""


class InputError(Error, ValueError):
    """Raised if a value is not allowed. The message names the field, the value and the allowed values."""


class FileError(Error, OSError):
    """Raised if a file cannot be read or written, or has the wrong format."""


class NotFiniteError(Error, ArithmeticError):
    """Raised if the state is no longer finite. The simulation keeps this state for inspection."""


class SlumpWarning(UserWarning):
    """Warning of a problem that does not stop the simulation. The message names the change most likely to help."""
