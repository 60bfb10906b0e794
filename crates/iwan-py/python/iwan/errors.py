"""What can go wrong: one tree under `IwanError`, with Python's own classes beside it where they say the same."""


class IwanError(Exception):
    """Anything that iwan refuses or cannot do."""


class InvalidValueError(IwanError, ValueError):
    """A value out of its range; the message names it, what is allowed and what helps."""


class InvalidTypeError(IwanError, TypeError):
    """An array or option of a type that does not fit, such as complex numbers."""


class RecordError(InvalidValueError):
    """A file whose content is no record; the message names the place in it."""


class StructureError(InvalidValueError):
    """A structure file that cannot be computed with; the message names file, line, key and what helps."""


class IdentificationError(InvalidValueError):
    """A record from which the quantity asked for cannot be had."""


class ComputationError(IwanError, ArithmeticError):
    """A computation that failed: numbers that overflowed."""


class FileError(IwanError, OSError):
    """A file that cannot be read or written."""


class ExistingFileError(FileError, FileExistsError):
    """A file that is there already and was not to be overwritten."""


class MissingFileError(FileError, FileNotFoundError):
    """A file that is not there."""
