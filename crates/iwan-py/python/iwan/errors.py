"""What can go wrong: one tree under `IwanError`, with Python's own classes beside it where they say the same."""


class IwanError(Exception):
    """Anything that iwan refuses or cannot do.

    `kind` is its name in the catalogue of errors, the same as in the error object of `iwan --json`.
    """

    kind: str = "failed"


class InvalidValueError(IwanError, ValueError):
    """A value out of its range; the message names it, what is allowed and what helps."""

    kind = "value"


class InvalidTypeError(IwanError, TypeError):
    """An array or option of a type that does not fit, such as complex numbers."""

    kind = "value"


class RecordError(InvalidValueError):
    """A file whose content is no record; the message names the place in it."""

    kind = "damaged"


class StructureError(InvalidValueError):
    """A structure file that cannot be computed with; the message names file, line, key and what helps."""

    kind = "input"


class IdentificationError(InvalidValueError):
    """A record from which the quantity asked for cannot be had."""

    kind = "refused"


class ComputationError(IwanError, ArithmeticError):
    """A computation that failed: numbers that overflowed."""


class FileError(IwanError, OSError):
    """A file that cannot be read or written."""

    kind = "unreadable"


class ExistingFileError(FileError, FileExistsError):
    """A file that is there already and was not to be overwritten."""

    kind = "exists"


class MissingFileError(FileError, FileNotFoundError):
    """A file that is not there."""
