"""The protocol: how a function becomes an action that people, programs and models can call.

`protocol.gate` checks a call, `protocol.running` runs it; neither is imported here, so that
a plugin pays for what it uses.
"""

from cityx.protocol.actions import Action, action, encapsulation_of
from cityx.protocol.encapsulation import Encapsulation
from cityx.protocol.formats import Format, Port
from cityx.protocol.input_files import InputFiles
from cityx.protocol.parameters import Choice, Color, ObjectName, Points, Range, Text, Way
from cityx.protocol.preconditions import (
    Pre,
    count_at_most,
    has_ground,
    has_layer,
    has_network,
    has_relief,
)
from cityx.protocol.registry import Registry, registry
from cityx.protocol.serving import Serves

__all__ = [
    "Action",
    "Choice",
    "Color",
    "Encapsulation",
    "Format",
    "InputFiles",
    "ObjectName",
    "Points",
    "Port",
    "Pre",
    "Range",
    "Registry",
    "Serves",
    "Text",
    "Way",
    "action",
    "count_at_most",
    "encapsulation_of",
    "has_ground",
    "has_layer",
    "has_network",
    "has_relief",
    "registry",
]
