"""The ``testbed`` command."""

import sys

from testbed import __version__


def main() -> None:
    """Answer ``--version`` at once and hand everything else to the command line proper."""
    if sys.argv[1:] == ["--version"]:
        print(f"testbed {__version__}")
        return
    from testbed.cli.app import run

    run()


if __name__ == "__main__":
    main()
