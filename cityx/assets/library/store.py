"""The library on disk: a table, packs of geometry, pictures and an index.

``library.json`` names the table, the index and the file of fittings that belong together; it is
written last, so whatever is killed meanwhile, a reader sees the library before or after.
"""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from hashlib import blake2b
from pathlib import Path
from typing import Any
from uuid import uuid4

import numpy as np
import shapely

from cityx.assets.library.encoding import Encoder, Vectors, check_same
from cityx.assets.library.index import BruteForceIndex, open_index, write_index
from cityx.assets.library.models import (
    Models,
    content_hashes,
    fitting_names,
    join_models,
    read_pack,
    read_prototypes,
    write_pack,
    write_prototypes,
)
from cityx.assets.library.records import (
    COLUMNS,
    GROUPS,
    SOURCES,
    Catalogue,
    join_catalogues,
    make_catalogue,
)
from cityx.city.scene import Prototype
from cityx.errors import InputError, UsageError
from cityx.ids import id_text, stable_id
from cityx.system.atomic import replaced

FORMAT = 1
HEAD = "library.json"


@dataclass(frozen=True)
class Library:
    """A library as it was when it was opened.

    Attributes
    ----------
    folder
        Where it lies.
    head
        What ``library.json`` says.
    catalogue
        The records, sorted by id.
    """

    folder: Path
    head: Mapping[str, Any]
    catalogue: Catalogue

    @property
    def encoder(self) -> str:
        """Identity of the encoder of its index."""
        return str(self.head["encoder"])

    @cached_property
    def index(self) -> BruteForceIndex:
        """The index; its rows are those of the catalogue."""
        index = open_index(self.folder / self.head["index"])
        if len(index) != len(self.catalogue):
            raise InputError(
                f"{self.folder}: the index has {len(index)} vectors for {len(self.catalogue)} "
                "records; make it anew with: cityx assets embed."
            )
        return index

    @cached_property
    def fittings(self) -> Mapping[str, Prototype]:
        """Prototypes that building assets share, by name."""
        name = self.head["fittings"]
        return read_prototypes(self.folder / name) if name else {}

    def models(self, rows: Any) -> Models:
        """Read the geometry of some assets, in the order of the rows.

        Raises
        ------
        InputError
            If a pack is missing or broken.
        """
        wanted = np.asarray(rows, np.int64)
        if not len(wanted):
            raise UsageError("No assets were asked for.")
        paths = self.catalogue["path"][wanted]
        names = self.catalogue["collection"][wanted]
        parts, order = [], []
        for path in sorted(set(paths.tolist())):
            of = np.flatnonzero(paths == path)
            models, held = read_pack(self.folder / path, self.fittings)
            number = {name: index for index, name in enumerate(held)}
            missing = [name for name in names[of].tolist() if name not in number]
            if missing:
                raise InputError(f"{self.folder / path} lacks the asset {missing[0]}.")
            parts.append(models.take([number[name] for name in names[of].tolist()]))
            order.append(of)
        place = np.argsort(np.concatenate(order), kind="stable")
        return join_models(parts).take(place)

    def row_of(self, name: str) -> int:
        """Return the row of an asset by its id (or the beginning of it) or its name.

        Raises
        ------
        UsageError
            If none or several are meant.
        """
        ids = [id_text(number) for number in self.catalogue["id"].tolist()]
        names = self.catalogue["collection"].tolist()
        exact = [row for row, text in enumerate(ids) if text == name]
        exact = exact or [row for row, text in enumerate(names) if text == name]
        found = exact or [row for row, text in enumerate(ids) if len(name) >= 4
                          and text.startswith(name)]  # fmt: skip
        if len(found) == 1:
            return found[0]
        if found:
            raise UsageError(f'"{name}" may mean {len(found)} assets of {self.folder}.')
        from cityx.errors import nearest

        raise UsageError(f'{self.folder} has no asset "{name}".{nearest(name, names)}')


def is_library(folder: Path) -> bool:
    """Return whether a folder holds a library."""
    return (folder / HEAD).is_file()


def open_library(folder: Path) -> Library:
    """Open a library.

    Raises
    ------
    InputError
        If the folder holds none, one of a newer format, or a broken one.
    """
    if not is_library(folder):
        raise InputError(
            f"{folder} holds no library: {HEAD} is missing. Make one with: cityx assets grow."
        )
    try:
        head = json.loads((folder / HEAD).read_text())
        if head["format"] != FORMAT:
            raise ValueError(f"its format is {head['format']}, this program reads {FORMAT}")
        catalogue = read_table(folder / head["table"])
    except (OSError, ValueError, KeyError) as error:
        raise InputError(f"{folder} is no library that can be read: {error}.") from error
    if len(catalogue) != head["count"]:
        raise InputError(
            f"{folder}: the table has {len(catalogue)} records, {HEAD} says {head['count']}."
        )
    return Library(folder, head, catalogue)


class LibraryWriter:
    """Adds assets to a library; a class because packs are written as they come.

    A new library is made in a hidden folder and renamed when it is complete. An older one gets new
    files beside its own, which count only once the new ``library.json`` stands.

    Parameters
    ----------
    folder
        The library.
    anew
        Whether an older library there is replaced.
    """

    def __init__(self, folder: Path, *, anew: bool = False) -> None:
        self.folder = folder
        if folder.exists() and not folder.is_dir():
            raise UsageError(f"{folder} is a file; give a folder for the library.")
        self.old: Library | None = None
        if is_library(folder) and not anew:
            self.old = open_library(folder)
            self.work = folder
        else:
            if folder.exists() and any(folder.iterdir()) and not is_library(folder):
                raise UsageError(f"{folder} holds other things; give a folder of its own.")
            self.work = folder.parent / f".{folder.name}.partial"
            shutil.rmtree(self.work, ignore_errors=True)  # what a killed process left
            try:
                self.work.mkdir(parents=True)
            except OSError as error:
                raise UsageError(f"{folder} cannot be made: {error.strerror}.") from error
        self.known = dict(self.old.fittings) if self.old else {}
        self.parts: list[Catalogue] = []
        self.hashes: set[str] = set(self.old.catalogue["content_hash"]) if self.old else set()
        self.duplicates = 0

    def __enter__(self) -> LibraryWriter:
        """Begin."""
        return self

    def __exit__(self, *_: object) -> None:
        """Remove what was not committed."""
        if self.work != self.folder:
            shutil.rmtree(self.work, ignore_errors=True)

    def add(self, records: Catalogue, models: Models, *, limit: int | None = None) -> int:
        """Write one pack of assets, those left out that the library has already.

        Parameters
        ----------
        records
            n records; id, path, content_hash and counts of triangles are filled in.
        models
            Their geometry.
        limit
            Most assets to take.

        Returns
        -------
        added
            Number of assets taken.
        """
        hashes = [id_text(number) for number in content_hashes(models).tolist()]
        fresh: list[int] = []
        for row, text in enumerate(hashes):
            if text in self.hashes:
                self.duplicates += 1
            elif limit is None or len(fresh) < limit:
                self.hashes.add(text)
                fresh.append(row)
        if not fresh:
            return 0
        rows = np.array(fresh, np.int64)
        records, models = records.take(rows), models.take(rows)
        groups = records["group"]
        texts = [hashes[row] for row in fresh]
        own, seen = models.triangles()
        names, added = fitting_names(models.prototypes, self.known)
        self.known |= added
        digest = blake2b("".join(texts).encode(), digest_size=8).hexdigest()
        path = f"{groups[0]}/{digest}.npz"
        with replaced(self.work / path) as temporary:
            write_pack(temporary, models, records["collection"].tolist(), names)
        self.parts.append(
            records.replaced(
                id=[stable_id("asset", text) for text in texts], path=[path] * len(texts),
                content_hash=texts, triangles=seen, triangles_unique=own,
            )
        )  # fmt: skip
        return len(fresh)

    def commit(self, encoder: Encoder, more: Mapping[str, Any] | None = None) -> Library:
        """Embed what was added, write table and index, and let them count.

        Parameters
        ----------
        encoder
            Encoder of the descriptions; that of the older index, if there is one.
        more
            Further entries of ``library.json``.

        Raises
        ------
        UsageError
            If the older index was made with another encoder.
        """
        old = self.old
        added = join_catalogues(self.parts)
        vectors = encode_records(added, encoder, self.work)
        if old is not None and len(old.catalogue):
            check_same(encoder.identity, old.encoder)
            vectors = np.concatenate([np.asarray(old.index.vectors, np.float32), vectors])
            added = join_catalogues([old.catalogue, added])
        order = np.argsort(added["id"], kind="stable")
        head = dict(old.head) if old else {}
        return _commit(
            self.folder, self.work, added.take(order), vectors[order], encoder.identity,
            {**head, **(more or {})}, fittings=self.known,
        )  # fmt: skip


def encode_records(catalogue: Catalogue, encoder: Encoder, folder: Path) -> Vectors:
    """Embed assets: pictures where the encoder sees and all have one, else their descriptions."""
    if not len(catalogue):
        return np.zeros((0, 768), np.float32)
    renders = catalogue["render"].tolist()
    if encoder.sees and all(renders):
        return encoder.encode_images([folder / path for path in renders])
    return encoder.encode_text(catalogue["description"].tolist())


def embed_library(library: Library, encoder: Encoder) -> Library:
    """Rebuild the index of a library with an encoder."""
    vectors = encode_records(library.catalogue, encoder, library.folder)
    return _commit(
        library.folder, library.folder, library.catalogue, vectors, encoder.identity,
        dict(library.head), fittings=None,
    )  # fmt: skip


def set_renders(library: Library, rows: Sequence[int], paths: Sequence[str]) -> Library:
    """Note the pictures of some assets in the table."""
    renders = library.catalogue["render"].copy()
    renders[np.asarray(rows, np.int64)] = list(paths)
    vectors = np.asarray(library.index.vectors, np.float32)
    return _commit(
        library.folder, library.folder, library.catalogue.replaced(render=renders), vectors,
        library.encoder, dict(library.head), fittings=None,
    )  # fmt: skip


def _commit(
    folder: Path,
    work: Path,
    catalogue: Catalogue,
    vectors: Vectors,
    encoder: str,
    head: dict[str, Any],
    *,
    fittings: Mapping[str, Prototype] | None,
) -> Library:
    """Write what belongs together under names that follow from the content, then the head."""
    with replaced(work / "table.parquet") as temporary:
        write_table(temporary, catalogue)
    table = f"table-{_digest(work / 'table.parquet')}.parquet"
    (work / "table.parquet").replace(work / table)
    staged = work / f".index-{uuid4().hex[:12]}.partial"
    try:
        write_index(staged, vectors, encoder)
        index = f"index-{_digest(staged / 'vectors.f16', encoder)}"
        if not (work / index).exists():
            staged.rename(work / index)
    finally:
        shutil.rmtree(staged, ignore_errors=True)
    shared = head.get("fittings", "")
    if fittings is not None:
        shared = _write_fittings(work, fittings)
    groups, counts = np.unique(catalogue["group"].astype(str), return_counts=True)
    head |= {
        "format": FORMAT,
        "count": len(catalogue),
        "groups": dict(zip(groups.tolist(), counts.tolist(), strict=True)),
        "encoder": encoder,
        "table": table,
        "index": index,
        "fittings": shared,
    }
    with replaced(work / HEAD) as temporary:
        temporary.write_text(json.dumps(head, indent=1, sort_keys=True))
    if work != folder:
        from cityx.city.store import replace_folder

        folder.parent.mkdir(parents=True, exist_ok=True)
        replace_folder(work, folder)
    _sweep(folder, head, catalogue)
    return open_library(folder)


def _write_fittings(work: Path, fittings: Mapping[str, Prototype]) -> str:
    if not fittings:
        return ""
    path = work / "fittings.npz"
    write_prototypes(path, fittings.values())
    name = f"fittings-{_digest(path)}.npz"
    path.replace(work / name)
    return name


def _digest(path: Path, *more: str) -> str:
    hasher = blake2b("".join(more).encode(), digest_size=8)
    hasher.update(path.read_bytes())
    return hasher.hexdigest()


def _sweep(folder: Path, head: Mapping[str, Any], catalogue: Catalogue) -> None:
    """Remove files of older states, and those that a killed process left."""
    kept = {head["table"], head["index"], head["fittings"], HEAD}
    for path in folder.iterdir():
        if path.name in kept or path.name == "renders":
            continue
        if path.is_dir() and path.name.startswith(("index-", ".index-")):
            shutil.rmtree(path)
        elif path.is_file() and path.name.startswith(
            ("table-", "fittings-", "table.", ".table", ".library")
        ):
            path.unlink()
    packs = set(catalogue["path"].tolist())
    for group in GROUPS:
        for path in (folder / group).glob("*.npz"):
            if path.relative_to(folder).as_posix() not in packs:
                path.unlink()


def write_table(path: Path, catalogue: Catalogue) -> None:
    """Write records as Parquet; footprints as WKB."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    arrays = {}
    for name, kind in COLUMNS.items():
        values = catalogue[name]
        if kind == "polygon":
            arrays[name] = pa.array(shapely.to_wkb(values).tolist(), pa.binary())
        elif kind == "str":
            arrays[name] = pa.array(values.tolist(), pa.string())
        else:
            arrays[name] = pa.array(values)
    pq.write_table(pa.table(arrays), path, compression="zstd")


def read_table(path: Path) -> Catalogue:
    """Read records back.

    Raises
    ------
    InputError
        If the file is no table of records.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        table = pq.read_table(path)
    except (OSError, pa.ArrowException) as error:
        raise InputError(f"{path} cannot be read: {error}.") from None
    missing = [name for name in COLUMNS if name not in table.column_names]
    if missing:
        raise InputError(f"{path} lacks the columns {', '.join(missing)}.")
    columns: dict[str, Any] = {}
    for name, kind in COLUMNS.items():
        values = table.column(name)
        if kind == "polygon":
            columns[name] = shapely.from_wkb(np.array(values.to_pylist(), object))
        elif kind == "str":
            columns[name] = values.to_pylist()
        else:
            columns[name] = values.to_numpy()
    return make_catalogue(table.num_rows, **columns)


def check_library(library: Library, *, deep: bool = True) -> list[str]:
    """Return what is wrong with a library, one sentence each.

    Parameters
    ----------
    library
        The library.
    deep
        Whether packs are read and their content is compared with its hash.
    """
    from cityx.assets.library.records import validate_document

    table = library.catalogue
    faults = validate_document(table.document())
    if len(np.unique(table["id"])) != len(table):
        faults.append("Some ids occur twice.")
    if len(set(table["content_hash"])) != len(table):
        faults.append("Some assets occur twice.")
    faults += [
        f"{name}: the source is none of {', '.join(SOURCES)}."
        for name in table["collection"][~np.isin(table["source"].astype(str), SOURCES)]
    ]
    wrong = ~shapely.is_valid(table["footprint"]) | ~(table["footprint_area"] > 0)
    faults += [f"{name}: the footprint is no area." for name in table["collection"][wrong]]
    faults += [
        f"{name}: the picture {path} is missing."
        for name, path in zip(table["collection"], table["render"], strict=True)
        if path and not (library.folder / path).is_file()
    ]
    try:
        lengths = np.linalg.norm(np.asarray(library.index.vectors, np.float32), axis=1)
        if len(lengths) and np.abs(lengths - 1).max() > 2e-3:
            faults.append("Some vectors of the index are not of length 1.")
    except InputError as error:
        faults.append(str(error))
    if deep:
        faults += list(_pack_faults(library))
    return faults


def _pack_faults(library: Library) -> Iterable[str]:
    table = library.catalogue
    paths = table["path"]
    for path in sorted(set(paths.tolist())):
        rows = np.flatnonzero(paths == path)
        try:
            models = library.models(rows)
        except InputError as error:
            yield str(error)
            continue
        found = [id_text(number) for number in content_hashes(models).tolist()]
        for row, text in zip(rows.tolist(), found, strict=True):
            if text != table["content_hash"][row]:
                yield f"{table['collection'][row]}: the content of {path} is not what was recorded."
        if not np.isfinite(models.shells.vertices).all():
            yield f"{path} holds vertices that are not finite."
