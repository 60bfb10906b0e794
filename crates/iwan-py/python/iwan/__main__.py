"""The command `iwan`: the same program as the one built by cargo."""

import sys

from iwan._native import _command


def main() -> int:
    """Run the command line of this process and return the exit code."""
    return _command(["iwan", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
