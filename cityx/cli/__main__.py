"""The command line as ``python -m cityx.cli``."""

from cityx.cli import main

main()
