"""Commands: the sentences of an instruction for a city that exists."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import pairwise

from cityx.checks.predicates.vocabulary import family_of
from cityx.language.brief import Edit, Note, Question, Reference, Selector, Slot, Span, Value
from cityx.language.commands.bounds import bounds_of
from cityx.language.commands.busyness import OBJECTS, amounts_of_life, tells_of_life
from cityx.language.commands.earlier import in_bounds, in_their_place, least_said, spared_side
from cityx.language.commands.edits import Unclear, edits_of, own_verb
from cityx.language.commands.gathered import Before, Commands
from cityx.language.commands.grammar import Node, parse
from cityx.language.commands.headings import is_heading, is_remark, topic_of, without_asides
from cityx.language.commands.leftovers import as_addition, is_new, is_placed, shorter
from cityx.language.commands.pronouns import LAST, about_here, resolved, with_spared
from cityx.language.commands.renaming import renaming
from cityx.language.commands.roles import TERM
from cityx.language.commands.selection import IT, targets_of
from cityx.language.commands.short_looks import disjoint
from cityx.language.commands.telling import asks_to_be_told
from cityx.language.commands.terminals import Terminal, terminals_of
from cityx.language.commands.that_place import LINED, PLACES, at_that_place, noted, says_there
from cityx.language.commands.topics import of_the_topic, subject_of
from cityx.language.commands.wishes import (
    AIR,
    FIRST,
    FRONTS,
    Clause,
    commands_of,
    open_parts,
    parts_of,
    span_of,
)
from cityx.language.conflicts import reconcile
from cityx.language.describe import describe
from cityx.language.here import Findings
from cityx.language.lexicon.idioms import changed_air, complaint, plain, remark
from cityx.language.lexicon.phrases import part_named, part_of
from cityx.language.measurable import things
from cityx.language.scan import ENDS, Item
from cityx.language.scopes import KEPT, NEGATED, READ

PARSES = 60  # attempts of the grammar for one instruction, so that time stays short
LONGEST_COMMAND = 32  # terminals; no command of a person is longer
# Slot -> the edit that sets it. What lies in one edit is said together.
ENVIRONMENT = {
    "weather": "set_weather", "rain.intensity": "set_weather", "snow.intensity": "set_weather",
    "fog.intensity": "set_weather", "wetness": "set_weather", "time": "set_time",
    "season": "set_season", "style": "set_style", "traffic": "set_traffic",
    **dict.fromkeys(
        ("visibility", "visibility.min", "visibility.max", "cloud.share", "snow.cover", "wind",
         "wind.from", "moon", "windows.lit"), "set_weather",
    ),
    **dict.fromkeys(("sun.side", "sun.height", "date"), "set_time"),
    "pedestrians": "set_pedestrians", "lights": "set_lights", "density": "set_density",
}  # fmt: skip
_WITH_WEATHER = ("set_time", "set_season")
_OF_THE_CITY = {
    "building.roof": "set_roof", "building.material": "set_material",
    "building.color": "set_color", "roof.color": "set_roof", "roads.width": "set_width",
}  # fmt: skip
_PARTS_OF_BUILDINGS = ("facade", "roof", "window")  # "with red facades" says all with its colour
_LOOKS = ("color", "material", "surface")
_BACK = ("UNDO", "UNDO_ALL")
_TIMES = {"once": 1, "twice": 2, "both": 2, "thrice": 3}


def read_edits(text: str, items: Sequence[Item]) -> Commands:
    """Read every command of an instruction; what no command takes describes the city."""
    commands = Commands(found=Findings(text))
    items, commands.found.notes = without_asides(text, items)
    told = False
    left_out = (one for one in items if one.state == KEPT or one.get(TERM) == "EXCEPT")
    last = max((item.span[0] for item in left_out), default=-1)
    sentence = 0
    cut = [words for words in commands_of(items) if words]
    for place, words in enumerate(cut):
        commands.spares = words[-1].span[1] <= last
        if is_remark(words) and len(cut) > 1:
            for item in words:
                item.state = item.state or READ
            span = span_of(words)
            said = f'"{text[slice(*span)]}" is taken as a remark; it changes nothing.'
            commands.found.notes.append(Note("remark", said, span))
            sentence += int(words[-1].is_mark(ENDS))
            continue
        if is_heading(words, cut[place + 1 :], first=not place):
            _head(commands, text, words)
            told = False
            sentence += int(words[-1].is_mark(ENDS))
            continue
        sentence += int(words[0].text == "if" and words[-1].is_mark(","))
        clauses = _read_clause(commands, text, Clause(words, sentence), items, told=told)
        commands.clauses += clauses
        told = words[-1].is_mark(":") and not any(one.edits for one in clauses)
        sentence += int(words[-1].is_mark(ENDS))
    for clause in commands.clauses:
        clause.edits = [with_spared(edit, commands.spared) for edit in clause.edits]
    if any(one == Selector(side=one.side) for one in commands.spared):
        for clause in commands.clauses:
            if any(edit.target is None and edit.verb not in AIR for edit in clause.edits):
                said = text[slice(*clause.span)]
                asked = f'Where is what "{said}" adds? A part of the city is to stay as it is.'
                clause.questions.append(Question(asked))
    for span, edits, asked in commands.open:
        if len(commands.edits) == edits:
            clause = next(one for one in commands.clauses if one.holds(span))
            clause.questions.append(_unsaid(asked, text[slice(*span)]))
            clause.edits.append(Edit("unspecified", span=span))
    _part_shares(commands.clauses)
    _fold_traits(commands.clauses)
    _tell_of_flow(commands, text)
    commands.edits = [edit for clause in commands.clauses for edit in clause.edits]
    commands.questions = [one for clause in commands.clauses for one in clause.questions]
    if commands.questions:  # where nothing is done, all that was asked for is named
        commands.questions += [
            Question(f'"{text[slice(*clause.span)]}" is understood and waits for the answer.')
            for clause in commands.clauses if clause.edits and not clause.is_left
        ]  # fmt: skip
    return commands


def _tell_of_flow(commands: Commands, text: str) -> None:
    """Note that "downstream" was taken for either way, as no city tells which way water flows."""
    word = next((one for one in ("downstream", "upstream", "downriver", "upriver")
                 if one in text.lower()), "")  # fmt: skip
    off = any(ref.key == "off" for clause in commands.clauses for edit in clause.edits
              for ref in edit.refs)  # fmt: skip
    if word and off:
        at = text.lower().index(word)
        said = f'"{word}": which way the water flows is not known; either way is taken.'
        commands.found.notes.append(Note("flow", said, (at, at + len(word))))


# Verb that sets a trait -> the same of a building that is added.
_TRAITS = {"floors": "building.floors", "height": "building.height", "roof": "building.roof",
           "color": "color", "material": "material", "style": "style",
           "roof.color": "roof.color"}  # fmt: skip
TRAIT = "trait"  # verb of what is told of a building that was added before


def _fold_traits(clauses: Sequence[Clause]) -> None:
    """Give a building that is added what is told of it behind: "make it six floors"."""
    new: tuple[Clause, int] | None = None
    for clause in clauses:
        own: list[Edit] = []
        for edit in clause.edits:
            if edit.verb == TRAIT and new is not None:
                holder, at = new
                made = holder.edits if holder is not clause else own
                made[at] = replace(made[at], change=(*made[at].change, *edit.change))
                continue
            own.append(edit)
            if edit.verb == "add_building":
                new = clause, len(own) - 1
        clause.edits = own


def _as_trait(edit: Edit, last: Sequence[Edit]) -> Edit | None:
    """Return what is told of a building that was added last as a trait of it, None for others."""
    it = edit.target is not None and edit.target.kind == IT and not edit.refs
    new = [one for one in last if one.verb == "add_building" and "count" not in dict(one.change)]
    told = [(_TRAITS.get(key, ""), value) for key, value in edit.change]
    if not it or not new or not edit.verb.startswith("set_") or not all(key for key, _ in told):
        return None
    return Edit(TRAIT, change=tuple(told), span=edit.span)


def _part_shares(clauses: Sequence[Clause]) -> None:
    """Let shares of the same things that a sentence tells not overlap: "a third red, a third blue".

    Each of them is one of what those before it leave.
    """
    for number in {clause.sentence for clause in clauses}:
        own = [(clause, at) for clause in clauses if clause.sentence == number
               for at, edit in enumerate(clause.edits)
               if edit.target is not None and edit.target.share]  # fmt: skip
        edits = [clause.edits[at] for clause, at in own]
        targets = [edit.target for edit in edits if edit.target is not None]
        whole = {replace(one, share=None) for one in targets}
        total = sum(one.share or 0.0 for one in targets)
        if (
            len(edits) < 2
            or len(whole) > 1
            or total > WHOLE
            or len({one.verb for one in edits}) > 1
        ):
            continue
        before: list[Selector] = []
        for (clause, at), share in zip(own, disjoint([one.share or 0.0 for one in targets]),
                                       strict=True):  # fmt: skip
            target = replace(targets[len(before)], share=round(share, 4), but=tuple(before))
            clause.edits[at] = replace(clause.edits[at], target=target)
            before.append(target)


WHOLE = 1.01  # of things, which shares of them that are told together do not exceed


def _head(commands: Commands, text: str, words: Sequence[Item]) -> None:
    """Take what a heading names as what follows is about; of a title its words are noted."""
    topic = topic_of(words)
    if topic:
        commands.named, commands.topic = topic, topic[0]
    if not words[-1].is_mark(":"):
        return  # of a sentence that nobody knows, the words are named
    for item in words:
        item.state = item.state or READ
    if not topic:
        span = span_of(words)
        said = f'"{text[slice(*span)]}" is taken as a heading; it changes nothing.'
        commands.found.notes.append(Note("heading", said, span))


def _read_clause(
    commands: Commands, text: str, clause: Clause, items: Sequence[Item], *, told: bool
) -> list[Clause]:
    """Read a command; where it is not understood, each of the things that it lists by itself.

    What it says more than is understood is left out alone, where that cannot change the rest.
    """
    before = Before(commands, clause.items)
    words = list(clause.items)
    parts = parts_of(words)
    _read_into(commands, text, clause, items, told=told)
    listed = not clause.is_left and len(clause.edits) > 1
    listed = listed and all(edit.verb in _ADDED for edit in clause.edits)
    if not parts or not (clause.is_left or listed):
        return _or_less(commands, text, clause, words, before, items)
    if clause.is_left:
        less = _or_less(commands, text, clause, words, before, items, by_adjectives=True)
        if not less[0].is_left:
            return less
    after = Before(commands, words)
    before.restore()
    found = []
    for part in parts:
        one = Clause(part.items, clause.sentence, of_list=True)
        begun, own = Before(commands, one.items), list(one.items)
        _read_into(commands, text, one, items, told=False)
        found.append(_or_less(commands, text, one, own, begun, items) if not listed else [one])
    first = [one[0] for one in found]
    every = [one for each in found for one in each]
    if listed:  # each can be carried out where another cannot
        made = [replace(edit, span=clause.span) for one in every for edit in one.edits]
        if made == [replace(edit, span=clause.span) for edit in clause.edits]:
            return every
        after.restore()
        return [clause]
    alone = [not one.is_left and bool(one.edits) for one in first]
    changes = [any(edit.target is not None and edit.verb != "remove" for edit in one.edits)
               for one in first]  # fmt: skip
    unsure = open_parts(parts, alone, changes)
    if not any(sure and at not in unsure for at, sure in enumerate(alone)):
        after.restore()
        return _or_less(commands, text, clause, words, before, items)
    for at, one in enumerate(first):
        added = at and alone[at] and any(changes[:at]) and not changes[at] and is_new(one.edits)
        if added and not is_placed(one):
            said = text[slice(*one.span)]
            one.questions.append(Question(f'Where is what "{said}" adds?'))
    for at in unsure:
        if alone[at]:
            said = text[slice(*first[at].span)]
            first[at].questions.append(Question(f'Is "{said}" a change of its own? Say it alone.'))
    return every


def _or_less(
    commands: Commands, text: str, clause: Clause, words: list[Item], before: Before,
    items: Sequence[Item], *, by_adjectives: bool = False,
) -> list[Clause]:  # fmt: skip
    """Return a command as it was read, or where it is not understood, without what may be left out.

    Parameters
    ----------
    words
        Its words before it was read.
    before
        What was read up to it.
    by_adjectives
        Whether only unknown adjectives of what is new may be left out.
    """
    begun = [one for one in words[:FIRST] if one.has("verb") or one.quantity is not None]
    if not clause.is_left or not begun:
        return [clause]
    after = Before(commands, words)
    for less in shorter(words, by_adjectives=by_adjectives):
        before.restore()
        head = Clause(list(less.head), clause.sentence, of_list=clause.of_list)
        _read_into(commands, text, head, items, told=False)
        if head.is_left or not less.is_safe(head.edits):
            continue
        if not any(one.has("verb") for one in begun) and not is_placed(head):
            continue  # "a dozen stalls with canopies": of what, and where
        found = [head]
        for piece in less.left:
            found.append(_left_piece(commands, text, piece, head, items))
        return found
    after.restore()
    return [clause]


def _left_piece(
    commands: Commands, text: str, piece: list[Item], head: Clause, items: Sequence[Item]
) -> Clause:
    """Read what a command says besides as an addition of its own, or name it as left out."""
    before = Before(commands, piece)
    made = as_addition(piece)
    if made:
        one = Clause(made, head.sentence, of_list=True)
        _read_into(commands, text, one, items, told=False)
        if not one.is_left and is_placed(one):
            return one
    before.restore()
    for item in piece:
        item.state = item.state or ("" if item.kind == "unknown" else READ)
    one = Clause(piece, head.sentence, of_list=True, is_extra=True)
    said = text[slice(*one.span)]
    one.questions.append(Question(f'What is meant by "{said}"? The rest is read without it.'))
    return one


def _read_into(
    commands: Commands, text: str, clause: Clause, items: Sequence[Item], *, told: bool
) -> None:
    edits, questions = len(commands.edits), len(commands.questions)
    if _conditional(commands, clause) or _is_told_anyway(commands, text, clause):
        return
    if side := spared_side(clause.items):
        commands.spared.append(Selector(side=side))
        return
    if not _renames(commands, text, clause):
        _read(commands, text, clause.items, told=told)
    bounded = in_bounds(commands.edits[edits:], clause.items)
    least = least_said(clause.items)
    if least is not None and bounded == commands.edits[edits:]:
        said = text[slice(*least.span)]
        commands.questions.append(Question(
            f'What is not to go below "{said}"? Nothing that is changed here is measured so.'
        ))  # fmt: skip
    commands.edits[edits:] = bounded
    commands.edits[edits:] = in_their_place(commands.edits[edits:], clause.items, commands.edits)
    if (part := _look_of_a_part(clause.items)) and len(commands.edits) > edits:
        words = text[slice(*clause.span)].rstrip(".!? ")
        commands.questions.append(Question(f'What is meant by "{part}" in "{words}"?'))
    clause.questions = commands.questions[questions:]
    if clause.questions and _protects_more(commands, text, clause):
        del commands.edits[edits:]
        del commands.questions[questions:]
        return
    for edit in commands.edits[edits:]:
        made = _of_a_part(edit, text, items)
        if made.verb == "unspecified" and made.change:
            clause.questions.append(Question(f'What is meant by "{made.change[0][1]}"?'))
            made = replace(made, change=())
        clause.edits.append(made)


def _renames(commands: Commands, text: str, clause: Clause) -> bool:
    """Read "rename Market Road to King Street", whose last words are a name and nothing else."""
    found = renaming(text, clause.items)
    if found is None:
        return False
    target, name = found
    command = parse(terminals_of(target, verb_first=False), target)
    of_city = command is not None and any(item.noun == "city" for item in target)
    if command is None or command.name != "topic" or of_city:
        _unread(commands, text, clause.items, clause.said)
        return True
    for item in clause.items:
        item.state = READ
    for one in targets_of(command):
        edit = Edit("rename", one, (("name", name),), clause.span)
        commands.edits += list(_resolved(commands, edit, []))
    return True


def _look_of_a_part(items: Sequence[Item]) -> str:
    """Return the part whose look would be taken for that of all: "houses with purple | doors"."""
    for link, look, part in zip(items, items[1:], items[2:], strict=False):
        owned = link.get("rel") == "with" and look.has(*_LOOKS)
        if owned and not part.state and not part.noun and part_named(part.words[-1]):
            return part.text
    return ""


def _protects_more(commands: Commands, text: str, clause: Clause) -> bool:
    """Keep all of a kind where it is not known which are meant: "keep the trees at the rim"."""
    said = [one for one in clause.said if one.get("rel") not in ("and", "but", "please")]
    led = said and (said[0].has("keep") or said[0].get(TERM) == "EXCEPT")
    nouns = [one for one in said if one.noun]
    if not led or not nouns or not clause.protects:
        return False
    if any(one.has("verb", "side") or one.quantity is not None for one in said[1:]):
        return False
    first = nouns[0]
    known = first.noun_class in ("plant", "element", "type", "building") and first.kind != "id"
    before = said[1 : said.index(first)]
    if not known or any(one.kind != "function" and one.kind != "unknown" and not one.has("size")
                        for one in before):  # fmt: skip
        return False
    kind = "tree" if first.noun_class == "plant" else first.noun
    for one in clause.items:
        one.state = one.state or READ
    words = text[slice(*clause.span)].rstrip(".!? ")
    commands.found.kept.append(Slot("keep", kind, clause.span, words))
    told = f'"{words}": every {kind.replace("_", " ")} is kept, as it is not known which are meant.'
    commands.found.notes.append(Note("kept_all", told, clause.span))
    clause.questions = []
    return True


def _is_told_anyway(commands: Commands, text: str, clause: Clause) -> bool:
    """Read "and tell me which ones", which every change tells."""
    if not (commands.edits or commands.clauses) or not asks_to_be_told(clause.said):
        return False
    for item in clause.items:
        item.state = READ
    said = f'"{text[slice(*clause.span)]}" is answered by what is told of the change.'
    commands.found.notes.append(Note("told", said, clause.span))
    return True


def _conditional(commands: Commands, clause: Clause) -> bool:
    """Read "if there is a pond", which holds for all of its sentence."""
    said = [
        item for item in clause.said if not item.state and item.get("rel") not in ("and", "but")
    ]
    if [item.text for item in said[:2]] != ["if", "there"] or said[2:3] == []:
        return False
    if said[2].get("rel") != "be" or not clause.items[-1].is_mark(","):
        return False
    named = said[3:]
    command = parse(terminals_of(named, verb_first=False), named)
    if (
        command is None
        or command.name != "topic"
        or _lost(named, []) != [item for item in named if item.noun or item.kind == "id"]
    ):
        return False
    commands.named = targets_of(command)
    clause.given = replace(commands.named[0], alone=False)
    for item in clause.items:
        item.state = READ
    return True


def _of_a_part(edit: Edit, text: str, items: Sequence[Item]) -> Edit:
    """Say which part of buildings a command is about: "paint the doors of the houses blue"."""
    part = part_of(text[slice(*edit.span)])
    if not part and (word := _unknown_part(edit, items) or _unknown_head(edit, items)):
        return replace(edit, verb="unspecified", target=None, change=(("of", word),))
    about = edit.target is not None and "part" not in dict(edit.change)
    if not part or not about or edit.verb not in ("remove", "set_color"):
        return edit
    for item in items:
        inside = edit.span[0] <= item.span[0] and item.span[1] <= edit.span[1]
        if inside and not item.state and part_named(item.text):
            item.state = READ
    return replace(edit, change=(("part", part), *edit.change))


_ADDS = ("add", "add_agent", "add_building", "plant")


def _unknown_head(edit: Edit, items: Sequence[Item]) -> str:
    """Return what is to be added, where no rule took it: "put | a crowd at the tram stop"."""
    if edit.verb not in _ADDS:
        return ""
    own = [item for item in items if edit.span[0] <= item.span[0] and item.span[1] <= edit.span[1]]
    for item, after in pairwise(own):
        if item.kind == "function" or item.state or item.has("rel", "amount", "size"):
            continue
        placed = after.get("rel") in ("on", "in", "near", "along", "around")
        other = item.kind == "unknown" or item.has("slot", "verb")
        return item.text if placed and other and not item.has("noun", *_LOOKS) else ""
    return ""


def _unknown_part(edit: Edit, items: Sequence[Item]) -> str:
    """Return the word that nobody knows for what a look is given to: "the | shutters of b03".

    Or what has a look of its own: "paint the houses red, with white | windows".
    """
    if edit.target is None or edit.verb not in ("set_color", "set_material"):
        return ""
    own = [item for item in items if edit.span[0] <= item.span[0] and item.span[1] <= edit.span[1]]
    looks = [at for at, item in enumerate(own) if item.has("color", "material")]
    for at in looks[1:]:
        of_roofs = own[at].noun == "roof" or any(one.noun == "roof" for one in own[at + 1 : at + 2])
        if not of_roofs and any(item.text == "with" for item in own[looks[0] : at]):
            return " ".join(item.text for item in own[at : at + 2])
    for item, after in pairwise(items):
        inside = edit.span[0] <= item.span[0] and item.span[1] <= edit.span[1]
        if inside and item.kind == "unknown" and not item.state and after.get("rel") == "of":
            return item.text
    return ""


def _read(commands: Commands, text: str, clause: list[Item], *, told: bool = False) -> None:
    plain(clause)
    live = [item for item in clause if not item.state and item.kind != "mark"]
    if not live:
        bound = bounds_of(clause)
        if bound is not None:
            commands.edits += [replace(bound, span=_span(clause))]
        elif any(item.quantity is not None and item.state == NEGATED for item in clause):
            _unread(commands, text, clause, [item for item in clause if item.kind != "mark"])
        _settle(commands, text, clause)
        return
    if _leaves_open(clause):
        words = text[slice(*span_of(clause))]
        commands.questions.append(Question(
            f'What does "{words}" leave out? Name it, as in: paint all buildings except b01 red.'
        ))  # fmt: skip
        commands.edits.append(Edit("unspecified", span=_span(clause)))
        for item in clause:
            item.state = READ
        return
    told_first = (item for item in live if item.kind != "function" and item.get("rel") != "please")
    verb = next((item.get("verb") for item in told_first), "")
    aside = [item for item in clause if item.state and item.kind != "mark"]
    if _tells_last(aside):  # "instead of the last change, make b07 red"
        _go_back(commands, aside)
    last = _tells_last(live)
    if verb == "REDO":
        _go_back(commands, [*live, *aside], "redo")
        return
    if verb in _BACK or (last and verb != "APPLY") or (last and live[0].text == "take"):
        _go_back(commands, [*live, *aside])
        return
    if any(item.has("vague") for item in live) or (verb == "IMPROVE" and not _named(live)):
        _ask(commands, live)
        return
    if _complained(commands, live):
        return
    changed = amounts_of_life(live)
    if changed:
        commands.edits += changed
        return
    air = changed_air(live, _span(live))
    commands.edits += air
    live = [item for item in live if not item.state]
    if air and not any(item.kind == "id" or item.has("noun", "slot", "verb") for item in live):
        return
    bound = bounds_of(clause)
    if bound is not None:
        commands.edits += [replace(bound, span=_span(clause))]
        _settle(commands, text, clause)
        for item in clause:
            item.state = READ
        return
    if told and commands.named:  # "every third house: | add a storey"
        about = of_the_topic(clause)
        edits = _parsed(commands, about) if about else None
        if edits is not None:
            commands.edits += edits
            return
    if _named(live) or _means_it(commands, live) or verb == "LIST" or _repaves(commands, live):
        edits = _parsed(commands, clause)
        if edits is not None:
            commands.edits += edits
            _settle(commands, text, clause)
            return
    if told and commands.named and live:  # "b08: flat roof, grey"
        edits = _parsed(commands, clause, about_it=True)
        if edits is not None:
            commands.edits += edits
            return
    _describe(commands, text, clause, live)


def _repaves(commands: Commands, live: Sequence[Item]) -> bool:
    """Return whether a surface is told of the street that was spoken of: "..., cobbles"."""
    laid = bool(live) and live[0].get("verb") == "ADD" and any(item.has("surface") for item in live)
    return laid and bool(commands.named) and not any(item.noun for item in live)


def _leaves_open(clause: Sequence[Item]) -> bool:
    """Return whether a clause leaves something out that it does not name."""
    at = next((at for at, item in enumerate(clause) if item.has("except")), len(clause))
    after = next((item for item in clause[at + 1 :] if item.kind != "function"), None)
    return at < len(clause) and (after is None or not (after.kind == "id" or after.noun))


def _complained(commands: Commands, items: list[Item]) -> bool:
    """Read "the street is too narrow", of which the next command says what is done about it.

    A remark that no command knows more of is left open.
    """
    wrong = complaint(items)
    told = remark(items)
    end, about = wrong or (told or subject_of(items), "")
    if not end:
        return False
    if not (wrong or told):
        said = commands.found.text[slice(*_span(items))]
        note = f'"{said}" is taken as a remark; it changes nothing.'
        commands.found.notes.append(Note("remark", note, _span(items)))
    command = parse(terminals_of(items[:end], verb_first=False), items[:end])
    if command is None or command.name != "topic":
        return False
    commands.named, commands.about = targets_of(command), about
    if commands.named[0].alone and not commands.named[0].where:
        commands.place = Reference("in", (commands.named[0],))
    asked = "By how much?" if wrong else "What is to be done about it?"
    commands.open.append((_span(items), len(commands.edits), asked))
    for item in items:
        item.state = READ
    return True


def _unsaid(asked: str, words: str, candidates: Sequence[str] = ()) -> Question:
    return Question(f'{asked} "{words}" does not say it.', tuple(candidates))


def _settle(commands: Commands, text: str, clause: Sequence[Item]) -> None:
    """Take what a command protects or denies."""
    inner = describe(text, [item for item in clause if item.state and item.state != READ])
    commands.found.kept += inner.kept
    commands.found.negated += inner.negated


def _named(items: Iterable[Item]) -> bool:
    """Return whether objects are named, rather than the city as a whole."""
    items = list(items)
    whole = any(item.noun == "everything" for item in items)
    pointed = any(item.get(TERM) in ("REST", "ONES", "NEIGHBORS") for item in items)
    speed = any(item.get("attr") == "speed" for item in items) and items[0].has("verb")
    weather = any(item.get("slot").startswith("weather=") for item in items)
    swap = sum(item.has(*_LOOKS) for item in items) > 1 and items[0].get("verb") == "REPLACE"
    quarter = any(
        item.has("side") and after.noun == "city"
        for item, after in pairwise(item for item in items if item.kind != "function")
    ) or any(item.get("slot").startswith("district=") for item in items)
    told = any(item.has(*_LOOKS) or "style=" in item.get("slot") for item in items)
    return (
        (whole and not weather)
        or pointed
        or speed
        or swap
        or _equips(items)
        or (quarter and told)
        or any(
            item.kind == "id"
            or item.has("rank")
            or (item.noun_class in OBJECTS and not item.has("slot"))
            for item in items
        )
    )


def _equips(items: Sequence[Item]) -> bool:
    """Return whether parts are put on roofs or walls: "put solar panels on half of the roofs"."""
    part = any(item.get("slot").startswith("building.feature=") for item in items)
    verb = items[0].get("verb") in ("ADD", "PLANT", "MAKE") if items else False
    return part and verb and any(item.noun in _PARTS_OF_BUILDINGS for item in items)


def _means_it(commands: Commands, items: Iterable[Item]) -> bool:
    """Return whether "it" is what was named before, rather than the city."""
    whole = any(item.get("slot").partition("=")[0] in ENVIRONMENT for item in items)
    built = any(edit.verb in ("add_building", TRAIT) for edit in commands.edits[-1:])
    return (
        bool(commands.named or built)
        and not whole
        and any(item.get("rel") == "it" or item.text in ("its", "their") for item in items)
    )


def _span(items: Sequence[Item]) -> Span:
    return min(item.span[0] for item in items), max(item.span[1] for item in items)


def _tells_last(items: Iterable[Item]) -> bool:
    return {item.get("rel") for item in items} >= {"last", "change"}


def _go_back(commands: Commands, items: Sequence[Item], verb: str = "undo") -> None:
    """Read how many changes are undone or redone; ask where something else is said of them."""
    said = next((item.quantity.low for item in items if item.quantity is not None), None)
    count = said or next((_TIMES[word] for item in items for word in (item.text, item.get("rel"))
                          if word in _TIMES), 1)  # fmt: skip
    every = any(item.noun == "everything" or item.get("verb") == "UNDO_ALL"
                or (item.get("rel") == "all" and item.text not in _TIMES)
                for item in items)  # fmt: skip
    span = _span(items)
    commands.edits.append(Edit(verb, change=((verb, "all" if every else int(count)),), span=span))
    for item in items:
        item.state = READ
    if other := [item for item in items if _is_else(item)]:
        words = " ".join(item.text for item in other)
        commands.questions.append(Question(
            f'How many changes are to be {verb.removesuffix("o")}one? "{words}" does not tell, as '
            f'in: {verb} the last two changes.'
        ))  # fmt: skip


def _is_else(item: Item) -> bool:
    """Return whether a word of going back tells neither that nor how far."""
    if item.kind == "unknown" or item.kind == "id":
        return True
    return item.has("noun", "slot", *_LOOKS) and not item.has("verb") and item.noun != "everything"


def _ask(commands: Commands, items: Sequence[Item]) -> None:
    for item in items:
        item.state = READ
    span = _span(items)
    commands.edits.append(Edit("unspecified", span=span))
    commands.questions.append(
        _unsaid("What should change?", commands.found.text[slice(*span)], _CHOICES)
    )


_CHOICES = ("the weather or the time", "the style of the buildings", "more trees", "the traffic")


def _resolved(commands: Commands, edit: Edit, before: Sequence[Edit]) -> Iterator[Edit]:
    """Put what was named last for "it"; ask where nothing was.

    The edits `before` are those that the same command asks for.
    """
    changed = [one.target for one in (*commands.edits, *before) if one.target is not None]
    earlier = None if commands.spares else [*changed, *commands.spared]
    last = [one for one in (*commands.edits, *before) if one.verb != TRAIT][-1:]
    new = next((one for one in last if one.verb == "add" and "element" in dict(one.change)), None)
    if new is None and edit.verb == "add":
        new = next((one for one in last if one.verb == "add_building"), None)
    if edit.verb == "list" and edit.target is not None and edit.target.kind == IT and new:
        kind = str(dict(new.change)["element"])
        edit = replace(edit, target=replace(edit.target, kind=kind, alone=False))
    if (trait := _as_trait(edit, last)) is not None:
        yield trait
        return
    found = resolved(edit, commands.named, earlier, new)
    if not found:
        commands.questions.append(Question("Which object is meant? Name its kind or its id."))
        yield Edit("unspecified", span=edit.span)
        return
    for one in found:
        verb = one.verb
        if edit.target is not None and edit.target.kind == IT and one.target is not None:
            verb = own_verb(verb.replace("height", commands.about or "height"), one.target)
        elif one.target is not None:
            commands.named = [one.target]
        yield replace(one, verb=verb)


def _unread(commands: Commands, text: str, clause: list[Item], live: list[Item]) -> None:
    """Ask about a command that names objects and that the grammar does not take as a whole."""
    words = text[slice(*span_of(live))]
    asked = Question(f'What should "{words}" change, and how?')
    strange = [item for item in live if item.kind == "unknown"]
    if strange and Clause(clause, 0).protects:
        asked = _unknown(text, clause, strange)
    commands.questions.append(asked)
    commands.edits.append(Edit("unspecified", span=_span(live)))
    for item in live:
        item.state = READ


def _describe(commands: Commands, text: str, clause: list[Item], live: list[Item]) -> None:
    """Read a command that names no object: weather, time, style; or one nobody understands."""
    if (_named(live) and not tells_of_life(live)) or _denies_nearness(clause):
        _unread(commands, text, clause, live)
        _settle(commands, text, clause)
        return
    if _passes_over_it(commands, live):
        strange = [item for item in live if item.kind == "unknown"]
        _unread(commands, text, clause, live)
        for item in strange:
            item.state = ""
        return
    begins = next((item for item in live if item.kind != "function"), live[0])
    stops = live[0].get("verb") == "REMOVE"
    gone = stops or next((item.get("verb") for item in live if item.get("verb")), "") == "REMOVE"
    if live[0].has("verb"):
        live[0].state = READ  # "plant" is no factory here
    spared = describe(text, [item for item in clause if item.state == KEPT]).kept
    for slot in spared:
        for item in clause:
            item.state = KEPT if item.span == slot.span else item.state
    inner = describe(text, clause)
    inner.slots = reconcile(inner.slots)
    if stops:  # "stop the rain"
        inner.slots = [
            replace(slot, value="clear") if slot.key == "weather" else slot for slot in inner.slots
        ]
    found = commands.found
    found.kept += inner.kept
    found.negated += inner.negated
    found.notes += inner.notes
    grouped: dict[str, list[tuple[str, Value]]] = {}
    for slot in inner.slots:
        verb = ENVIRONMENT.get(slot.key) or _OF_THE_CITY.get(slot.key, "")
        if slot.key in _BOUNDS:
            commands.edits.append(_bounded(slot, _span(live)))
            found.kept += spared
            found.notes[:] = [note for note in found.notes if note.code != "left_open"]
        elif verb:
            grouped.setdefault(verb, []).append((slot.key, slot.value))
        else:
            found.slots.append(slot)
    if "set_weather" in grouped:
        for verb in _WITH_WEATHER:
            grouped["set_weather"] += grouped.pop(verb, [])
    commands.edits += [
        Edit(verb, change=tuple(change), span=_span(live)) for verb, change in grouped.items()
    ]
    unread_command = _named(live) and live[0].has("verb") and not grouped
    bounded = any(slot.key in _BOUNDS for slot in inner.slots)
    denied = any(item.state == NEGATED and item.quantity is not None for item in clause)
    nothing = not (inner.slots or inner.kept or inner.negated) or unread_command
    nothing |= not (grouped or bounded) and (denied or (bool(inner.slots) and not inner.kept))
    if (gone and {"set_color", "set_material", "set_style", "set_roof"} & {*grouped}) or (
        begins.kind == "unknown" and {*grouped} & {"set_traffic", "set_pedestrians"}
    ):  # "remove that grey block", "ban cars from it": nothing is to look so, or to drive
        words = text[slice(*span_of(live))]
        commands.questions.append(Question(f'What should "{words}" change, and how?'))
    left_out = [i for i in clause if i.has("except") or i.get(TERM) == "EXCEPT"]
    if left_out and {"set_color", "set_material", "set_style", "set_roof"} & {*grouped}:
        commands.questions.append(_unknown(text, clause, left_out))  # a part of the city stays
    sides = [i for i in live if not i.state and (i.kind == "id" or i.has("side"))]
    if sides and grouped:  # what is said of a part of the city is not for all of it
        commands.questions.append(_unknown(text, clause, sides))
    if nothing and live[0].get("verb") != "APPLY" and any(i.kind != "function" for i in live):
        words = text[slice(*span_of(live))]
        commands.questions.append(Question(f'What should "{words}" change, and how?'))


def _passes_over_it(commands: Commands, live: Sequence[Item]) -> bool:
    """Return whether what is told of "it" would be taken as told of the whole city."""
    it = any(item.get("rel") == "it" or item.text in ("its", "their") for item in live)
    looks = any(item.has(*_LOOKS) or "roof=" in item.get("slot") for item in live)
    strange = any(item.kind == "unknown" for item in live)
    return it and ((strange and bool(commands.named)) or (looks and not commands.named))


def _denies_nearness(clause: Sequence[Item]) -> bool:
    """Return whether nothing is to be near something: "no house within 30 m" is no height."""
    near = any(item.quantity is not None and item.words[0] == "within" for item in clause)
    return near and any(item.state == NEGATED for item in clause)


_BOUNDS = ("building.height.max", "building.height.min", "building.floors.max",
           "building.floors.min")  # fmt: skip


def _bounded(slot: Slot, span: Span) -> Edit:
    """Read "nothing may be higher than 9 m" as "lower all buildings above 9 m to 9 m"."""
    key = slot.key.removeprefix("building.")
    name, _, end = key.partition(".")
    beyond = f"{name}{'>' if end == 'max' else '<'}{slot.value}"
    return Edit(f"set_{name}", Selector("building", filters=(beyond,)), ((key, slot.value),), span)


def _parsed(commands: Commands, clause: list[Item], *, about_it: bool = False) -> list[Edit] | None:
    """Parse a command; where it does not fit, leave out one word after the other.

    A command about what was named before a colon says only what becomes of it.
    """
    for verb_first in (True, False):
        terminals = terminals_of(clause, verb_first=verb_first)
        if about_it:
            looks = [terminal for terminal in terminals if terminal[0] != "AND"]
            terminals = [("MAKE", -1), ("IT", -1), *looks] if looks else []
        if not terminals or len(terminals) > LONGEST_COMMAND:
            continue
        counted = terminals[0][0] in ("AMOUNT", "COUNT")
        counted = counted and all(name != "RANK" for name, _ in terminals[:3])
        names = [name for name, _ in terminals]
        counted |= names[:2] == ["SPEED", "ON"] and "AGENT" not in names  # "20 mph on x1"
        if (counted and all(name != "BE" for name, _ in terminals)) or _is_new(clause, terminals):
            terminals.insert(0, ("ADD", -1))
        for attempt in _attempts(terminals):
            if commands.parses >= PARSES:
                return None
            commands.parses += 1
            command = parse(attempt, clause)
            if command is not None and (_adds_the(command, clause) or _is_the(command, clause)):
                words = commands.found.text[slice(*span_of(clause))].rstrip(".!? ")
                commands.questions.append(
                    Question(f'What should "{words}" change, and how?')  # it adds none
                )
                return [Edit("unspecified", span=_span(clause))]
            if command is not None and (command.name != "topic" or clause[-1].is_mark(":")):
                for _, index in attempt:
                    if index >= 0:
                        clause[index].state = READ
                for item in clause:
                    if item.noun in _PARTS_OF_BUILDINGS and not item.has("slot"):
                        item.state = item.state or READ
                edits = _made(commands, command, _span(clause))
                if command.name == "topic" and clause[0].get("rel") in FRONTS:
                    commands.topic, commands.named = commands.named[0], []  # no "it"
                lost = _lost(clause, edits)
                lost += [
                    clause[at]
                    for name, at in terminals
                    if at >= 0 and not _is_link(name, clause[at])
                    and clause[at].state != READ and clause[at] not in lost
                ]  # fmt: skip
                lost += [item for item in _sizes(command) if item not in lost]
                if any(edit.verb in ("add", "add_building") for edit in edits):
                    lost += [
                        item
                        for item in clause
                        if item.noun == "roof"
                        and not item.has("slot")
                        and not any(key == "roof.color" for edit in edits for key, _ in edit.change)
                    ]
                if command.name == "list":  # "which buildings got them" are not all
                    lost += [one for one in clause if not one.state and one not in lost
                             and one.kind not in ("function", "mark")
                             and one.get("rel") not in ("please", "and")]  # fmt: skip
                if _builds_the(command, clause, edits):
                    words = commands.found.text[slice(*span_of(clause))].rstrip(".!? ")
                    commands.questions.append(
                        Question(f'What should "{words}" change, and how?')  # it is there
                    )
                    return [Edit("unspecified", span=_span(clause))]
                if _gives_a_building(clause, edits):
                    words = commands.found.text[slice(*span_of(clause))].rstrip(".!? ")
                    commands.questions.append(Question(_OWN_HOUSE.format(words)))
                    return [Edit("unspecified", span=_span(clause))]
                if lost:
                    commands.questions.append(_unknown(commands.found.text, clause, lost))
                return (
                    at_that_place(commands, edits) if says_there(clause) else noted(commands, edits)
                )
    return None


_TAKES_AWAY = ("remove", "replace")
# Terminals that a command may pass over: they join what it says, or say it once more.
_LINKING = ("AND", "OF", "TO", "BY", "WITH", "ON", "IN", "BE", "FROM", "IT", "WHOLE")


def _is_link(name: str, item: Item) -> bool:
    """Return whether a terminal may be passed over: "look" may, "wide" may not."""
    if name == "REL":
        return item.noun == "" and not item.has("side")  # what it leads to is named by itself
    return name in _LINKING or (name == "ATTR" and not item.has("width", "height", "size"))


def _sizes(command: Node) -> Iterator[Item]:
    """Yield words for sizes of what is to be changed, which leave open which are meant."""
    for target in command.find("target"):
        for mod in target.own("mod"):
            yield from mod.leaves("SIZE")


_OWN_HOUSE = (
    'Where should what "{}" asks for stand? It is a building of its own; "replace" would take the '
    "others away, as in: put a garage beside b07."
)


def _gives_a_building(clause: Sequence[Item], edits: Sequence[Edit]) -> bool:
    """Return whether things are to be given a building, and not to become one."""
    given = any(item.text in ("give", "giving", "gives") for item in clause[:3])
    return given and any(edit.verb == "replace" for edit in edits)


def _builds_the(command: Node, clause: Sequence[Item], edits: Sequence[Edit]) -> bool:
    """Return whether a command would build what is there: "put one floor on the church"."""
    if not any(edit.verb == "add_building" for edit in edits):
        return False
    nouns = [item for thing in command.find("thing") for item in thing.leaves("KIND", "BUILDING")]
    before = [
        clause[at - 1] for at, one in enumerate(clause) if at and any(one is n for n in nouns)
    ]
    return any(one.kind == "function" and one.words[-1] in ("the", "those", "these")
               for one in before)  # fmt: skip


def _adds_the(command: Node, clause: Sequence[Item]) -> bool:
    """Return whether a command would make things that it speaks of as those there are."""
    verb = command.children[0]
    if command.name != "add" or verb.name != "MAKE" or verb.item is None:
        return False
    after = clause[clause.index(verb.item) + 1 :]
    return bool(after) and after[0].words[0] in ("the", "these", "those", "all")


def _is_the(command: Node, clause: Sequence[Item]) -> bool:
    """Return whether something would become one that there is: "look like the church"."""
    nouns = [
        noun for name in ("change", "new", "made") for node in command.find(name)
        for noun in node.leaves("KIND", "THING") if node.branch("spot") is None
    ]  # fmt: skip
    before = [clause[clause.index(noun) - 1] for noun in nouns if clause.index(noun)]
    return any(item.kind == "function" and item.words[-1] == "the" for item in before)


def _lost(clause: Sequence[Item], edits: Sequence[Edit]) -> list[Item]:
    """Return words that name what nobody read: a change that passes over them is another change.

    Parts of buildings are read by `cityx.language.references.parts`.
    """
    again = [after for item, after in pairwise(clause) if item.text == "another"]
    left = [item for item in clause if not item.state and not part_named(item.text)]
    left = [item for item in left if item.text != "one" or item not in again]
    left += [item for item in clause if item.state == NEGATED and item.has("noun", "slot", *_LOOKS)]
    gone = any(edit.verb in _TAKES_AWAY for edit in edits)
    left = [item for item in left
            if _tells_more(item) or (gone and item.noun) or _places(clause, item)]  # fmt: skip
    said = [item for item in clause if item.kind != "function"]
    lacking = (after for item, after in pairwise(said)
               if item.get("neg") and {"with", "without"}.intersection(item.words)
               if not after.state or (after.state == NEGATED and after.has("attr")))  # fmt: skip
    state = (item for before, item, after in zip(said, said[1:], said[2:], strict=False)
             if item.has("verb") and item.words[-1].endswith("ed") and not item.state
             and after.noun and before.has("rel"))  # fmt: skip
    return [*left, *(item for item in (*lacking, *state) if item not in left)]


def _places(clause: Sequence[Item], item: Item) -> bool:
    """Return whether a word makes what follows a place, which would be a thing of its own else."""
    if item.get("rel") not in ("near", "along", "around") or item.has("approx"):
        return False
    at = next(place for place, one in enumerate(clause) if one is item)
    after = next((one for one in clause[at + 1 :] if one.kind != "function"), None)
    return after is not None and (bool(after.noun) or after.kind == "id")


def _tells_more(item: Item) -> bool:
    """Return whether a word says something that a change must not pass over."""
    if item.kind in ("id", "unknown") or item.quantity is not None or item.has(TERM):
        return True
    if item.text in ("that", "those", "these", "back"):  # "along that street", "set it back"
        return True
    told = item.words[0].endswith("ing") or item.get("verb") in ("HALVE", "DOUBLE", "TRIPLE")
    if item.has("verb") and told and not item.noun:
        return True  # "a tram line ..., ending at the park", "car parking on Hay Road halved"
    return item.has(
        "side", "rank", "ordinal", "slot", "strip", "direction", "amount", "compared", *_LOOKS
    ) or (bool(item.noun) and item.noun not in (*_PARTS_OF_BUILDINGS, "city", "everything"))


def _unknown(text: str, clause: Sequence[Item], lost: Sequence[Item]) -> Question:
    words = ", ".join(f'"{text[slice(*item.span)]}"' for item in lost)
    return Question(f'What is meant by {words} in "{text[slice(*span_of(clause))]}"?')


def _is_new(clause: Sequence[Item], terminals: Sequence[Terminal]) -> bool:
    """Return whether something new is named: "a woman circles the park", "a bench by x"."""
    first = next((item for item in clause if not item.state or item.kind == "function"), None)
    names = [name for name, _ in terminals]
    at = next((at for at, name in enumerate(names) if name in ("AGENT", "THING")), len(names))
    goes = any(name in _GOES for name in names[at + 1 :])
    goes = goes and "BE" not in names  # "a car is parked on x1"
    introduced = first is not None and first.words[0] in ("a", "an", "another", "some")
    return introduced and goes and set(names[:at]) <= {"MODE", "SIZE", "SPEED"}


_GOES = ("MODE", "REL", "ON", "IN", "TO", "BY", "AWAY")


def _made(commands: Commands, command: Node, span: Span) -> list[Edit]:
    if command.name == "topic":
        commands.named = targets_of(command)
        return []
    if command.name == "keep":
        return _spared(commands, command)
    try:
        edits = [replace(edit, span=span) for edit in edits_of(command)]
        edits = [about_here(_in_topic(commands, edit), _here(commands)) for edit in edits]
        found: list[Edit] = []
        for edit in edits:
            found += [_by_latest(one, [*commands.edits, *found])
                      for one in _resolved(commands, edit, found)]  # fmt: skip
        return found
    except Unclear as error:
        words = commands.found.text[slice(*span)]
        asked = Question(str(error)) if error.args else _unsaid("By how much?", words)
        commands.questions.append(asked)
        return [Edit("unspecified", span=span)]


def _here(commands: Commands) -> Selector | None:
    """Return the place that was spoken of last, of which "the middle" is the middle."""
    if commands.topic is not None:
        return commands.topic
    if isinstance(commands.place, Reference):
        spots = commands.place.spots
        lies = commands.place.key in ("in", "on", "along")
        return spots[0] if len(spots) == 1 and lies else None
    if commands.place is None or commands.place[0] not in ("in", "on", "along"):
        return None
    word = commands.place[1]
    return Selector(word, alone=True) if things(word) else Selector(ids=(word,))


_ADDED = ("add", "add_building", "plant", "add_path")
_LAND = ("land", "water")


def _by_latest(edit: Edit, earlier: Sequence[Edit]) -> Edit:
    """Place something by what the same request adds before: "... and benches around the pond"."""
    if edit.verb not in _ADDED:
        return edit
    known = [dict(one.change) for one in earlier if one.verb in ("add", "add_building")]
    new = {str(one.get("element") or one.get("building.type")) for one in known
           if int(one.get("count", 1)) == 1}  # fmt: skip
    for key, value in edit.change:
        if key in ("near", "around") and value in new:
            kept = tuple(pair for pair in edit.change if pair != (key, value))
            return replace(edit, change=(*kept, (LAST, value)))
    return edit


def _in_topic(commands: Commands, edit: Edit) -> Edit:
    """Put what is new into what a heading is about, where no place of its own is told."""
    topic = commands.topic
    if "spacing" in dict(edit.change) and edit.verb in ("add", "plant"):
        return _along_here(commands, edit)
    if topic is None or edit.verb not in _ADDED or _placing(edit.refs):
        return edit
    placed = any(key in (*PLACES, "side", "at", "last") for key, _ in edit.change)
    if placed or (topic.kind and family_of(things(topic.kind).partition(",")[0]) not in _LAND):
        return edit
    return replace(edit, refs=(Reference("in", (topic,)), *edit.refs))


def _along_here(commands: Commands, edit: Edit) -> Edit:
    """Put a row whose place is not told along the street or the water that was spoken of."""
    here = _here(commands)
    told = any(key in (*PLACES, "side", "at", "last") for key, _ in edit.change)
    if told or _placing(edit.refs):
        return edit
    if here is None and len(commands.named) == 1:
        here = commands.named[0]
    street = here is not None and (here.kind in LINED or any(" " in one for one in here.ids))
    if not (street and here):
        return edit
    return replace(edit, refs=(Reference("along", (here,)), *edit.refs))


def _placing(refs: Sequence[Reference]) -> list[Reference]:
    """Return the references that tell where something is, and not how it is turned."""
    return [ref for ref in refs if ref.key != "facing"]


def _spared(commands: Commands, command: Node) -> list[Edit]:
    """Take what is to be left alone; of things of a kind it is left out of every change."""
    for one in targets_of(command):
        kept = resolved(Edit("keep", one), commands.named, [])
        commands.spared += [edit.target for edit in kept if edit.target is not None]
        if not kept:
            commands.questions.append(Question("Which object is to stay? Name its kind."))
    return []


def _attempts(terminals: list[Terminal]) -> Iterator[list[Terminal]]:
    yield terminals
    soft = [at for at, (name, _) in enumerate(terminals) if name in _SOFT]
    for at in reversed(soft):
        if terminals[at][0] != "AND" or not _parts(terminals, at):
            yield terminals[:at] + terminals[at + 1 :]
    for end in range(len(terminals) - 1, 1, -1):
        yield terminals[:end]


def _parts(terminals: Sequence[Terminal], at: int) -> bool:
    """Return whether an "and" is followed by another object, which it parts from the one before."""
    after = terminals[at + 1][0] if at + 1 < len(terminals) else ""
    return after in ("KIND", "THING", "BUILDING", "ROAD", "PLANT", "AGENT", "ID")


_SOFT = ("ATTR", "SIDE", "MODE", "AMOUNT", "OF", "TO", "BY", "WITH", "ON", "IN", "AND",
         "BE", "IT", "WHOLE", "ALL", "REL", "STYLE", "ORDINAL")  # fmt: skip
