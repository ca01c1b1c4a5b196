"""Projects: a city with its revisions, on disk or in memory, and what can be done with it."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable, Mapping
from os import PathLike
from pathlib import Path
from tempfile import mkdtemp
from typing import TYPE_CHECKING, Any
from weakref import finalize

import numpy as np

from cityx.agents.briefs import Request
from cityx.agents.loop import quiet
from cityx.api import plan
from cityx.api.notebook import Pictures, Steps, project_page
from cityx.api.signatures import takes
from cityx.api.tables import Tables
from cityx.city import City
from cityx.city.content import stored_hash
from cityx.city.store import read_city
from cityx.errors import UsageError
from cityx.ids import id_text
from cityx.options import PlannerChoice, RenderOptions, options_from
from cityx.projects.desk import HISTORY, STORE, Desk, Revision
from cityx.projects.edit import edit_city, renew
from cityx.projects.results import (
    fresh_staging,
    products_in,
    publish,
    result_folder,
    stale_notes,
    stale_views,
)
from cityx.protocol.gate import Call, find_faults

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from pandas import DataFrame

    from cityx.api.page import Page
    from cityx.checks.predicates import Finding
    from cityx.dataset.making import Summary

Input = str | PathLike[str]
Progress = Callable[[str], None]


class Project(Tables):
    """A city with its revisions, made by `cityx.build` or `cityx.open`.

    Whatever changes the city happens whole or not at all, and is a revision that can be gone back
    to. Another process may change the same folder; the newest revision is what one sees.

    Parameters
    ----------
    folder
        Of a built city.
    private
        Whether the folder goes with the project, for a city that is held in memory.

    Raises
    ------
    InputError
        If the folder holds no city.
    """

    def __init__(self, folder: Path, *, private: bool = False) -> None:
        self._folder = folder.resolve()
        self._in_memory = private
        if private:
            self._cleanup = finalize(self, shutil.rmtree, self._folder.parent, ignore_errors=True)
        self._read: tuple[tuple[int, int], City] | None = None
        self._picture = "", b""  # of the city of a hash, for notebooks
        _ = self.city  # what is no city is refused now

    @property
    def folder(self) -> Path | None:
        """The folder of the city, None while it is held in memory."""
        return None if self._in_memory else self._folder

    @property
    def city(self) -> City:
        """The city as it is, a frozen value: what happens later does not change it."""
        store = self._folder / STORE
        try:
            signature = store.stat().st_ino, (store / "city.json").stat().st_mtime_ns
        except OSError:
            signature = (0, 0)
        if self._read is None or self._read[0] != signature:
            self._read = signature, read_city(store)
        return self._read[1]

    @property
    def report(self) -> dict[str, Any]:
        """What the build, the last change and the last check measured; ``report.json``."""
        path = self._folder / "report.json"
        found: dict[str, Any] = json.loads(path.read_text()) if path.is_file() else {}
        return found

    @property
    def hash(self) -> str:
        """Hash of all that the city holds, 64 hexadecimal digits; equal cities have equal ones."""
        return stored_hash(self._folder / STORE)

    @property
    def stale_views(self) -> dict[str, str | None]:
        """Files and pictures of the folder that are not known to show the city as it is.

        Each with the hash of the city that it shows: "" where a killed process left it, None where
        nothing is known. `check` and every change renew files of formats.
        """
        return stale_views(self._folder, self.hash)

    @property
    def revisions(self) -> tuple[Revision, ...]:
        """Every state of the city that can be gone back to, in order."""
        with Desk(self._folder) as desk:
            return desk.revisions()

    @property
    def revision(self) -> int:
        """The number of the revision that the city has."""
        return self.revisions[-1].number if self.revisions else 0

    # Changes.

    @takes(PlannerChoice)
    def edit(
        self, sentence: str, *files: Input, progress: Progress | None = None, **choice: Any
    ) -> Revision:
        """Change the city as a sentence says, whole or not at all.

        Parameters
        ----------
        sentence
            What is to change, or to be taken back.
        files
            Texts with more wishes, .blend files with curves to go along.
        progress
            As of `build`.
        choice
            Who reads the sentence: fields of `cityx.PlannerChoice`.

        Returns
        -------
        revision
            The new one. ``report["goals_of_change"]`` tells whether what was asked for came about.

        Raises
        ------
        Clarify
            If the sentence leaves open what is meant: a question with the candidates. Nothing has
            changed.
        UsageError, ActionFailed
            If no action does what is asked, or it cannot be done here; nothing has changed.
        """
        asked = options_from(PlannerChoice, choice)
        report = edit_city(
            self._folder, sentence, files=[Path(file) for file in files], choice=asked,
            say=progress or quiet,
        )  # fmt: skip
        return self._revision(report["revision"])

    def do(self, action: str, /, **arguments: Any) -> Revision:
        """Run one action of the registry on the city, whole or not at all.

        Parameters
        ----------
        action
            Id or name, as ``cityx plugins list`` shows them.
        arguments
            Its parameters, as ``cityx plugins show`` tells them. Ids of tables may be given as they
            are: ``objects=city.buildings.index[:3]``.

        Raises
        ------
        UsageError
            If there is no such action, or it does not take these arguments.
        ActionRejected, ActionFailed
            If it may not run on this city, or cannot do its work; nothing has changed.
        """
        plain = {name: _plain(value) for name, value in arguments.items()}
        with Desk(self._folder) as desk:
            call = Call(desk.actions.resolve(action), plain)
            faults = find_faults(call, desk.city, desk.actions)
            wrong = [fault.message for fault in faults if fault.code == "BAD_ARGS"]
            if wrong:
                raise UsageError("\n".join(wrong))
            before, content = desk.city, desk.content_at(desk.revision)
            revision = desk.change([call])
            renew(self._folder, desk.city, Request(), revision, before=before, content=content)
        return revision

    def undo(self, to: int | None = None) -> Revision:
        """Go back to the city before the last change, or to any revision by its number.

        Raises
        ------
        UsageError
            If there is no such revision.
        """
        return self._step(Desk.undo, to)

    def redo(self, to: int | None = None) -> Revision:
        """Make the change that was undone last again; as of `undo`."""
        return self._step(Desk.redo, to)

    def _step(self, step: Callable[..., Revision], to: int | None) -> Revision:
        with Desk(self._folder) as desk:
            revision = step(desk, to)
            renew(self._folder, desk.city, Request(), revision)
        return revision

    def _revision(self, number: int) -> Revision:
        return next(item for item in self.revisions if item.number == number)

    # Measures.

    def measure(self, predicate: str, *, since: int | None = None) -> Finding:
        """Measure a predicate, such as ``n(building, height >= 39) == 3``.

        Parameters
        ----------
        predicate
            In the language of `cityx.checks.predicates`.
        since
            Number of the revision that ``changed``, ``same``, ``gained`` and ``ratio`` compare
            with.

        Returns
        -------
        finding
            ``met``, None where it cannot be told, with ``evidence`` and ``value``.

        Raises
        ------
        UsageError
            If the text is no predicate, or there is no such revision.
        """
        from cityx.checks.predicates import measure

        return measure(predicate, self.city, before=None if since is None else self._at(since))

    def _at(self, number: int) -> City:
        revisions = self.revisions
        known = [item.number for item in revisions]
        if number not in known:
            raise UsageError(
                f"There is no revision {number}; they are {', '.join(map(str, known))}."
            )
        return self.city if number == known[-1] else read_city(self._folder / HISTORY / str(number))

    def check(self) -> DataFrame:
        """Measure the city against every limit, renew its report and return the checks.

        Returns
        -------
        checks
            A row for each: "ok", "value", "bound" (max or min) and "limit".
        """
        from pandas import DataFrame

        from cityx.projects.build import recheck

        checks = recheck(self._folder)["checks"]
        table = DataFrame.from_dict(checks, orient="index")
        return table[["ok", *(column for column in table if column != "ok")]]

    # What comes out.

    @takes(RenderOptions, without=("camera",))
    def render(self, camera: Input = "street", *, progress: Progress | None = None,
               **options: Any) -> Pictures:  # fmt: skip
        """Take pictures with Blender; the city stays as it is.

        Parameters
        ----------
        camera
            "street", "aerial", "top" or a JSON file of cameras.
        progress
            As of `build`.
        options
            Fields of `cityx.RenderOptions`: ``size=(1920, 1080)``, ``samples``, ``time``,
            ``weather``, ``moment``, ``frames``, ``exact``.

        Returns
        -------
        pictures
            Paths, shown in notebooks; ``pictures.path`` is the first. Those of a city in memory
            go with it.

        Raises
        ------
        UsageError
            If there is no such camera, or a word for time or weather is not known.
        EngineError, MissingDependency
            If Blender fails or cannot start.
        """
        from cityx.projects.views import render_views

        asked = options_from(RenderOptions, {"camera": str(camera), **options})
        return Pictures(render_views(self._folder, asked, say=progress or quiet))

    def export(self, format: str, path: Input | None = None, *,  # noqa: A002
               progress: Progress | None = None) -> Path:  # fmt: skip
        """Write the city in a format.

        Parameters
        ----------
        format
            "blend", "glb", "usd", "bodies" or "sumo".
        path
            A file, or a folder for its usual name; the project's own folder when None, where
            changes renew it. What a format writes besides its file goes beside it.
        progress
            As of `build`.

        Returns
        -------
        path
            The file.

        Raises
        ------
        UsageError
            If there is no such format, or the file cannot be written.
        EngineError, MissingDependency
            If the format needs something that fails or is not installed.
        """
        from cityx.projects.file_formats import formats_named
        from cityx.projects.views import make_views, renew_views

        (kind,) = formats_named([format])
        target = self._folder if path is None else Path(path)
        if path is None or target.is_dir() or not target.suffix:
            target /= kind.file
        work = Path(mkdtemp(prefix="cityx-export-"))
        try:
            target.parent.mkdir(parents=True, exist_ok=True)
            if target.resolve() == self._folder / kind.file:
                renew_views(self.city, self._folder, [kind.name], self.hash, say=progress or quiet)
                return target
            make_views(self.city, work, [format], store=self._folder / STORE, say=progress or quiet)
            for made in sorted(work.iterdir()):
                to = target if made.name == kind.file else target.parent / made.name
                if made.is_dir() and to.is_dir():
                    shutil.rmtree(to)
                shutil.move(made, to)
        except OSError as error:
            raise UsageError(f"{target} cannot be written: {error.strerror}.") from error
        finally:
            shutil.rmtree(work, ignore_errors=True)
        return target

    def dataset(
        self, out: Input, *, views: int | None = None, size: tuple[int, int] | None = None,
        fov: float | None = None, workers: int = 1, cluster: str = "",
        disk_budget: float | None = None, skip_failed: bool = False,
        progress: Progress | None = None, **options: Any,
    ) -> Summary:  # fmt: skip
        """Take pictures of the city with ground truth for every pixel.

        Parameters
        ----------
        out
            Folder of the dataset; a run that was killed goes on there.
        views
            Shots, 100 when None, or all of a file of cameras.
        size, fov
            Pixels of a picture, and its horizontal field of view in degrees.
        workers, cluster
            Processes of this machine, or workers of dask.
        disk_budget
            GB that the dataset may take.
        skip_failed
            Whether to finish without shots that cannot be taken.
        progress
            As of `build`.
        options
            Fields of `cityx.dataset.order.Order`: ``plan``, ``rig``, ``channels=["rgb", "depth"]``,
            ``formats=["coco"]``, ``quality``, ``samples``, ``lidar``, ``boxes``, ``seed``, ...

        Returns
        -------
        summary
            How many shots were made, their size, and what failed.

        Raises
        ------
        UsageError, InputError, MissingExtra
            With every fault of what is asked for; nothing was written.
        """
        from cityx.dataset.making import Running, make_dataset
        from cityx.dataset.order import Faults, Order, sources_of

        faults = Faults()
        order = options_from(Order, options).completed(views, size, fov)
        sources = sources_of([self._folder], "", faults)
        budget = None if disk_budget is None else int(disk_budget * 1e9)
        running = Running(
            workers, cluster, budget, skip_failed=skip_failed, faults=faults,
            command="cityx.Project.dataset(...)",
        )  # fmt: skip
        return make_dataset(order, sources, Path(out), running, Steps(progress or quiet))

    def save(self, folder: Input) -> Path:
        """Put the city with its revisions into a folder, where the project goes on.

        A city that was there is replaced, as by a build.

        Raises
        ------
        UsageError
            If the folder holds other things, or cannot be made.
        """
        out = result_folder(Path(folder))
        if out == self._folder:
            return out
        if out.exists() and {entry.name for entry in out.iterdir()} - {*products_in(out), HISTORY}:
            raise UsageError(f"{out} holds other files; give a new folder for the city.")
        with fresh_staging(out) as staging:
            with Desk(self._folder):  # nobody changes it meanwhile
                shutil.copytree(self._folder, staging, dirs_exist_ok=True)
            shutil.rmtree(out / HISTORY, ignore_errors=True)
            publish(staging, out)
        if self._in_memory:
            self._cleanup()
        self._folder, self._in_memory, self._read = out, False, None
        return out

    # How it looks.

    def plot(self, ax: Axes | None = None, **style: Any) -> Axes:
        """Draw the plan with matplotlib: ground, streets, buildings; see `plan.plot_city`."""
        return plan.plot_city(self.city, ax, **style)

    def explore(self, column: str = "height", **style: Any) -> Any:
        """Return an interactive map of roads and buildings over tiles of the web.

        Parameters
        ----------
        column
            Of `buildings`, that colours them.
        style
            Arguments of `geopandas.GeoDataFrame.explore`.

        Raises
        ------
        MissingDependency
            If folium is not installed.
        """
        plan.require_folium()
        shown = self.roads[["name", "kind", "lanes", "width", "geometry"]]
        base = shown.explore(color="#777777", **style)
        columns = dict.fromkeys((column, "name", "use", "height", "levels", "geometry"))
        return self.buildings[[*columns]].explore(m=base, column=column, **style)

    def view(self) -> Page:
        """Show the city in a browser or a notebook: `cityx view`, in a process of its own.

        Changes there and here are seen by both sides. The page ends with what is returned.

        Returns
        -------
        page
            Shown by notebooks as a frame; ``page.url``, ``page.close()``.

        Raises
        ------
        MissingExtra
            Without ``pip install "cityx[view]"``.
        """
        from cityx.api.page import Page

        return Page(self._folder)

    def __repr__(self) -> str:
        """Return a dozen lines: what it is, where it lies, what it holds."""
        where = "in memory" if self._in_memory else str(self._folder)
        revisions = self.revisions
        stale = "".join(f"\n  {note}" for note in stale_notes(self.stale_views))
        last = f", last: {revisions[-1].text[:60]}" if revisions and revisions[-1].text else ""
        return (
            f"Project {where}\n{self.city!r}\n"
            f"  revisions   {len(revisions)}{last}\n"
            f"  hash        {self.hash[:16]}{stale}"
        )

    def _repr_html_(self) -> str:
        from cityx.api.picture import picture_of
        from cityx.city.store import view_of

        if self._picture[0] != self.hash:
            self._picture = self.hash, picture_of(view_of(self.city))
        return project_page(repr(self), plan.svg_of(self.city), self._picture[1])


def _plain(value: Any) -> Any:
    """Return a value of NumPy, a path or a tuple as plain JSON has it; uint64 are ids, as texts."""
    if isinstance(value, Path):
        return str(value)
    if isinstance(value, Mapping):
        return {key: _plain(one) for key, one in value.items()}
    if isinstance(value, tuple | list):
        return [_plain(one) for one in value]
    if getattr(value, "dtype", None) == np.uint64:
        return list(map(id_text, value)) if np.ndim(value) else id_text(value)
    return value.tolist() if hasattr(value, "tolist") else value
