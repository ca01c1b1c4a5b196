"""The command line. Heavy modules are imported by the commands that need them."""
# Annotations stay values in modules of commands: typer reads them at every start.

import os
import sys
import traceback
from functools import partial
from importlib.metadata import EntryPoint
from pathlib import Path
from tempfile import gettempdir
from typing import Annotated

import typer

from cityx.cli import build, changes
from cityx.cli.assets import assets
from cityx.cli.complaints import Wrong, usage_error
from cityx.cli.dataset import dataset
from cityx.cli.plugins import plugins
from cityx.cli.sim import sim
from cityx.cli.terminal import ENGINE_FAILED, please_report
from cityx.cli.tiles import tiles
from cityx.errors import CityxError, DiskError, InternalFault, UsageError
from cityx.system.atomic import disk_fault
from cityx.system.extensions import points_of, tried
from cityx.version import __version__

# Two threaded libraries on few cores spin against each other unless they sleep while they wait.
os.environ.setdefault("OMP_WAIT_POLICY", "PASSIVE")

app = typer.Typer(
    name="cityx",
    help="Maps, images, heights and drawings become explicit, editable 3D cities.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)
for _command in (
    build.build, changes.edit, changes.undo, changes.pull, build.explain, build.fetch,
    changes.render, build.check, changes.serve, changes.view, dataset, sim,
):  # fmt: skip
    app.command()(_command)
app.add_typer(plugins, name="plugins")
app.add_typer(assets, name="assets")
app.add_typer(tiles, name="tiles")


def _add(point: EntryPoint) -> None:
    app.add_typer(point.load(), name=point.name)


for _package, _point in points_of("cityx.commands"):  # commands of other packages
    _, _why = tried(partial(_add, _point))
    if _why:
        typer.echo(f"Command {_point.name} of package {_package} is left out: {_why}", err=True)


def _version(value: bool) -> None:
    if value:
        typer.echo(f"cityx {__version__}")
        raise typer.Exit


@app.callback()
def _root(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    del version


def main() -> None:
    """Run the command line and end with the documented exit codes."""
    try:
        code = app(prog_name="cityx", standalone_mode=False)
        sys.exit(code if isinstance(code, int) else 0)
    except Wrong as error:
        told = usage_error(error)
        typer.echo(f"error: {told}" if told else error.format_message(), err=True)
        sys.exit(UsageError.exit_code)
    except DiskError as error:
        _refused(str(error))
    except InternalFault as error:
        _own_fault(str(error))
    except CityxError as error:
        typer.echo(f"error: {error}", err=True)
        sys.exit(error.exit_code)
    except (KeyboardInterrupt, typer.Abort):
        typer.echo("interrupted", err=True)
        sys.exit(130)
    except Exception as error:  # noqa: BLE001  the last door before a user
        if refused := disk_fault(error):
            _refused(f"{refused}.")
        _own_fault(f"{type(error).__name__}: {error}")


def _refused(what: str) -> None:
    """Tell of a disk that does not take what is to be written, and end."""
    typer.echo(f"error: {what}", err=True)
    sys.exit(DiskError.exit_code)


def _own_fault(what: str) -> None:
    """Tell of a fault of this program itself, while it is handled, and end."""
    log = Path(gettempdir()) / f"cityx-{os.getpid()}.log"
    log.write_text(traceback.format_exc())
    typer.echo(f"error: CityX itself failed ({what}).", err=True)
    typer.echo(please_report(log), err=True)
    sys.exit(ENGINE_FAILED)
