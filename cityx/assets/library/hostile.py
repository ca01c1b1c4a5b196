"""Guards against hostile files: checks that a file must pass before it is parsed whole.

Files of strangers may be cut, may claim sizes they do not have, may unpack to a thousand times
their size, or may name other files of the machine. Each check reads little and says in one sentence
what is wrong.
"""

from __future__ import annotations

import json
import struct
import zipfile
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlsplit

from cityx.errors import InputError

MAX_BYTES = 256 << 20  # of a file; the largest building models of public collections have 150 MB
MAX_TEXT_BYTES = 96 << 20  # of .obj and .usda, which unpack to many times their size
MAX_TRIANGLES = 2_000_000  # a whole quarter has that many
MAX_NUMBERS = 200_000_000  # that the accessors of a glTF may ask for together
MAX_JSON = 64 << 20  # bytes
MAX_TOKENS = 32 << 20  # bytes of names in a .usdc
GLB_MAGIC, GLB_JSON = 0x46546C67, 0x4E4F534A
# Compressed geometry that the reader does not know.
UNREADABLE = ("KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_texture_basisu")
FILE_SUFFIXES = (
    ".usd", ".usda", ".usdc", ".usdz", ".abc", ".vdb", ".png", ".jpg", ".jpeg", ".exr", ".hdr",
    ".tif", ".tiff", ".tga", ".bmp", ".webp", ".mtl", ".obj", ".bin", ".mdl", ".mtlx", ".osl",
)  # fmt: skip
_SIZES = {5120: 1, 5121: 1, 5122: 2, 5123: 2, 5125: 4, 5126: 4}
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}


class Refused(InputError):
    """A file is not taken; the message is the reason alone, without its name."""


def check_size(path: Path) -> None:
    """Refuse what is no plain file, empty, or huge."""
    if not path.is_file():
        raise Refused("it is no plain file")
    size = path.stat().st_size
    if not size:
        raise Refused("it is empty")
    text = path.suffix.lower() in (".obj", ".gltf", ".usda")
    most = MAX_TEXT_BYTES if text else MAX_BYTES
    if size > most:
        raise Refused(f"it is huge: {size / 1e6:.0f} MB, at most {most / 1e6:.0f} MB are read")


def inside(reference: str, beside: Path, root: Path) -> Path:
    """Resolve a file that another file names; it must lie in the folder that was handed in.

    Parameters
    ----------
    reference
        Path or address as it is written.
    beside
        The file that names it.
    root
        The folder.

    Raises
    ------
    Refused
        If it leads out of the folder.
    """
    shown = reference if len(reference) <= 60 else reference[:57] + "..."
    parts = urlsplit(reference.replace("\\", "/"))
    if len(parts.scheme) > 1 or parts.netloc:
        raise Refused(f'it refers to "{shown}", an address outside the folder')
    plain = unquote(parts.path)
    if "\x00" in plain:
        raise Refused(f'it refers to "{shown!r}", which is no path')
    if plain.startswith(("/", "~")) or (len(plain) > 1 and plain[1] == ":"):
        raise Refused(f'it refers to "{shown}", outside the folder')
    try:
        target = (beside.parent / plain).resolve()
    except (OSError, RuntimeError) as error:
        raise Refused(f'it refers to "{shown}", which is no path') from error
    if not target.is_relative_to(root.resolve()):
        raise Refused(f'it refers to "{shown}", outside the folder')
    return target


# --- glTF -----------------------------------------------------------------------------------------


def check_gltf(path: Path, root: Path) -> dict[str, Any]:
    """Check a .glb or .gltf and return its JSON part.

    Raises
    ------
    Refused
        If it is broken, asks for too much, or refers to what is not in the folder.
    """
    document = _gltf_json(path)
    for name in document.get("extensionsRequired") or ():
        if name in UNREADABLE:
            raise Refused(f"it needs {name}, which is not read; export it without compression")
    budget = path.stat().st_size
    buffers = _records(document, "buffers")
    for entry in (*buffers, *_records(document, "images")):
        uri = entry.get("uri")
        if uri is None:
            continue
        if not isinstance(uri, str):
            raise Refused("it is broken: a uri is no text")
        if uri.startswith("data:"):
            continue
        target = inside(uri, path, root)
        if entry in buffers:
            if not target.is_file():
                raise Refused(f'it is broken: its file "{uri}" is missing')
            budget += target.stat().st_size
            if budget > MAX_BYTES:
                raise Refused(
                    f"it is huge: {budget / 1e6:.0f} MB with its buffers, at most "
                    f"{MAX_BYTES / 1e6:.0f} MB are read"
                )
    _check_accessors(document)
    return document


def _gltf_json(path: Path) -> dict[str, Any]:
    with path.open("rb") as file:
        if path.suffix.lower() == ".glb":
            head = file.read(20)
            if len(head) < 20:
                raise Refused("it is broken: it is cut in its head")
            magic, _, length, size, kind = struct.unpack("<5I", head)
            if magic != GLB_MAGIC or kind != GLB_JSON:
                raise Refused("it is broken: it is no GLB file")
            if length != path.stat().st_size:
                raise Refused(
                    f"it is broken: it says it has {length} bytes and has {path.stat().st_size}"
                )
            if size > min(MAX_JSON, length):
                raise Refused(f"it is broken: its JSON part claims {size} bytes")
            text = file.read(size)
        else:
            text = file.read()  # no longer than `check_size` allows
    try:
        document = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise Refused(f"it is broken: its JSON cannot be read ({type(error).__name__})") from None
    if not isinstance(document, dict) or not isinstance(document.get("asset"), dict):
        raise Refused("it is broken: it is no glTF document")
    return document


def _records(document: dict[str, Any], name: str) -> list[dict[str, Any]]:
    found = document.get(name, [])
    if not isinstance(found, list) or not all(isinstance(item, dict) for item in found):
        raise Refused(f"it is broken: {name} is no list of objects")
    return found


def _check_accessors(document: dict[str, Any]) -> None:
    """Refuse accessors that claim more than the buffers hold, or more than memory."""
    accessors, views = _records(document, "accessors"), _records(document, "bufferViews")
    total = 0
    for entry in accessors:
        count, view = entry.get("count", 0), entry.get("bufferView")
        kind = entry.get("componentType")
        size = _SIZES.get(kind, 0) if isinstance(kind, int) else 0
        width = _WIDTHS.get(str(entry.get("type")), 0) * size
        if not isinstance(count, int) or count < 0 or not width:
            raise Refused("it is broken: an accessor has no count or type")
        total += count * _WIDTHS[str(entry["type"])]
        if view is not None:
            if not isinstance(view, int) or not 0 <= view < len(views):
                raise Refused("it is broken: an accessor names a view that is not there")
            held = views[view].get("byteLength", 0)
            stride = views[view].get("byteStride") or width
            if count and (count - 1) * stride + width > held:
                raise Refused("it is broken: an accessor reaches beyond its view")
    if total > MAX_NUMBERS:
        raise Refused(f"it is huge: its accessors hold {total / 1e6:.0f} million numbers")
    triangles = 0
    for mesh in _records(document, "meshes"):
        for part in _records(mesh, "primitives"):
            index = part.get("indices", (part.get("attributes") or {}).get("POSITION"))
            if isinstance(index, int) and 0 <= index < len(accessors):
                triangles += accessors[index]["count"] // 3
    check_triangles(triangles)


def check_triangles(count: int) -> None:
    """Refuse meshes of too many triangles, or of none."""
    if count > MAX_TRIANGLES:
        raise Refused(
            f"it is huge: {count / 1e6:.1f} million triangles, at most "
            f"{MAX_TRIANGLES / 1e6:.0f} million are read"
        )


# --- OBJ ------------------------------------------------------------------------------------------


def check_obj(path: Path, root: Path) -> None:
    """Check an .obj and the .mtl files it names.

    Raises
    ------
    Refused
        If it has no faces, too many, or refers to what is not in the folder.
    """
    faces = vertices = 0
    with path.open("rb") as file:
        for line in file:
            if line.startswith(b"f "):
                faces += max(len(line.split()) - 3, 0)
            elif line.startswith(b"v "):
                vertices += 1
            elif line.startswith(b"mtllib"):
                for name in _names(line, b"mtllib"):
                    _check_mtl(inside(name, path, root), root)
    if not vertices or not faces:
        raise Refused("it is broken: it has no faces" if vertices else "it holds no geometry")
    check_triangles(faces)


def _names(line: bytes, word: bytes) -> Iterator[str]:
    text = line[len(word) :].decode("utf-8", "replace").strip()
    if text:
        yield text


def _check_mtl(path: Path, root: Path) -> None:
    if not path.is_file() or path.stat().st_size > MAX_JSON:
        return  # a missing one costs the colours alone
    for line in path.read_bytes().splitlines():
        words = line.split()
        if words and words[0].lower().startswith((b"map_", b"bump", b"disp", b"decal", b"refl")):
            inside(words[-1].decode("utf-8", "replace"), path, root)


# --- USD ------------------------------------------------------------------------------------------


def check_usd(path: Path, root: Path) -> None:
    """Check a .usd, .usda, .usdc or .usdz file.

    Raises
    ------
    Refused
        If it is broken, a bomb, or refers to what is not in the folder.
    """
    with path.open("rb") as file:
        magic = file.read(8)
    if magic.startswith(b"PK"):
        _check_usdz(path)
    elif magic == b"PXR-USDC":
        _check_references(usdc_tokens(path.read_bytes()), path, root)
    elif magic.startswith(b"#usda"):
        if path.stat().st_size > MAX_TEXT_BYTES:
            raise Refused(f"it is huge: {path.stat().st_size / 1e6:.0f} MB of text")
        pieces = path.read_bytes().replace(b"@@@", b"@").split(b"@")
        _check_references((p.decode("utf-8", "replace") for p in pieces[1::2]), path, root)
    else:
        raise Refused("it is broken: it is no USD file")


def _check_references(names: Iterable[str], path: Path, root: Path) -> None:
    for name in names:
        plain = name.split("[")[0].strip()
        if plain.lower().endswith(FILE_SUFFIXES) and len(plain) < 4096:
            inside(plain, path, root)


def _check_usdz(path: Path) -> None:
    """Refuse archives with compressed entries: USDZ has none, so each is a mistake or a bomb."""
    try:
        with zipfile.ZipFile(path) as archive:
            entries = archive.infolist()
    except (zipfile.BadZipFile, OSError, ValueError, NotImplementedError) as error:
        raise Refused(f"it is broken: it cannot be unpacked ({error})") from None
    if not entries:
        raise Refused("it is empty: the archive holds no files")
    for entry in entries:
        name = entry.filename
        if entry.compress_type != zipfile.ZIP_STORED or entry.file_size != entry.compress_size:
            raise Refused(f'its file "{name[:60]}" is compressed, which USDZ forbids')
        if name.startswith(("/", "\\")) or ".." in Path(name).parts or ":" in name:
            raise Refused(f'its file "{name[:60]}" would unpack outside the archive')
    if sum(entry.file_size for entry in entries) > path.stat().st_size:
        raise Refused("it is broken: its files overlap")


def usdc_tokens(data: bytes) -> list[str]:
    """Return the names in a binary USD file; every path it refers to is among them.

    Raises
    ------
    Refused
        If the file is broken.
    """
    try:
        (table,) = struct.unpack_from("<Q", data, 16)
        (sections,) = struct.unpack_from("<Q", data, table)
        if sections > 64:
            raise ValueError("it names too many sections")
        for number in range(sections):
            name, start, _ = struct.unpack_from("<16sqq", data, table + 8 + 32 * number)
            if name.rstrip(b"\x00") == b"TOKENS":
                _, size, packed = struct.unpack_from("<3Q", data, start)
                if size > MAX_TOKENS or start + 24 + packed > len(data):
                    raise ValueError("its names are cut")
                text = _unpacked(data[start + 24 : start + 24 + packed], size)
                return [word.decode("utf-8", "replace") for word in text.split(b"\x00") if word]
    except (struct.error, ValueError, IndexError) as error:
        raise Refused(f"it is broken: {error}") from None
    raise Refused("it is broken: it has no names")


def _unpacked(data: bytes, size: int) -> bytes:
    """Undo USD's packing: one LZ4 block, or several with their lengths before them."""
    chunks = data[0]
    if not chunks:
        return lz4_block(data[1:], size)
    out, at = b"", 1
    for _ in range(chunks):
        (length,) = struct.unpack_from("<i", data, at)
        out += lz4_block(data[at + 4 : at + 4 + length], size - len(out))
        at += 4 + length
    return out


def lz4_block(data: bytes, most: int) -> bytes:
    """Unpack one LZ4 block of at most `most` bytes.

    Raises
    ------
    ValueError
        If it is broken or holds more.

    References
    ----------
    LZ4 Block Format Description, github.com/lz4/lz4.
    """
    out = bytearray()
    at = 0
    while at < len(data):
        token = data[at]
        at += 1
        length = token >> 4
        if length == 15:
            length, at = _longer(data, at, length)
        out += data[at : at + length]
        at += length
        if len(out) > most:
            raise ValueError("its names are longer than it says")
        if at >= len(data):
            break
        offset = data[at] | data[at + 1] << 8
        at += 2
        if not 0 < offset <= len(out):
            raise ValueError("its names cannot be unpacked")
        length = token & 15
        if length == 15:
            length, at = _longer(data, at, length)
        length += 4
        if len(out) + length > most:
            raise ValueError("its names are longer than it says")
        begin = len(out) - offset
        piece = bytes(out[begin : begin + length])
        out += (piece * (length // len(piece) + 1))[:length]
    return bytes(out)


def _longer(data: bytes, at: int, length: int) -> tuple[int, int]:
    while True:
        byte = data[at]
        at += 1
        length += byte
        if byte != 255:
            return length, at


# --- Blender --------------------------------------------------------------------------------------


def check_blend(path: Path) -> None:
    """Refuse what does not begin like a .blend file, packed or plain."""
    with path.open("rb") as file:
        magic = file.read(7)
    if not magic.startswith((b"BLENDER", b"\x28\xb5\x2f\xfd", b"\x1f\x8b")):
        raise Refused("it is broken: it is no Blender file")
