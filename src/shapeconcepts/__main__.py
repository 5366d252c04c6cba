"""The command `shapeconcepts`, and `python -m shapeconcepts`."""

from shapeconcepts.interruption import end_at_signals


def main() -> None:
    """Entry point of the command."""
    end_at_signals()
    # This takes a while, in which Ctrl-C must end the command as well.
    from shapeconcepts.cli import main

    main()


if __name__ == "__main__":
    main()
