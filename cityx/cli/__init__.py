"""The command line."""

from __future__ import annotations


def main() -> None:
    """Run the command line; heavy modules are imported by the commands that need them."""
    from cityx.cli.main import main as run

    run()
