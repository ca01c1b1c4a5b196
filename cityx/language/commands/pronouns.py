"""Pronouns: what "it", "those", "the rest" and "the others" stand for in a command."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from cityx.checks.predicates.vocabulary import family_of
from cityx.language.brief import Edit, Reference, Selector
from cityx.language.commands.selection import HERE, IT, NEIGHBORS, ONES, REST, like
from cityx.language.measurable import things

_PLACES = ("near", "in", "on", "along", "around", "of", "path")


def resolved(
    edit: Edit, named: Sequence[Selector], earlier: Sequence[Selector] | None,
    new: Edit | None = None,
) -> list[Edit]:  # fmt: skip
    """Return an edit with objects for its pronouns, one for each that "it" stands for.

    Parameters
    ----------
    edit
        The edit as it was parsed.
    named
        What was named last.
    earlier
        Everything that was changed before, of which "the rest" is the rest; None where what is left
        alone is told later, and "the rest" is all else.
    new
        What was added just before, which "it" is in the place of something new.

    Returns
    -------
    edits
        None where a pronoun stands for nothing.
    """
    target = edit.target
    if new is not None and target is None and edit.verb == "add" and _speaks_of_it(edit):
        return [_by_new(edit, new)]
    found: list[Selector | None] = [None]
    if target is not None:
        if target.kind == IT and edit.verb in _OF_STREETS:
            named = [_street_of(one) for one in named]
        found = [*_meant(target, named, earlier)]
    made = []
    for one in found:
        nearer = _spot_of(one)
        own = [one] if one is not None else []
        refs = [_reference(ref, nearer, own or named if _of_itself(ref) else named)
                for ref in (*edit.refs, *_places(edit))]  # fmt: skip
        if any(ref is None for ref in refs):
            return []
        change = tuple(pair for pair in edit.change if pair[1] != IT or pair[0] not in _PLACES)
        known = tuple(ref for ref in refs if ref is not None)
        made.append(replace(edit, target=one, refs=known, change=change))
    return made


_OF_STREETS = ("set_cycling", "set_parking", "set_surface", "set_speed")


def _street_of(one: Selector) -> Selector:
    """Return the street that "it" is where a street can be meant alone: that of "its" cars."""
    word = one.along or one.inside
    if not word or family_of(things(one.kind).partition(",")[0]) == "road":
        return one
    return Selector(word, alone=True) if things(word) else Selector(ids=(word,))


def about_here(edit: Edit, here: Selector | None) -> Edit:
    """Return an edit in which corners and ends are those of what was spoken of last.

    Corners of buildings are where streets meet, and those of nothing are those of the site. A
    middle or an end that is of nothing known stands for nothing: "it".
    """
    houses = edit.target is not None and _are_houses(edit.target)
    target = _part_of_here(edit.target, here, houses) if edit.target is not None else None
    refs = tuple(_of_here(ref, here, houses=False) for ref in edit.refs)
    return replace(edit, target=target, refs=refs)


def _are_houses(target: Selector) -> bool:
    return family_of(things(target.kind or "building").partition(",")[0]) == "building"


def _part_of_here(target: Selector, here: Selector | None, houses: bool) -> Selector:
    where = tuple(_of_here(ref, here, houses=houses) for ref in target.where)
    but = tuple(_part_of_here(one, here, houses) for one in target.but)
    return replace(target, where=where, but=but)


def _of_here(ref: Reference, here: Selector | None, *, houses: bool) -> Reference:
    spots = tuple(_part_of_here(spot, here, _are_houses(spot)) for spot in ref.spots)
    if [spot.kind for spot in spots] != [HERE]:
        return replace(ref, spots=spots)
    if houses and ref.key == "corner" and not ref.side:
        return replace(ref, spots=())
    if here is not None:
        return replace(ref, spots=(here,))
    if ref.key == "edge" or ref.side:
        return replace(ref, spots=())
    return replace(ref, spots=(Selector(IT, alone=True),))


def _speaks_of_it(edit: Edit) -> bool:
    """Return whether something new is placed by a pronoun and nothing else."""
    refs = [*edit.refs, *_places(edit)]
    near = len(refs) == 1 and refs[0].key in ("near", "around") and not refs[0].amount
    return near and all(spot.kind == IT for spot in refs[0].spots)


LAST = "last"  # key of a change: what was added last, by which something new stands


def _by_new(edit: Edit, new: Edit) -> Edit:
    """Place something by what was added before it: "a statue, with four benches around it".

    Of several that were added, "it" is what these were placed by.
    """
    said = dict(new.change)
    kept = tuple(pair for pair in edit.change if pair[1] != IT or pair[0] not in _PLACES)
    if int(said.get("count", 1)) == 1:
        return replace(
            edit, change=(*kept, (LAST, said.get("element") or said["building.type"])), refs=()
        )
    places = tuple(pair for pair in new.change if pair[0] in _PLACES)
    return replace(edit, change=(*kept, *places), refs=new.refs)


def _of_itself(ref: Reference) -> bool:
    """Return whether a reference is to what stands beside each target: "its neighbours"."""
    return any(spot.kind == NEIGHBORS for spot in ref.spots)


def with_spared(edit: Edit, spared: Sequence[Selector]) -> Edit:
    """Leave out of an edit what is to be left alone."""
    if not spared or edit.verb in ("undo", "redo", "unspecified"):
        return edit
    if edit.target is None:
        looks = edit.verb in ("set_material", "set_color", "set_style", "set_roof")
        return replace(edit, target=Selector("building", but=tuple(spared))) if looks else edit
    kind = edit.target.kind or "building"
    spared = [one if one != Selector(side=one.side) else replace(one, kind=kind) for one in spared]
    but = (*edit.target.but, *(one for one in spared if one not in edit.target.but))
    return replace(edit, target=replace(edit.target, but=but))


def _meant(
    target: Selector, named: Sequence[Selector], earlier: Sequence[Selector] | None
) -> list[Selector]:  # fmt: skip
    """Return what a target stands for."""
    if target.of == IT:
        nearer = _spot_of(named[-1]) if named else None
        spot = nearer or (named[-1] if named else None)
        word = (*spot.ids, spot.kind)[0] if spot is not None else ""
        if not word or spot is None or spot.filters or spot.where:
            return []
        target = replace(target, of=word)
    others = any(ref.key == REST for ref in target.where)
    if others and target.share is not None:
        target = replace(target, share=None)  # "the other half" is all of the rest
    where = tuple(ref for ref in target.where if ref.key != REST)
    held = [_reference(ref, None, named) for ref in where]
    if any(ref is None for ref in held):
        return []
    target = replace(target, where=tuple(ref for ref in held if ref is not None))
    but = [each for one in target.but for each in _meant(one, named or [target], ())]
    target = replace(target, but=tuple(but))
    if target.kind == NEIGHBORS:
        return [_beside(one, target) for one in named]
    if target.kind == IT:
        return [_joined(one, target) for one in named]
    if target.kind == ONES:
        return [like(target, named[-1])] if named else []
    if target.kind == REST or others:
        if earlier is not None and not earlier:
            return []
        last = next((one.kind for one in (*reversed(named), *reversed(earlier or ()))), "building")
        kind = last if target.kind == REST else target.kind
        alike = [one for one in earlier or () if _alike(one, kind)]
        left = tuple(dict.fromkeys((*target.but, *alike)))
        return [replace(target, kind=kind, but=left)]
    return [target]


BESIDE = 15.0  # metres between the walls of neighbours


def _beside(one: Selector, told: Selector) -> Selector:
    """Return the buildings beside one that was named."""
    near = Reference("near", (replace(one, alone=False),), BESIDE)
    return replace(
        told, kind="building", alone=False, where=(*told.where, near), but=(*told.but, one)
    )


def _alike(one: Selector, kind: str) -> bool:
    """Return whether what was changed may be of a kind, of which the rest is spoken of."""
    family = family_of(things(kind).partition(",")[0])
    if not one.kind:
        return family in ("building", "road")
    return family_of(things(one.kind).partition(",")[0]) == family


def _joined(one: Selector, told: Selector) -> Selector:
    """Add to what was named what is said of it now: "those along the river"."""
    filters = (*one.filters, *told.filters)
    added = {
        name: getattr(told, name) for name in ("near", "reach", "inside", "along", "side", "of")
        if getattr(told, name)
    }  # fmt: skip
    return replace(one, filters=filters, where=(*one.where, *told.where),
                   but=(*one.but, *told.but), **added)  # fmt: skip


def _spot_of(target: Selector | None) -> Selector | None:
    """Return the one object that several stand by: "the houses by the church ... as it"."""
    if target is None or target.alone or len(target.ids) == 1:
        return None
    word = target.near or target.inside or target.along or target.of
    if word:
        return Selector(word, alone=True) if things(word) else Selector(ids=(word,))
    spots = [spot for ref in target.where for spot in ref.spots if spot.alone]
    return spots[-1] if spots else None


def _places(edit: Edit) -> list[Reference]:
    """Return the places of a change that are pronouns."""
    return [
        Reference(key, (Selector(IT, alone=True),)) for key, value in edit.change
        if value == IT and key in _PLACES
    ]  # fmt: skip


def _reference(
    ref: Reference, nearer: Selector | None, named: Sequence[Selector]
) -> Reference | None:  # fmt: skip
    """Put objects for the pronouns of a place, None where there are none."""
    spots: list[Selector] = []
    for spot in ref.spots:
        if spot.kind == IT:
            last = named[-1] if named else None
            if spot.alone and nearer is None:
                nearer = _spot_of(last)  # "the cars on the main street ... along it"
            known = [nearer] if nearer is not None else list(named[-1:])
            if not known:
                return None
            spots += known
        elif spot.kind in (ONES, NEIGHBORS):
            if not named:
                return None
            made = like(spot, named[-1]) if spot.kind == ONES else _beside(named[-1], spot)
            spots.append(made)
        else:
            spots.append(spot)
    return replace(ref, spots=tuple(spots))
