"""Telling: clauses that ask what an edit did, where there was no room, which were chosen.

A change tells all of that by itself (`cityx.projects.outcome`), so such a clause changes nothing.
"""

from __future__ import annotations

from collections.abc import Sequence

from cityx.language.scan import Item
from cityx.system.tables import load

_LEADS = ("tell", "say", "report", "list", "show", "name", "note", "mention", "let", "give",
          "which", "where", "how")  # fmt: skip
_ASKED = ("which", "where", "how many", "many", "names", "ids", "list", "ones", "what", "those",
          "places", "streets", "buildings", "houses", "count", "number", "them")  # fmt: skip
# Words of a clause that asks for no more than what was done, chosen, or could not be.
_WORDS = load("language/telling", frozenset[str], "words")
_DONE = ("changed", "removed", "added", "moved", "picked", "chose", "chosen", "took", "taken",
         "went", "affected", "touched", "repainted", "painted", "raised", "lowered", "replaced",
         "left", "did", "got", "gets", "get", "ones", "room", "space", "possible", "fit", "fits",
         "those", "they", "them", "work")  # fmt: skip


def asks_to_be_told(clause: Sequence[Item]) -> bool:
    """Return whether a clause asks only what the request itself did or could not do.

    "Tell me which ones", "if somewhere there isn't the room, tell me where", "say how many you
    removed"; but not "tell me which buildings get wet", of which another word says more.
    """
    if any(item.get("verb") == "LIST" for item in clause):
        return False  # it names what is to be listed
    said = [word for item in clause if item.kind != "mark" for word in item.text.split()]
    if not said or not set(said) <= _WORDS:
        return False
    told = any(word in _LEADS for word in said)
    asked = any(word in _ASKED for word in said)
    alone = len([word for word in said if word not in ("and", "then", "please", "also")]) <= 4
    return told and asked and (alone or any(word in _DONE for word in said))
