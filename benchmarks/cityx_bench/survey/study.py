"""Make a blinded study of pictures from several sources."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from PIL import Image, ImageOps, UnidentifiedImageError

from cityx.errors import InputError
from cityx.system.atomic import replaced

SUFFIXES = (".png", ".jpg", ".jpeg", ".webp", ".tif", ".tiff")
WORDS = ("Poor", "Below Average", "Average", "Good", "Excellent")  # 1 to 5, those of the paper
PAGE, PICTURES, STUDY, KEY, ANSWERS = (
    "index.html", "pictures", "study.json", "key.json", "answers",
)  # fmt: skip
PLACE = "<!-- study -->"  # of the page, where the study goes
REPEATS = 0.1  # share of the pictures that each person sees twice, which tells how sure they are
PIXELS = 50_000_000  # of a picture, at most


@dataclass(frozen=True)
class Question:
    """What each picture is asked about."""

    name: str
    text: str


QUESTIONS = (
    Question("aesthetic", "How good does this city look?"),
    Question("rationality", "How much sense does it make: streets, buildings, scale, use?"),
)


@dataclass(frozen=True)
class Study:
    """What the page shows; where a picture comes from stands in the key alone.

    Attributes
    ----------
    title
        Above the page; it must not name a source.
    items
        Names of the pictures, ascending; the page puts them into an order of each person's own.
    repeats
        How many pictures each person sees a second time.
    width, height
        Of all pictures, pixels.
    """

    title: str
    items: tuple[str, ...]
    repeats: int
    width: int
    height: int
    questions: tuple[Question, ...] = QUESTIONS
    words: tuple[str, ...] = WORDS

    @property
    def digest(self) -> str:
        """Identifies the study; answers carry it."""
        return hashlib.sha256(json.dumps(asdict(self)).encode()).hexdigest()[:16]

    def to_json(self) -> dict[str, Any]:
        """Return the record of the page."""
        return {**asdict(self), "digest": self.digest}


def make_study(
    sources: Mapping[str, Path],
    out: Path,
    *,
    title: str = "Cities",
    seed: int = 0,
    size: tuple[int, int] = (960, 540),
) -> Study:
    """Write a study into a new folder: a page, its pictures and the key.

    Pictures are cut to one shape and stored anew as PNG without metadata, under names that are
    hashes, so that neither name, size, format nor order tells where they come from.

    Parameters
    ----------
    sources
        Name of each source (a method, a version) to its folder of pictures.
    out
        Folder; it must not hold a study.
    title
        Above the page.
    seed
        Of the names of pictures.
    size
        Width and height of all pictures.

    Raises
    ------
    InputError
        Listing every folder and picture that cannot be used; nothing is written then.
    """
    faults = [] if len(sources) > 1 else ["Two sources at least are compared."]
    if (out / STUDY).exists():
        faults.append(f"{out} holds a study already; its answers would be lost.")
    pictures: dict[str, tuple[str, Path]] = {}
    for source, folder in sources.items():
        found = sorted(p for p in folder.glob("*") if p.suffix.lower() in SUFFIXES)
        if not found:
            faults.append(f"{folder} of {source} holds no picture ({', '.join(SUFFIXES)}).")
        for path in found:
            text = f"{seed}/{source}/{path.name}"
            pictures[hashlib.sha256(text.encode()).hexdigest()[:12]] = (source, path)
            faults += _faults(path)
    if faults:
        raise InputError(" ".join(faults))
    (out / PICTURES).mkdir(parents=True, exist_ok=True)
    for name, (_, path) in pictures.items():
        with Image.open(path) as image, replaced(out / PICTURES / f"{name}.png") as temporary:
            shown = ImageOps.exif_transpose(image).convert("RGB")
            ImageOps.fit(shown, size, Image.Resampling.LANCZOS).save(temporary, "PNG")
    items = tuple(sorted(pictures))
    study = Study(title, items, max(1, round(REPEATS * len(items))), *size)
    key = {name: {"source": source, "picture": path.name}
           for name, (source, path) in sorted(pictures.items())}  # fmt: skip
    _write(out / KEY, json.dumps(key, indent=1))
    _write(out / PAGE, page_of(study))
    _write(out / STUDY, json.dumps(study.to_json(), indent=1))
    return study


def _write(path: Path, text: str) -> None:
    with replaced(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def _faults(path: Path) -> list[str]:
    """Return what keeps a picture from being used."""
    try:
        with Image.open(path) as image:
            if image.width * image.height > PIXELS:
                return [f"{path} has {image.width} x {image.height} pixels; {PIXELS:,} are read."]
            image.load()
    except (UnidentifiedImageError, OSError, Image.DecompressionBombError) as error:
        return [f"{path} is no picture that can be read: {error}."]
    return []


def page_of(study: Study) -> str:
    """Return the page of a study; it works from a server and from a file."""
    page = Path(__file__).with_name("page.html").read_text(encoding="utf-8")
    data = json.dumps(study.to_json(), ensure_ascii=False).replace("<", "\\u003c")
    return page.replace(PLACE, f'<script type="application/json" id="study">{data}</script>')


def read_study(folder: Path) -> tuple[Study, dict[str, str]]:
    """Return the study of a folder, and the source of each picture.

    Raises
    ------
    InputError
        When the folder holds none, or one that was changed by hand.
    """
    try:
        record = json.loads((folder / STUDY).read_text(encoding="utf-8"))
        key = json.loads((folder / KEY).read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise InputError(
            f"{folder} holds no study: {error}. Make one: cityx bench survey make"
        ) from error
    digest = record.pop("digest", "")
    questions = tuple(Question(**one) for one in record.pop("questions"))
    items, words = (tuple(record.pop(name)) for name in ("items", "words"))
    study = Study(**record, items=items, words=words, questions=questions)
    if study.digest != digest or set(key) != set(items):
        raise InputError(f"{folder / STUDY} was changed since its page was made; make it anew.")
    return study, {name: one["source"] for name, one in key.items()}


def sources_of(words: Sequence[str]) -> dict[str, Path]:
    """Read words of the form ``NAME=FOLDER``.

    Raises
    ------
    InputError
        For words of another form, names given twice, and folders that are not there.
    """
    found: dict[str, Path] = {}
    faults = []
    for word in words:
        name, _, folder = word.partition("=")
        if not name or not folder:
            faults.append(f'"{word}" is not of the form NAME=FOLDER.')
        elif name in found:
            faults.append(f'The source "{name}" is given twice.')
        elif not Path(folder).is_dir():
            faults.append(f"{folder} of {name} is no folder.")
        else:
            found[name] = Path(folder)
    if faults:
        raise InputError(" ".join(faults))
    return found
