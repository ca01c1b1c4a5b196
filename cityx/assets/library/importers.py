"""Import: a user's folder of models becomes assets, measured; what cannot is refused by name.

Next to a file ``house.glb`` a file ``house.json`` may say what cannot be measured: description,
style, group, use, licence, front_deg (compass), unit ("m", "cm", "mm", "ft", "in"), up ("y", "z").
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.library.encoding import Encoder
from cityx.assets.library.hostile import (
    Refused,
    check_blend,
    check_size,
    check_triangles,
    check_usd,
)
from cityx.assets.library.local_text import CONCEPTS_OF, words_of
from cityx.assets.library.measure import (
    color_words,
    front_of,
    outline_of,
    stable_outline,
    thing_sentence,
)
from cityx.assets.library.mesh_files import RawMesh, read_mesh_file
from cityx.assets.library.models import Models, models_of_prototypes
from cityx.assets.library.records import GROUPS, Catalogue, make_catalogue, rectangle_columns
from cityx.assets.library.store import Library, LibraryWriter
from cityx.assets.styles.materials import MATERIALS
from cityx.city.mesh import NO_VERTEX, one_mesh
from cityx.city.scene import Prototype
from cityx.errors import InputError, MissingDependency
from cityx.geometry.arrays import FloatArray
from cityx.system.tables import load, table

MESHES = (".glb", ".gltf", ".obj")
USD = (".usd", ".usda", ".usdc", ".usdz")
READ = (*MESHES, ".blend", *USD)
# Files that stand beside models and are no models themselves.
COMPANIONS = (
    ".mtl", ".bin", ".json", ".txt", ".md", ".png", ".jpg", ".jpeg", ".webp", ".tga", ".bmp",
    ".tif", ".tiff", ".exr", ".hdr", ".ktx2", ".blend1", ".html", ".pdf", "",
)  # fmt: skip
MAX_FILES = 20_000
MOST_METRES = 1000.0  # no building is longer
LEAST_METRES = 0.01  # a thing of a centimetre is a mistake of the unit
FLAT = 1e-3  # metres; less is no extent
FAR = 1000.0  # metres from the origin, beyond which half a millimetre would be lost
BASEMENT = 0.25  # share of the height that may lie below z = 0 and is taken for a basement
UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "ft": 0.3048, "in": 0.0254, "km": 1000.0}
# Plausible longest sides, by which the unit of a file without one is guessed.
PLAUSIBLE = {"buildings": (2.0, 400.0), "plants": (0.2, 60.0), "vehicles": (1.0, 40.0),
             "people": (0.4, 2.6), "furniture": (0.1, 30.0)}  # fmt: skip
NO_STOREY = 3.2  # metres of height per storey, where nobody says
UNKNOWN = "unknown"
LICENCE_NAMES = re.compile(r"(licen[cs]e|copying)", re.IGNORECASE)
LICENCES = load("assets/library", tuple[tuple[str, str], ...], "licences")
_GROUP_WORDS = table("assets/library", str, "groups")
_USE_WORDS = ("house", "flats", "office", "retail", "industry", "worship", "civic", "shed")
_STYLE_WORDS = table("assets/library", str, "styles")
# Words in names of materials, and the material that stands for them; the first that fits wins.
_SURFACES = load("assets/library", tuple[tuple[str, str], ...], "surfaces")

Say = Callable[[str], None]


@dataclass(frozen=True)
class Refusal:
    """A file that was not taken.

    Attributes
    ----------
    path
        Relative to the folder.
    reason
        A clause such as "it is empty".
    """

    path: str
    reason: str

    def __str__(self) -> str:
        """Return the sentence shown to people."""
        return f"{self.path} is refused: {' '.join(self.reason.split()).rstrip('.')}."


@dataclass(frozen=True)
class Imported:
    """What came of a folder.

    Attributes
    ----------
    library
        The library.
    count
        Assets added.
    refusals
        Files that were not taken.
    notes
        What was assumed, one sentence each.
    """

    library: Library
    count: int
    refusals: tuple[Refusal, ...]
    notes: tuple[str, ...]


@dataclass(frozen=True)
class Sidecar:
    """What a user says about a file; "" or NaN where nothing is said."""

    description: str = ""
    style: str = ""
    group: str = ""
    use: str = ""
    licence: str = ""
    front: float = np.nan
    unit: str = ""
    up: str = "y"


def import_folder(
    folder: Path, target: Path, encoder: Encoder, *, say: Say = lambda _: None
) -> Imported:
    """Add the models of a folder to a library, or make one of them.

    Parameters
    ----------
    folder
        The user's folder; it is read with everything below it.
    target
        The library.
    encoder
        Encoder of the descriptions.
    say
        Called with a line of progress at a time.

    Raises
    ------
    InputError
        If nothing in it can be taken; every reason is told and nothing is written.
    """
    if not folder.is_dir():
        raise InputError(f"{folder} is no folder.")
    files, refusals = find_files(folder)
    if not files and not refusals:
        raise InputError(f"{folder} holds no models; read are {', '.join(READ)}.")
    notes: list[str] = []
    taken: list[tuple[Catalogue, Models]] = []

    def take(path: Path, meshes: list[RawMesh], sidecar: Sidecar) -> None:
        name = path.relative_to(folder).as_posix()
        for mesh in meshes:
            try:
                made, assumed = to_asset(mesh, path, folder, sidecar)
            except Refused as reason:
                label = name if len(meshes) == 1 else f"{name} ({mesh.name})"
                refusals.append(Refusal(label, str(reason)))
                continue
            taken.append(made)
            notes.extend(f"{name}: {text}" for text in assumed)

    later: list[tuple[Path, Sidecar]] = []
    for path in files:
        name = path.relative_to(folder).as_posix()
        try:
            check_size(path)
            _in_folder(path, folder)
            sidecar = read_sidecar(path)
            suffix = path.suffix.lower()
            if suffix in MESHES:
                say(f"reading {name}")
                take(path, [read_mesh_file(path, folder, up=sidecar.up)], sidecar)
                continue
            check_blend(path) if suffix == ".blend" else check_usd(path, folder)
            later.append((path, sidecar))
        except Refused as reason:
            refusals.append(Refusal(name, str(reason)))
        except OSError as error:
            refusals.append(Refusal(name, f"it cannot be opened: {error.strerror}"))
    _take_blender(later, folder, take, refusals, say)
    refusals.sort(key=lambda refusal: refusal.path)
    if not taken:
        reasons = "\n".join(f"  {refusal}" for refusal in refusals)
        raise InputError(f"Nothing in {folder} can be imported:\n{reasons}")
    with LibraryWriter(target) as writer:
        if writer.old is not None:
            from cityx.assets.library.encoding import check_same

            check_same(encoder.identity, writer.old.encoder)
        count = 0
        for records, models in taken:
            added = writer.add(records, models)
            count += added
            if not added:
                name = str(records["original"][0])
                notes.append(f"{name}: the library has it already.")
        say("writing the index")
        library = writer.commit(encoder)
    return Imported(library, count, tuple(refusals), tuple(notes))


def _take_blender(
    later: list[tuple[Path, Sidecar]],
    folder: Path,
    take: Callable[[Path, list[RawMesh], Sidecar], None],
    refusals: list[Refusal],
    say: Say,
) -> None:
    if not later:
        return
    from cityx.assets.library.mesh_files import read_blender_files

    try:
        found = read_blender_files([path for path, _ in later], folder, say=say)
    except MissingDependency as error:
        found = [f"only Blender reads it. {error}".rstrip(".")] * len(later)
    for (path, sidecar), meshes in zip(later, found, strict=True):
        if isinstance(meshes, str):
            refusals.append(Refusal(path.relative_to(folder).as_posix(), meshes.rstrip(".")))
        else:
            take(path, meshes, sidecar)


def find_files(folder: Path) -> tuple[list[Path], list[Refusal]]:
    """List the models of a folder, sorted, and refuse what is of an unknown type.

    Raises
    ------
    InputError
        If there are too many files.
    """
    files, refusals = [], []
    for count, path in enumerate(sorted(folder.rglob("*"))):
        if count >= MAX_FILES:
            raise InputError(f"{folder} holds more than {MAX_FILES} files; import a part of it.")
        if path.is_dir() or any(p.startswith(".") for p in path.relative_to(folder).parts):
            continue
        suffix = path.suffix.lower()
        if suffix in READ:
            files.append(path)
        elif suffix not in COMPANIONS and not LICENCE_NAMES.search(path.stem):
            refusals.append(
                Refusal(
                    path.relative_to(folder).as_posix(),
                    f'files of type "{suffix}" are not read; read are {", ".join(READ)}',
                )
            )
    return files, refusals


def _in_folder(path: Path, folder: Path) -> None:
    if not path.resolve().is_relative_to(folder.resolve()):
        raise Refused("it is a link to a file outside the folder")


def read_sidecar(path: Path) -> Sidecar:
    """Read what a user says about a file in a .json of the same name.

    Raises
    ------
    Refused
        If it says something that cannot be.
    """
    held = next((p for p in (path.with_suffix(".json"), path.with_name(path.name + ".json"))
                 if p.is_file()), None)  # fmt: skip
    if held is None:
        return Sidecar()
    try:
        said = json.loads(held.read_text(encoding="utf-8"))
        if not isinstance(said, dict):
            raise ValueError("it is no object")
    except (OSError, ValueError, RecursionError) as error:
        raise Refused(f"its sidecar {held.name} cannot be read ({error})") from None
    words = {
        name: " ".join(str(said.get(name, "")).split())[:500]
        for name in ("description", "style", "group", "use", "licence", "unit")
    }
    words["licence"] = words["licence"] or " ".join(str(said.get("license", "")).split())[:80]
    up = str(said.get("up", "y")).lower()
    front = said.get("front_deg", np.nan)
    faults = []
    if words["group"] and words["group"] not in GROUPS:
        faults.append(f'group "{words["group"]}" is none of {", ".join(GROUPS)}')
    if words["unit"] and words["unit"] not in UNITS:
        faults.append(f'unit "{words["unit"]}" is none of {", ".join(UNITS)}')
    if up not in ("y", "z"):
        faults.append(f'up "{up}" is neither y nor z')
    if isinstance(front, bool) or not isinstance(front, int | float):
        faults.append("front_deg is no number")
    if faults:
        raise Refused(f"its sidecar {held.name} is wrong: {'; '.join(faults)}")
    return Sidecar(**words, front=float(np.radians(front) % (2 * np.pi)), up=up)


def licence_of(path: Path, root: Path) -> str:
    """Name the licence of a file by the nearest file of a licence above it, else "unknown"."""
    folder = path.parent
    while True:
        for held in sorted(folder.iterdir()):
            if LICENCE_NAMES.search(held.stem) and held.is_file() and held.suffix.lower() in (
                "", ".txt", ".md", ".rst",
            ):  # fmt: skip
                text = held.read_text(encoding="utf-8", errors="replace")[:4000]
                for words, name in LICENCES:
                    if words.lower() in text.lower():
                        return name
                first = next((line.strip() for line in text.splitlines() if line.strip()), "")
                return first[:80] or UNKNOWN
        if folder == root or root not in folder.parents:
            return UNKNOWN
        folder = folder.parent


def to_asset(
    mesh: RawMesh, path: Path, root: Path, sidecar: Sidecar
) -> tuple[tuple[Catalogue, Models], list[str]]:
    """Measure a mesh and make an asset of it.

    Returns
    -------
    asset
        One record and its geometry.
    assumed
        What was guessed, one clause each.

    Raises
    ------
    Refused
        If it has no extent, is too large, or is not made of numbers.
    """
    vertices, assumed = _in_metres(mesh, path, sidecar)
    check_triangles(len(mesh.triangles))
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    extent = high - low
    named = f"{mesh.name} {path.stem} {' '.join(path.relative_to(root).parts[:-1])}"
    group = sidecar.group or group_of(named, extent)
    if not sidecar.group:
        assumed.append(f"the group {group} is a guess")
    if low[2] < -BASEMENT * extent[2] or low[2] > 0.01:
        vertices = vertices - [0.0, 0.0, low[2]]
    if np.abs((low + high)[:2] / 2).max() > FAR:
        vertices = vertices - [*(np.round((low + high)[:2] / 2)), 0.0]
    outline = stable_outline(outline_of(vertices, mesh.triangles))
    if shapely.is_empty(outline) or shapely.area(outline) < FLAT**2:
        raise Refused("it has no dimensions: it covers no ground")
    front = sidecar.front
    if not np.isfinite(front):
        front = front_of(vertices, mesh.triangles, mesh.parts, mesh.part, outline)
    shell, material = to_shell(mesh, vertices, group)
    name = _safe_name(mesh.name, path)
    models = models_of_prototypes([Prototype(name, "asset", shell)])
    box = rectangle_columns(np.array([outline], object))
    height = float(vertices[:, 2].max())
    concepts = {c for word in words_of(named + " " + sidecar.description)
                for c in CONCEPTS_OF.get(word, ())}  # fmt: skip
    use = sidecar.use or (
        next((word for word in _USE_WORDS if word in concepts), "")
        if group == "buildings" else _safe_name(mesh.name, path)
    )  # fmt: skip
    style = sidecar.style or next((s for w, s in _STYLE_WORDS.items() if w in concepts), "")
    levels = max(1, round(height / NO_STOREY)) if group == "buildings" else 0
    words = sidecar.description or " ".join(dict.fromkeys(words_of(named)))
    if not sidecar.description:
        words = f"{words or group}, {color_words(_mean_color(mesh))[0]}, {material}"
    record = make_catalogue(
        1, group=group, collection=name, style=style, footprint=np.array([outline], object),
        front=front, height=height, levels=levels,
        storey_height=height / levels if levels else np.nan, use=use,
        licence=sidecar.licence or licence_of(path, root),
        description=thing_sentence(words, (box["length"][0], box["width"][0], height)),
        source="imported", generator=path.suffix.lower()[1:],
        original=path.relative_to(root).as_posix(), **box,
    )  # fmt: skip
    return (record, models), assumed


def _in_metres(mesh: RawMesh, path: Path, sidecar: Sidecar) -> tuple[FloatArray, list[str]]:
    """Return vertices in metres, (n, 3), and what was assumed about the unit."""
    used = np.unique(mesh.triangles)
    vertices = np.asarray(mesh.vertices, float)
    if not np.isfinite(vertices[used]).all():
        raise Refused("it has no dimensions: some coordinates are not finite")
    vertices = np.where(np.isfinite(vertices), vertices, vertices[used[0]])
    spread = np.ptp(vertices[used], axis=0)
    longest = float(spread.max())
    if not longest > 0:
        raise Refused("it has no dimensions: all its points lie in one place")
    assumed = []
    factor = UNITS[sidecar.unit] if sidecar.unit else 1.0
    if not sidecar.unit and not mesh.metric:
        group = sidecar.group or group_of(f"{mesh.name} {path.stem}", None)
        low, high = PLAUSIBLE.get(group, (0.1, 400.0))
        fitting = [u for u in ("m", "cm", "mm", "in", "ft") if low <= longest * UNITS[u] <= high]
        unit = "m" if "m" in fitting or not fitting else fitting[0]
        factor = UNITS[unit]
        if unit != "m":
            assumed.append(f"the unit {unit} is a guess: in metres it would be {longest:.4g} long")
    size = spread * factor
    if size.max() > MOST_METRES:
        raise Refused(f"it is huge: {size.max():.4g} m long, at most {MOST_METRES:g} m are taken")
    if size.max() < LEAST_METRES:
        raise Refused(f"it is tiny: {size.max():.2g} m; a sidecar may say its unit")
    if size.min() < FLAT:
        axis = "xyz"[int(size.argmin())]
        raise Refused(f"it has no dimensions: it is flat along {axis}")
    out = vertices * factor
    # Points that no face uses must not count in its measures.
    loose = np.ones(len(out), bool)
    loose[used] = False
    out[loose] = out[used[0]]
    return out, assumed


def group_of(text: str, extent: FloatArray | None) -> str:
    """Guess the group of an asset by the words in its names, else by its size."""
    found = {
        concept
        for word in words_of(re.sub(r"(?<=[a-z])(?=[A-Z])", " ", text))
        for concept in CONCEPTS_OF.get(word, CONCEPTS_OF.get(word.rstrip("s"), ()))
    }
    scores = {group: len(found & set(words.split())) for group, words in _GROUP_WORDS.items()}
    best = max(scores, key=lambda group: scores[group])
    if scores[best]:
        return best
    if extent is None:
        return ""
    return "buildings" if extent[2] > 2.2 and extent[0] * extent[1] > 9.0 else "furniture"


def _safe_name(name: str, path: Path) -> str:
    plain = re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_").lower()
    return (plain or re.sub(r"[^A-Za-z0-9]+", "_", path.stem).strip("_").lower() or "asset")[:60]


def _mean_color(mesh: RawMesh) -> FloatArray:
    corner = mesh.vertices[mesh.triangles]
    area = np.linalg.norm(
        np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]), axis=1
    )
    weight = np.bincount(mesh.part, weights=np.nan_to_num(area), minlength=len(mesh.parts))
    total = weight.sum()
    if not total > 0:
        return np.asarray(mesh.colors.mean(axis=0))
    return np.asarray((mesh.colors * weight[:, None]).sum(axis=0) / total)


def to_shell(mesh: RawMesh, vertices: FloatArray, group: str) -> tuple[Any, str]:
    """Make a mesh of the city of a raw one: materials by name, colours as tints, UV in metres.

    Returns
    -------
    shell
        One object.
    material
        Name of the material most triangles have.
    """
    default = "plaster" if group == "buildings" else "plastic"
    names = [_material_of(text, default) for text in mesh.parts]
    materials = tuple(dict.fromkeys(names))
    number = np.array([materials.index(name) for name in names])[mesh.part]
    base = np.array([MATERIALS[name].color for name in names])
    takes = np.array([MATERIALS[name].takes_tint for name in names])
    tint = np.where(takes[:, None], np.clip(mesh.colors / np.maximum(base, 0.02), 0.0, 4.0), 1.0)
    faces = np.column_stack([mesh.triangles, np.full(len(mesh.triangles), NO_VERTEX)])
    shell = one_mesh(
        0, vertices, faces.astype(np.int32), material=number, materials=materials,
        uv=_box_uv(vertices, mesh.triangles), tint=tint[mesh.part],
    )  # fmt: skip
    most = materials[int(np.bincount(number).argmax())]
    return shell, most.replace("_", " ")


def _material_of(text: str, default: str) -> str:
    words = set(re.findall(r"[a-z]+", re.sub(r"(?<=[a-z])(?=[A-Z])", " ", text).lower()))
    words |= {word.rstrip("s") for word in words}
    return next((name for known, name in _SURFACES if words & set(known.split())), default)


def _box_uv(vertices: FloatArray, triangles: NDArray[np.int64]) -> NDArray[np.float32]:
    """Texture coordinates in metres: along and up on walls, x and y on level faces; (t, 4, 2)."""
    corner = vertices[triangles]  # (t, 3, 3)
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    length = np.linalg.norm(normal, axis=1)
    level = np.abs(normal[:, 2]) > 0.7 * length
    flat = np.hypot(normal[:, 0], normal[:, 1])
    way = np.column_stack([-normal[:, 1], normal[:, 0]]) / np.maximum(flat, 1e-12)[:, None]
    along = (corner[..., :2] * way[:, None, :]).sum(axis=2)
    wall = np.stack([along, corner[..., 2]], axis=2)
    uv = np.zeros((len(triangles), 4, 2), np.float32)
    uv[:, :3] = np.where(level[:, None, None], corner[..., :2], wall)
    return uv
