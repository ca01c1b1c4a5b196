"""Messages between the simulator and other processes: MessagePack maps with a version.

A request names its `message` and has the fields of `REQUESTS`; a reply has "ok", and then what was
asked for, or the kind and the sentence of an error. An array is a map of its dtype, its shape and
its bytes, row by row, least byte first; `docs/simulator_bridge.md` lists all fields.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType, NoneType
from typing import Any

import msgpack
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from cityx.errors import UsageError, nearest

VERSION = 1  # of the messages; rises whenever one is read otherwise
LARGEST = 16_000_000  # bytes of a request
ARRAY = "array"  # key that tells a map of an array from others
KINDS = "biuf"  # of arrays: bool, integers and floats


# Fields of each request, and what they take; those that may be left out take None.
REQUESTS: Mapping[str, Mapping[str, tuple[type, ...]]] = MappingProxyType({
    "make": {"task": (str,), "options": (dict, NoneType), "render_mode": (str, NoneType)},
    "reset": {"env": (int,), "seed": (int, NoneType)},
    "step": {"env": (int,), "action": (list, np.ndarray)},
    "render": {"env": (int,)},
    "close": {"env": (int,)},
})  # fmt: skip
_WORDS: Mapping[type, str] = MappingProxyType({
    str: "text", dict: "a map", int: "a whole number", list: "a list of numbers",
    np.ndarray: "an array", NoneType: "nothing",
})  # fmt: skip


def packed(message: Mapping[str, Any]) -> bytes:
    """Return the bytes of a message; arrays and scalars of NumPy may be anywhere in it."""
    found: bytes = msgpack.packb({"version": VERSION, **message}, default=_plain)
    return found


def unpacked(raw: bytes) -> dict[str, Any]:
    """Return the message that bytes hold.

    Raises
    ------
    UsageError
        If they are no message of this version.
    """
    try:
        found = msgpack.unpackb(raw, object_hook=_array, strict_map_key=True)
    except (ValueError, TypeError, msgpack.UnpackException) as error:
        raise UsageError(f"The message is no MessagePack of one map: {error}.") from error
    if not isinstance(found, dict):
        raise UsageError(f"The message is {_kind_of(found)}; it takes a map of MessagePack.")
    version = found.pop("version", None)
    if version != VERSION:
        raise UsageError(
            f"The message is of version {version!r}; this is version {VERSION} of the bridge."
        )
    return found


def checked_request(message: Mapping[str, Any]) -> tuple[str, dict[str, Any]]:
    """Return the name of a request and its fields, None where one is left out.

    Raises
    ------
    UsageError
        With every fault.
    """
    name = str(message.get("message"))
    if name not in REQUESTS:
        raise UsageError(
            f"There is no message {name!r}; known are {', '.join(REQUESTS)}."
            f"{nearest(name, REQUESTS)}"
        )
    takes = REQUESTS[name]
    faults = [f'The message "{name}" has no field "{each}".{nearest(str(each), takes)}'
              for each in message if each != "message" and each not in takes]  # fmt: skip
    given = {each: message.get(each) for each in takes}
    for each, kinds in takes.items():
        # True is a whole number to Python, and to nobody else.
        if not isinstance(given[each], kinds) or isinstance(given[each], bool):
            words = " or ".join(_WORDS[kind] for kind in kinds)
            faults.append(f"{each} is {_kind_of(given[each])}; it takes {words}.")
    if faults:
        raise UsageError(" ".join(faults))
    return name, given


def _kind_of(value: Any) -> str:
    return _WORDS.get(type(value), f"{value!r}"[:60])


def _plain(value: Any) -> Any:
    """Return what MessagePack can hold of an array, or of a scalar of NumPy."""
    if isinstance(value, np.ndarray):
        # The bytes are least byte first on any machine.
        kept = np.ascontiguousarray(value, value.dtype.newbyteorder("<"))
        return {ARRAY: kept.dtype.str, "shape": list(kept.shape), "data": kept.tobytes()}
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(f"{value!r} is in no message")


def _array(held: dict[Any, Any]) -> Any:
    """Return the array that a map is, or the map."""
    if ARRAY not in held:
        return held
    dtype = np.dtype(str(held[ARRAY]))
    if dtype.kind not in KINDS:
        raise ValueError(f"an array is of {dtype.str}; it takes numbers")
    return np.frombuffer(held["data"], dtype).reshape(held["shape"]).copy()


def space_told(space: spaces.Space[Any]) -> dict[str, Any]:
    """Return a space as a message tells it: a "box" with bounds, or a "dict" of others."""
    if isinstance(space, spaces.Dict):
        return {"dict": {name: space_told(each) for name, each in space.items()}}
    assert isinstance(space, spaces.Box)
    return {"box": {"low": space.low, "high": space.high}}


def space_of(told: Mapping[str, Any]) -> spaces.Space[Any]:
    """Return the space that a message tells."""
    if "dict" in told:
        return spaces.Dict({name: space_of(each) for name, each in told["dict"].items()})
    low: NDArray[Any] = told["box"]["low"]
    return spaces.Box(low, told["box"]["high"], dtype=low.dtype.type)
