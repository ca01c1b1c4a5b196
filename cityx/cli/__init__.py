"""The command line."""

from __future__ import annotations


def main() -> None:
    """Run the command line and end the process; commands import the heavy modules they need."""
    import atexit

    from cityx.cli.main import main as run
    from cityx.system.parents import end_at_once

    try:
        run()
    except SystemExit as end:
        if not isinstance(end.code, int):
            raise
        atexit._run_exitfuncs()
        end_at_once(end.code)
