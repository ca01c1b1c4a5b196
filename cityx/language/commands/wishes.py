"""Wishes: what a request asks for, cut so that each can be carried out without the others.

A request is cut into clauses at the ends of sentences and before every verb that begins an order,
and a clause that is not understood at the things that it lists. Which wishes hang together is told
by their words: a pronoun needs what it stands for, a condition holds its sentence, and an unread
protection holds all that it may protect from.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise

from cityx.language.brief import Edit, Left, Question, Selector, Span, Wish
from cityx.language.commands.roles import TERM
from cityx.language.scan import ENDS, Item
from cityx.language.scopes import KEPT, NEGATED, READ

_LOOKS = ("color", "material", "surface")
_KEEPS = ("leave", "keep", "spare", "don't", "do", "save", "preserve")  # a command of its own
FRONTS = ("in", "on", "near", "along", "around", "by")
_JOINS = ("and", "but")


# Cutting.


def commands_of(items: Sequence[Item]) -> Iterator[list[Item]]:
    """Cut items into commands: at the ends of sentences, and before a verb after "and"."""
    clause: list[Item] = []
    for at, item in enumerate(items):
        if item.is_mark(ENDS + ":"):
            yield [*clause, item]
            clause = []
            continue
        if _is_joined(items, at) and _begins(items, at, clause):
            yield clause
            clause = []
        elif _adds_with(items, at, clause):
            yield clause
            clause = [replace(item, senses=(("verb", "ADD"),), words=("add",))]
            item.state = READ
            continue
        clause.append(item)
    yield clause


_CHANGES = ("MAKE", "CLOSE", "CLAD", "REPLACE", "OPEN", "WIDEN", "NARROW", "PAINT")


def _adds_with(items: Sequence[Item], at: int, clause: Sequence[Item]) -> bool:
    """Return whether more is added to a change: "close it to cars, | with bollards at both ends".

    What is said to be at a place of its own is no trait of what changes.
    """
    item, after = items[at], items[at + 1 : at + 8]
    changes = any(one.get("verb") in _CHANGES for one in clause[:FIRST])
    adds = any(one.get("verb") == "ADD" for one in clause[:FIRST])
    round_it = any(one.get("rel") in ("around", "near") and two.get("rel") == "it"
                   for one, two in pairwise(after))  # fmt: skip
    joined = at > 0 and items[at - 1].is_mark(",") and changes
    if item.text != "with" or not (joined or (adds and round_it)):
        return False
    new = next((one for one in after if one.kind != "function"), item)
    counted = new.quantity is not None and new.quantity.dimension == "count"
    begun = counted or new.noun_class in ("element", "plant")
    return begun and any(one.get("rel") in _PLACES[:5] for one in after[1:])


def _is_joined(items: Sequence[Item], at: int) -> bool:
    """Return whether a comma, "and", "but" or "then" stands before, with a "please" or without."""
    before = items[at - 1] if at else None
    if before is not None and before.get("rel") == "please" and at > 1:
        before = items[at - 2]  # "and please lower it"
    return before is not None and (before.is_mark(",") or before.get("rel") in _JOINS)


def _begins(items: Sequence[Item], at: int, clause: Sequence[Item]) -> bool:
    """Return whether a command begins at an item that is joined to what a clause holds."""
    item = items[at]
    if _tells_again(items, at) and _is_told(clause):
        return True
    if not _has_object(clause) or _continues(items, at):
        return False
    if item.text == "if" or (item.text == "no" and _bounds(items, at)):
        return True
    if item.has("verb") and not item.state and is_command(items, at):
        return not _is_place(clause)
    spares = item.get(TERM) == "EXCEPT" and item.words[0] in (*_KEEPS, "the", "those")
    return spares or (item.has("keep") and item.words[0] in _KEEPS)


def _bounds(items: Sequence[Item], at: int) -> bool:
    """Return whether a "no" begins a bound of its own: ", | no pavement narrower than 1.8 m"."""
    after = items[at + 1 : at + 4]
    noun = next((place for place, one in enumerate(after) if one.noun), len(after))
    return any(one.quantity is not None and one.quantity.exact is None
               for one in after[noun + 1 :])  # fmt: skip


def _continues(items: Sequence[Item], at: int) -> bool:
    """Return whether a participle tells more of what was said: "a tram line, | ending there"."""
    return items[at].words[0].endswith("ing") and items[at - 1].is_mark(",")


def is_command(items: Sequence[Item], at: int) -> bool:
    """Return whether a word that may be a verb is one here: "and | plant trees"."""
    if not items[at].has("noun", "material", "side"):
        return True
    behind = items[at + 1 : at + 3]
    if behind and behind[0].kind == "unknown":
        behind = behind[1:]  # "plant filigree oaks"
    plain = ("function", "quantity", "id")
    return behind[:1] != [] and (behind[0].kind in plain or behind[0].has("noun"))


def _is_told(clause: Sequence[Item]) -> bool:
    """Return whether a clause has said what becomes of an object: "b20 in blue"."""
    named = next((at for at, item in enumerate(clause) if item.kind == "id"), len(clause))
    return any(item.has(*_LOOKS) for item in clause[named + 1 :])


def _tells_again(items: Sequence[Item], at: int) -> bool:
    """Return whether an object and what becomes of it follow: ", | b21 in green"."""
    after = items[at + 1 : at + 4]
    said = next((item for item in after if item.has(*_LOOKS)), None)
    linked = any(item.get("rel") in ("in", "be", "to") for item in after)
    return items[at].kind == "id" and said is not None and linked


def _is_place(clause: Sequence[Item]) -> bool:
    """Return whether a clause is a place alone: "in the park, | add a fountain"."""
    said = [item for item in clause if item.kind not in ("function", "mark")]
    return (
        bool(said)
        and said[0].get("rel") in FRONTS
        and not any(item.has("verb") and not item.noun for item in said)
    )


def _has_object(clause: Sequence[Item]) -> bool:
    """Return whether a clause names something; "also" and "please" at its begin do not."""
    joining = (*_JOINS, "please")
    first = next((at for at, one in enumerate(clause) if one.get("rel") not in joining),
                 len(clause))  # fmt: skip
    known = ("noun", "slot", "rel", "attr")
    return any(item.kind in ("id", "unknown") or item.has(*known) for item in clause[first:])


# Lists: "a bus stop on the main street and a bandstand in the park" of one verb.

_ARTICLES = ("a", "an", "the", "some", "another", "all", "every")
_PLACES = ("in", "on", "near", "along", "around", "by", "of", "with", "from", "to")
FIRST = 4  # items that may stand up to the verb: "could you please put"


@dataclass(frozen=True)
class Part:
    """One of the things that a command lists, with the verb of all.

    Attributes
    ----------
    items
        The verb and the part.
    begin
        How many of the items are the verb.
    """

    items: list[Item]
    begin: int

    @property
    def own(self) -> list[Item]:
        """The part without the verb, marks and what joins it to the next."""
        said = [item for item in self.items[self.begin :] if item.kind != "mark"]
        while said and (said[-1].get("rel") == "and" or said[-1].text == "plus"):
            said.pop()
        return said

    @property
    def is_placed(self) -> bool:
        """Whether the part says where it is, or of what: its last words may be of all parts."""
        return any(item.get("rel") in _PLACES or item.text in _RELATIVE for item in self.own)

    @property
    def ends_in_the_dark(self) -> bool:
        """Whether nobody knows where the place ends that a part names last."""
        last = max((at for at, item in enumerate(self.own) if item.get("rel") in _PLACES),
                   default=len(self.own))  # fmt: skip
        return any(item.kind == "unknown" for item in self.own[last:])


_RELATIVE = ("that", "which", "who", "whose", "where")


def parts_of(clause: Sequence[Item]) -> list[Part]:
    """Return the things that a command lists, each as a command; [] where it lists none.

    What limits the whole list ("both", "but", "only") leaves it whole.
    """
    verb = next((at for at, item in enumerate(clause[:FIRST]) if item.has("verb")), None)
    if verb is None and _begins_with_new(clause):
        at = clause[0].span[0]
        lead = Item("phrase", (at, at), ("add",), (("verb", "ADD"),))
        clause, verb = [lead, *clause], 0
    if verb is None or any(is_limit(item) or _is_of_all(item) for item in clause):
        return []
    pair = next((at for at, item in enumerate(clause) if "between" in item.words), len(clause))
    cuts = [at for at in range(verb + 2, pair) if _begins_a_part(clause, at)]
    if not cuts:
        return []
    begin = _given(clause, verb + 1, cuts[0])
    head = list(clause[:begin])
    found = []
    for first, last in pairwise([begin, *cuts, len(clause)]):
        at = clause[first].span[0]
        named = [replace(item, span=(at, at)) for item in head] if first > begin else head
        found.append(Part([*named, *clause[first:last]], len(named)))
    return found


def _begins_with_new(clause: Sequence[Item]) -> bool:
    """Return whether a list without a verb names what is to be there: "a pond, two benches"."""
    said = [item for item in clause if item.get("rel") not in (*_JOINS, "please")]
    if not said or any(item.has("verb") or item.get("rel") == "be" for item in said):
        return False
    first = next((item for item in said if item.kind != "function"), said[0])
    counted = first.quantity is not None and first.quantity.dimension in ("count", "speed")
    several = first.noun_class in ("element", "plant") and first.words[-1].endswith("s")
    return counted or several or said[0].words[0] in ("a", "an", "some", "another")


def _given(clause: Sequence[Item], first: int, end: int) -> int:
    """Return where what is given begins: "give the church | a spire and a green roof"."""
    if clause[first - 1].text != "give":
        return first
    return next((at for at in range(first + 1, end) if clause[at].text in ("a", "an")), first)


_OF_ALL = ("both", "each", "either", "alternating", "respectively", "in turn", "together")


def _is_of_all(item: Item) -> bool:
    """Return whether a word is about all parts of a list; "at both ends" is a place of one."""
    return item.text in _OF_ALL and item.get(TERM) != "BOTH"


def _begins_a_part(clause: Sequence[Item], at: int) -> bool:
    """Return whether a noun phrase begins behind a comma or an "and"."""
    item, before = clause[at], clause[at - 1]
    if _begins_an_addition(clause, at):
        return not any(one.text in _RELATIVE for one in clause[:at])
    joined = before.is_mark(",") or before.get("rel") == "and" or before.text == "plus"
    if not joined or item.kind == "mark":
        return False
    if before.is_mark(",") and any(one.text in _ONES for one in clause[at : at + 4]):
        return False  # "the benches, the rusty ones": which of them
    if item.words[0] in _ARTICLES or item.kind == "id":
        return True
    if item.quantity is not None and item.quantity.dimension == "count":
        return True
    if clause[0].get("verb") == "ADD" and item.has("surface") and not item.noun:
        return True  # ", cobbles instead of tarmac"
    if clause[0].get("verb") in ("ADD", "PLANT") and item.noun_class in ("element", "plant"):
        return item.words[-1].endswith("s")  # ", benches around the pond"
    # "and ruin it", ", and hang bunting between them": a verb that nobody knows, or a noun
    after = clause[at + 1] if at + 1 < len(clause) else item
    points = any(one.get("rel") == "it" for one in clause[at + 1 :])
    verb = points or after.text == "the"
    return item.kind == "unknown" and (verb or any(one.is_mark(",") for one in clause[at - 2 : at]))


_ONES = ("ones",)


def _begins_an_addition(clause: Sequence[Item], at: int) -> bool:
    """Return whether more follows what is told of a thing: "make it white | with a spire"."""
    item, before, after = clause[at], clause[at - 1], clause[at + 1 : at + 2]
    told = before.has(*_LOOKS, "direction") and not before.noun
    return item.get("rel") == "with" and told and after[:1] != [] and after[0].text in ("a", "an")


def open_parts(parts: Sequence[Part], understood: Sequence[bool], told: Sequence[bool]) -> set[int]:
    """Return the places of the parts of a list that may mean something else with the others.

    Words at the end may be of all: "the lamps and the benches near the kiosk".

    Parameters
    ----------
    parts
        All parts of a command.
    understood
        Which of them are.
    told
        Which of them say themselves what becomes of what they name.
    """
    found = set()
    for at, part in enumerate(parts):
        tail = any(one.is_placed for one in parts[at + 1 :])
        more = bool(part.own) and part.own[0].get("rel") == "with"  # it tells of the part before
        # "near the kiosk and the church": is the church red, or is it near?
        dark = at > 0 and not understood[at - 1] and parts[at - 1].ends_in_the_dark
        if (tail and not (part.is_placed or told[at])) or more or dark:
            found.add(at)
    return found


# Dependence.

_CONDITIONS = (
    "if", "unless", "until", "provided", "whenever", "wherever", "otherwise", "else", "when",
    "assuming", "depending", "supposing", "case", "while", "whilst", "whereas",
)  # fmt: skip
_LIMITS = (
    "only", "but", "without", "except", "rather", "nor", "avoid", "avoiding", "never",
    "respect", "protect", "preserve", "retain", "maintain", "untouched", "intact", "stay", "stays",
    "remain", "remains", "unchanged", "alone", "just", "solely", "not", "cannot", "sparing",
    "leaving", "keeping", "excluding", "barring", "minus", "apart", "besides", "other",
)  # fmt: skip
_BACKWARD = (
    "those", "these", "this", "that", "each", "both", "ones", "one", "others", "another", "such",
    "remaining", "other", "which",
)  # fmt: skip
# Words that speak of what was said before, whatever else their clause names.
_ALWAYS_BACKWARD = (
    "it", "its", "them", "they", "their", "there", "instead", "site", "space", "same", "likewise",
    "similarly", "again", "former", "latter", "here", "ditto",
)  # fmt: skip
_OF_ALL_BEFORE = ("rest", "others", "the others", "other", "remaining", "everything else", "else")


def is_limit(item: Item) -> bool:
    """Return whether a word leaves out, denies, protects or makes a condition."""
    if item.has("neither"):
        return False  # "cobbles rather than tarmac"
    if item.state in (KEPT, NEGATED) or item.has("except", "keep", "neg", "exact", "unchanged"):
        return True
    if item.get(TERM) in ("EXCEPT", "NOT", "REST") or item.get("rel") == "but":
        return True
    return any(word in _LIMITS or word in _CONDITIONS for word in item.words)


def span_of(items: Sequence[Item]) -> Span:
    """Return where a command is, without what joins it to others."""
    said = [item for item in items if item.kind != "mark"] or list(items)
    while len(said) > 1 and said[-1].get("rel") in _JOINS:
        said.pop()
    while len(said) > 1 and said[0].get("rel") in _JOINS:
        said.pop(0)
    return min(item.span[0] for item in said), max(item.span[1] for item in said)


@dataclass
class Clause:
    """A command of a request, and what was read of it.

    Attributes
    ----------
    items
        Its words.
    sentence
        Which sentence it is of.
    edits, questions
        What changes, and what is to be asked.
    of_list
        Whether it is one of the things that a command lists.
    given
        What there must be for its sentence to be carried out: "if there is a pond".
    is_extra
        Whether it is what a command says more than is understood of it.
    """

    items: list[Item]
    sentence: int
    edits: list[Edit] = field(default_factory=list)
    questions: list[Question] = field(default_factory=list)
    of_list: bool = False
    given: Selector | None = None
    is_extra: bool = False

    @property
    def said(self) -> list[Item]:
        """Its words without marks."""
        return [item for item in self.items if item.kind != "mark"]

    @property
    def span(self) -> Span:
        """Where it is, without what joins it to others."""
        return span_of(self.items)

    def holds(self, span: Span) -> bool:
        """Return whether a place of the text lies in it."""
        return self.span[0] <= span[0] and span[1] <= self.span[1]

    @property
    def is_left(self) -> bool:
        """Whether it is not understood."""
        return bool(self.questions) or any(edit.verb == "unspecified" for edit in self.edits)

    @property
    def is_conditional(self) -> bool:
        """Whether it holds only if something does."""
        return any(word in _CONDITIONS for item in self.said for word in item.words)

    @property
    def is_limit(self) -> bool:
        """Whether it ends in what may limit all of its sentence: ", but not the red ones"."""
        return any(
            is_limit(item) and (before.kind == "mark" or item.get("rel") == "but")
            for before, item in pairwise(self.items)
        )

    @property
    def protects(self) -> bool:
        """Whether it does nothing but protect: "leave the vicarage as it is"."""
        said = [item for item in self.said if item.get("rel") not in (*_JOINS, "please")]
        kept = any(item.has("unchanged") or item.words[-1] in _STAYS for item in said)
        return bool(said) and (kept or _leads_protection(said))

    @property
    def is_of_air(self) -> bool:
        """Whether it changes nothing that stands, and adds nothing."""
        return bool(self.edits) and all(edit.verb in AIR for edit in self.edits)

    @property
    def names(self) -> bool:
        """Whether it names something that a later "it" may stand for."""
        if self.is_extra:
            return False
        return self.is_left or any(
            edit.target is not None or edit.refs or edit.change for edit in self.edits
            if edit.verb not in AIR
        )  # fmt: skip


_NEW = ("add", "add_agent", "add_building", "add_path", "add_bridge", "plant")
AIR = ("set_weather", "set_time", "set_season", "set_lights", "set_traffic", "set_pedestrians")
_STAYS = ("alone", "untouched", "unchanged", "intact", "stay", "remain", "stays", "remains")
_FORBIDS = ("don't", "do", "never", "not", "must", "cannot", "nothing", "nobody")


def _leads_protection(said: Sequence[Item]) -> bool:
    """Return whether words begin as "leave the", "without", "do not"."""
    first = said[0]
    if first.has("keep", "except") or first.get(TERM) == "EXCEPT" or first.state == KEPT:
        return True
    forbids = first.words[0] in _FORBIDS and first.has("neg")
    return forbids or (first.words[0] in _LIMITS and not first.has("verb", "noun"))


def needs_of(clauses: Sequence[Clause]) -> list[set[int]]:
    """Return for each clause the places of those without which it must not be carried out.

    A protection is needed by all that it may protect from, whether it was read or not.
    """
    needs: list[set[int]] = [set() for _ in clauses]
    for at, clause in enumerate(clauses):
        needs[at] |= _stood_for(clauses, at) | _added_before(clauses, at)
        binding = _binding(clause, first=_is_first(clauses, at))
        for place, other in enumerate(clauses):
            if binding and place != at and _binds(binding, clause, other):
                needs[place].add(at)
        for one in _stood_for(clauses, at):
            if any(edit.verb == "remove" for edit in clauses[one].edits) and _replaces(clause):
                needs[one].add(at)  # what goes makes room for what comes "instead"
    return needs


def _added_before(clauses: Sequence[Clause], at: int) -> set[int]:
    """Return the clause that adds what something new stands by: "a pond, benches round it"."""
    found = set()
    words = [value for edit in clauses[at].edits for key, value in edit.change if key == "last"]
    for word in words:
        adds = [place for place in range(at) for edit in clauses[place].edits
                if word in (dict(edit.change).get("element"),
                            dict(edit.change).get("building.type"))]  # fmt: skip
        found |= set(adds[-1:])
    return found


_REPLACING = ("instead", "replacement", "lieu", "there", "here", "site", "space", "place", "plot")


def _replaces(clause: Clause) -> bool:
    """Return whether something comes in the place of what goes, without which it would stay."""
    return any(word in _REPLACING for item in clause.said for word in item.words)


def _is_first(clauses: Sequence[Clause], at: int) -> bool:
    return at == 0 or clauses[at - 1].sentence != clauses[at].sentence


def _binding(clause: Clause, *, first: bool) -> str:
    """Return how a clause says under which limits others are to be carried out, "" if not."""
    if clause.is_conditional:
        return "condition"
    if clause.protects:
        return "protection"
    return "limit" if clause.is_limit or (first and _is_fronted(clause)) else ""


def _binds(binding: str, clause: Clause, other: Clause) -> bool:
    """Return whether a clause that says limits says those of another."""
    together = clause.sentence == other.sentence
    if binding == "condition":
        return together
    if binding == "protection":
        changes = any(edit.target is not None for edit in other.edits)
        kept = any(item.has("keep", "unchanged") for item in clause.said)
        return changes if kept else not other.is_of_air
    return together and not other.is_of_air


def _is_fronted(clause: Clause) -> bool:
    """Return whether a clause begins with what its whole sentence is about: "in the park, ..."."""
    said = [item for item in clause.said if item.get("rel") != "please"]
    return bool(said) and not clause.of_list and (
        said[0].get("rel") in (*FRONTS, "with", "for", "from") or said[0].words[0] in _LEADS
    )  # fmt: skip


_LEADS = (
    "for", "during", "after", "before", "behind", "within", "between", "outside", "inside", "among",
    "to", "because", "since", "as", "where", "opposite", "next", "beside", "throughout", "from",
)  # fmt: skip


def _stood_for(clauses: Sequence[Clause], at: int) -> set[int]:
    """Return the clauses that pronouns of a clause stand for, or what it does not say itself."""
    clause = clauses[at]
    before = [one for one in range(at) if clauses[one].names]
    if not before or clause.is_of_air:
        return set()
    if clauses[at - 1].items and clauses[at - 1].items[-1].is_mark(":"):
        return {at - 1}
    for place in range(at - 2, -1, -1):  # "make it car free: bollards at both ends, cobbles, ..."
        if clauses[place].sentence != clause.sentence:
            break
        if clauses[place].items[-1:] and clauses[place].items[-1].is_mark(":"):
            return {place}
    for item in clause.said:
        if item.text in _OF_ALL_BEFORE or item.get(TERM) == "REST":
            return set(before)
    named = False
    for item in clause.said:
        points = item.get("rel") == "it" or item.get(TERM) in ("NEIGHBORS", "AGAIN", "LIKE")
        points |= any(word in _ALWAYS_BACKWARD for word in item.words)
        other = item.get(TERM) == "ONES" or any(word in _BACKWARD for word in item.words)
        if points or (other and not named):
            if _is_repeated(item):  # "give it a spire and | a green roof"
                first = _first_of_list(clauses, at)
                before = [one for one in before if one < first]
            return set(before[-1:])
        named |= bool(item.noun) or item.kind == "id"
    untold = (
        bool(clause.edits)
        and not clause.is_left
        and all(edit.target is None and edit.verb not in (*AIR, *_NEW) for edit in clause.edits)
    )
    together = clauses[at - 1].sentence == clause.sentence
    return {before[-1]} if untold and together else set()


def _is_repeated(item: Item) -> bool:
    """Return whether an item stands in the text at the first thing of a list, as for `parts_of`."""
    return item.span[0] == item.span[1]


def _first_of_list(clauses: Sequence[Clause], at: int) -> int:
    """Return the first of the things that a command lists, whose verb the others repeat."""
    while _is_repeated(clauses[at].items[0]):
        at -= 1
    return at


def held(needs: Sequence[Iterable[int]], failed: Iterable[int]) -> set[int]:
    """Return the places of all that must not be carried out, as others must not."""
    out = set(failed)
    while more := {at for at, own in enumerate(needs) if at not in out and not out.isdisjoint(own)}:
        out |= more
    return out


def goes_with(others: Iterable[str]) -> Question:
    """Return why a wish is left out that others, which are, say more of."""
    named = ", ".join(f'"{one}"' for one in others)
    return Question(f"It goes with {named}, which is left out.")


def wishes_of(text: str, clauses: Sequence[Clause]) -> tuple[list[Wish], list[Left]]:
    """Return the wishes of a request that can be carried out, and those that are left out.

    Where nothing can be carried out, or a change is taken back, all or nothing of a request holds.
    """
    needs = needs_of(clauses)
    failed = [at for at, clause in enumerate(clauses) if clause.is_left]
    out = held(needs, failed)
    places = [at for at, clause in enumerate(clauses) if clause.edits and at not in out]
    back = any(edit.verb in _TAKEN_BACK for clause in clauses for edit in clause.edits)
    if failed and (back or not places):
        return [], []
    said = [text[slice(*clause.span)] for clause in clauses]
    wishes = []
    for at in places:
        own = tuple(places.index(one) for one in sorted(needs[at]) if one in places)
        given = tuple(one.given for one in clauses if one.sentence == clauses[at].sentence
                      and one.given is not None)  # fmt: skip
        wishes.append(Wish(said[at], clauses[at].span, tuple(clauses[at].edits), own, given))
    left = []
    for at in sorted(out):
        clause, reasons = clauses[at], (said[one] for one in sorted(needs[at] & out))
        if clause.questions or clause.edits:
            why = tuple(clause.questions) or (goes_with(reasons),)
            left.append(Left(said[at], clause.span, why))
    return wishes, left


_TAKEN_BACK = ("undo", "redo")
