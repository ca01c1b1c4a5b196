"""Copies of the folders that tests share."""

from pathlib import Path
from shutil import copytree, ignore_patterns


def copy_of(folder, out):
    """Copy a stored city; a reader in another process makes and removes files beside a journal."""
    return Path(copytree(folder, out, ignore=ignore_patterns("*-wal", "*-shm")))
