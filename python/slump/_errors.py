"""What can go wrong, each with the sentence of the command line."""


class Error(Exception):
    """Whatever the program refuses or fails at."""


class InputError(Error, ValueError):
    """A value that is not allowed: the sentence names the field, the value and what is allowed."""


class FileError(Error, OSError):
    """A file that cannot be read or written, or is none of its kind."""


class NotFiniteError(Error, ArithmeticError):
    """A state that is no longer finite. The simulation is left as it is, for looking at."""


class SlumpWarning(UserWarning):
    """Something went wrong in a simulation that goes on; the sentence says what is most likely to help."""
