"""Parts of speech: words of amounts, bounds, places, denials and commands, and function words."""

from __future__ import annotations

from collections.abc import Mapping

# What data an instruction is about; the words alone do not name a file.
SOURCES: Mapping[str, str] = {
    "osm": "osm, openstreetmap, open street map, osm extract, osm file, osm data, osm map, "
    "openstreetmap extract, openstreetmap file, openstreetmap data, street map, osm layout, map "
    "extract, osm export, open street map data, map data, vector map",
    "semantic_map": "semantic map, semantic layout, segmentation map, segmentation mask, label "
    "map, semantic image, land use map, landuse map, zoning map, semantic segmentation, "
    "class map, segmentation, semantic mask, labeled map, label image, color coded map, "
    "semantic plan, color coded image",
    "height_field": "height field, heightfield, height map, heightmap, elevation model, "
    "elevation map, dem, terrain model, digital elevation model, dtm, elevation data, "
    "terrain data, this terrain, given terrain, relief, height data, terrain file, "
    "the provided terrain, elevation file, height raster, elevation raster, "
    "attached terrain, supplied terrain, digital terrain model, the given relief, topography, "
    "the terrain",
    "satellite": "satellite, satellite image, satellite photo, satellite picture, aerial photo, "
    "aerial photograph, aerial image, aerial picture, orthophoto, bird's eye photo, "
    "satellite imagery, aerial view photo, overhead photo, air photo, aerial shot, aerial, "
    "satellite shot, aerial imagery, orthoimage, drone photo, photo from above",
    "drawn": "sketch, drawing, hand drawn plan, drawn curve, drawn plan, drawn path, hand drawn "
    "map, my drawing, doodle, drawn layout, hand drawn sketch, geojson, drawn line",
    "text_file": "text file, note file, notes file, wish list file, requirements file",
}
# Words that mean whatever file came along.
ANY_SOURCE = (
    "this map, the map, attached file, this file, provided file, given layout, this layout, "
    "the input, attached map, this data, the given map, uploaded file, this image, this picture, "
    "the image, the picture, this photo, the photo, provided map, the layout, attached image, "
    "supplied map, supplied file, the attachment, attached data, the data, the file, this extract, "
    "the extract, uploaded map, uploaded image, attached layout, given file, the footprint data, "
    "provided data, supplied data, layout from the file, given data, attached picture, "
    "provided layout, map, this plan, the plan, attached extract, same street layout"
)

AMOUNTS: Mapping[str, str] = {
    "many": "lots of, lot of, many, plenty of, plenty, numerous, a lot of, loads of, dozens of, "
    "hundreds of, thousands of, abundant, masses of, a great many, plentiful, tons of, full of, "
    "much, a large number of, countless, rich in, a wealth of, an abundance of, lined with, "
    "a multitude of, packed with, more, filled with, heaps of, scores of, teeming with, "
    "a great number of, a good many, ample, tree-mendous, oodles of, everywhere, a sea of, "
    "swarms of, myriad, rows of, a bunch of",
    "few": "few, a few, hardly any, barely any, scarcely any, only a few, a handful of, little, "
    "not many, some, several, scant, very few, fewer, less, the odd, occasional, sparse, "
    "just a few, not too many, not much, a small number of, one or two, scarce, "
    "not very many, the occasional, a smattering of, a sprinkling of, a scattering of, "
    "almost no, nearly no, next to no, not a lot of",
}
STRENGTHS: Mapping[str, str] = {
    "heavy": "heavy, thick, dense, strong, intense, heavily, massive, severe, violent, hard, "
    "extreme, torrential, deep, pouring, very heavy, very thick, fierce, terrible, busy, "
    "considerable",
    "light": "light, slight, less, thin, gentle, faint, soft, mild, lightly, slightly, weak, "
    "a little, a bit of, patchy, a touch of, a hint of, some light, moderate, a bit, subtle, "
    "very light, delicate, calm",
}
SIZES: Mapping[str, str] = {
    "small": "small, little, tiny, smallish, minor, petite, cute little, mini, "
    "pocket size, modest sized",
    "large": "large, big, huge, vast, giant, gigantic, enormous, massive, extensive, grand, great, "
    "sizeable, immense, mega, expansive, very large, very big",
}
HEIGHTS: Mapping[str, str] = {
    "tall": "tall, high, lofty, towering, soaring, very tall, sky high, extremely tall",
    "low": "low, squat, short, single storey, one storey, flat built, not very tall, not tall",
}
WIDTHS: Mapping[str, str] = {
    "wide": "wide, broad, spacious roads, generous, very wide, ample roads, extra wide",
    "narrow": "narrow, tight, slim, very narrow, skinny, cramped lanes, slender",
}
SIDES: Mapping[str, str] = {
    "north": "north, northern, northward, northerly, top",
    "south": "south, southern, southward, southerly, bottom",
    "east": "east, eastern, eastward, easterly, right",
    "west": "west, western, westward, westerly, left bank side, left",
    "northeast": "north east, northeast, north eastern, northeastern",
    "northwest": "north west, northwest, north western, northwestern",
    "southeast": "south east, southeast, south eastern, southeastern",
    "southwest": "south west, southwest, south western, southwestern",
}
AXES: Mapping[str, str] = {
    "north_south": "from north to south, north south, north to south, from south to north, "
    "south to north, south north, from the north to the south, in north south direction, "
    "north-southerly, from the south to the north",
    "east_west": "from east to west, east west, east to west, from west to east, west to east, "
    "west east, from the east to the west, from the west to the east, in east west direction",
    "northeast_southwest": "from northeast to southwest, from southwest to northeast, "
    "northeast to southwest, southwest to northeast",
    "northwest_southeast": "from northwest to southeast, from southeast to northwest, "
    "northwest to southeast, southeast to northwest",
}
USES: Mapping[str, str] = {
    "residential": "for living, residential use, used for housing, for housing",
    "office": "office use, for offices, used as offices",
    "retail": "retail use, for shops",
    "industrial": "industrial use",
    "mixed": "mixed use buildings, mixed use building, buildings of mixed use",
}

# Parts of sentences.
BOUNDS: Mapping[str, str] = {
    "min": "at least, at the very least, minimum, minimum of, min, a minimum of, upwards of, "
    "no less than, "
    "not less than, no fewer than, not fewer than, or more, or higher, or taller, and up, and "
    "above, at the least, at a minimum, starting at, starting from, not under, not below, "
    "no smaller than, or above, and higher, "
    "not smaller than, or greater, or wider",
    "max": "at most, at the very most, maximum, maximum of, max, a maximum of, up to, "
    "no more than, not more than, "
    "not over, not above, or less, or lower, or fewer, at the most, tops, not exceeding, "
    "no greater than, capped at, limited to, restricted to, "
    "as high as, as tall as, or under, at max, or below, "
    "and below, no bigger than, within, "
    "or shorter, or smaller, a limit of, a ceiling of, an upper limit of, kept below, kept under, "
    "no larger than, not larger than, and under, and less, reaching, all the way up to",
    "over": "more than, over, above, exceeding, greater than, larger than, bigger than, in "
    "excess of, beyond, exceed, north of number, surpass, surpassing, rise above, go beyond, "
    "top, in excess",
    "under": "less than, fewer than, under, below, smaller than, beneath, stay below, "
    "stay under, fall below, remain under, remain below, shy of",
    "between": "between, ranging from, from, range from, varying from, anywhere between, "
    "ranging between, vary between, varying between",
}
# Comparatives: attribute and direction.
COMPARED: Mapping[str, str] = {
    "height over": "taller than, higher than, tall than, taller, higher, rise over",
    "height under": "lower than, shorter than, lower, shorter",
    "width over": "wider than, broader than, wider, broader",
    "width under": "narrower than, narrower",
    "slope over": "steeper than, steeper",
    "slope under": "flatter than, less steep than, gentler than",
    "speed over": "faster than, faster",
    "speed under": "slower than, slower",
    "length over": "longer than, longer",
}
ATTRIBUTES: Mapping[str, str] = {
    "height": "tall, high, in height, height, of height, building height, eaves height, heights, "
    "roof height, height limit, elevation above ground",
    "width": "wide, in width, width, broad, breadth, street width, road width, wide each",
    "length": "long, in length, length, deep, in depth, depth",
    "side": "on a side, on each side, a side, per side, each side, on every side, side length, "
    "each way across, to a side, along each side, edge length, square",
    "across": "across, in diameter, diameter, from end to end, edge to edge, wide overall",
    "spacing": "apart, spacing, spaced, distance between, interval, intervals of, a spacing of, "
    "spaced at, at intervals of, placed every, spaced every",
    "slope": "slope, gradient, incline, steep, steepness, grade, inclination, sloping, climb",
    "speed": "speed, speed limit, velocity, driving at, moving at, fast, at a speed of, going at",
    "color": "color, paint color, shade, colour of the walls",
    "material": "material, facade material, wall material, texture",
    "roof": "roof type, roof shape, roof form",
    "count": "number of, the number of, amount of",
    "floors": "number of floors, floor count, number of storeys, storey count, storeys in height",
    "area": "total area of, surface area of, in area, in size, floor area",
    "style": "style, look, architecture, architectural style",
    "weather": "weather, weather condition",
    "time": "time of day, time, daytime setting",
    "density": "building density",
}
APPROX = (
    "about, around, roughly, approximately, circa, ca, ca ., some, nearly, almost, "
    "more or less, in the region of, approx, approx ., give or take, an estimated, or so, ~, "
    "close to, just about, in the order of, something like, somewhere around, ± , near enough"
)
EXACT = "exactly, precisely, just, only, a total of, in total, all told, altogether, strictly"
NEGATIONS = (
    "no, without, w/o, neither, nor, zero, free of, free from, devoid of, lacking, sans, "
    "excluding, exclude, not any, never, don't want, do not want, don't need, do not need, "
    "not, don't, do not, doesn't, mustn't, shouldn't, cannot, can't, won't, isn't, aren't, "
    "must not, should not, shall not, may not, none, nothing, none of them, none of the, avoid, "
    "minus, don't add, do not add, leave out, skip, omit, nowhere, with no, ought not, absent, "
    "not a single, not one, not have, don't include, do not include, there must not be, "
    "without any, bare of, empty of, there should be no, none of these, nobody, "
    "missing, bereft of, void of, hold the, keep out, refrain from, no single, not even"
)
AFTER_NEGATIONS = (
    "is not needed, are not needed, not needed, not required, is not required, not wanted, "
    "not necessary, is not necessary, are not wanted, unwanted, is unnecessary, are not required, "
    "not desired, not allowed, are not allowed, is forbidden, are forbidden, forbidden, banned, "
    "are banned, prohibited, can be left out, can be omitted, should be absent, unnecessary, "
    "not permitted, are prohibited, is prohibited, are absent, is banned, is not wanted, "
    "aren't needed, isn't needed, aren't allowed, is absent, is not allowed, must be absent"
)
NEITHER = (
    "no need for, no need of, never mind, instead of, rather than, doesn't matter, "
    "does not matter, don't care about, don't mind, no matter, don't worry about, "
    "not necessarily, in place of, as opposed to, needn't be, need not be, regardless of"
)
NOTHING_BUT = "nothing but, none other than, no other than, nothing except, nothing other than"
EXCEPTIONS = (
    "except, except for, apart from, other than, aside from, save for, bar, with the exception of, "
    "excepting, all but, but not"
)
KEEPS = (
    "keep, leave, preserve, retain, don't touch, do not touch, without changing, without "
    "touching, don't change, do not change, don't alter, do not alter, do not modify, don't "
    "modify, without altering, don't move, do not move, hands off, spare, conserve, maintain, "
    "without modifying, without affecting, don't affect, without moving, "
    "leave alone, do not alter, don't remove, do not remove, don't delete, do not delete, "
    "without removing, don't edit, don't disturb, do not disturb, do not affect"
)
UNCHANGED = (
    "as it is, as they are, unchanged, as is, untouched, alone, in place, the way it is, the way "
    "they are, intact, stay, stays, remain, remains, as it was, as they were, the same, where "
    "they are, where it is, in peace, stay as they are, stay as it is, like it is, like they are, "
    "unaltered, exactly as it is, exactly as they are, stay the same, remain the same, unmodified, "
    "should stay, must stay, should remain, must remain, be kept, be left, be preserved, "
    "stay put, remains unchanged, must not change, should not change, must not be changed, "
    "should not be changed, may not change, stays unchanged, stay unchanged, remain unchanged, "
    "remain untouched, stay untouched, stay where they are"
)

# Verbs of edits.
VERBS: Mapping[str, str] = {
    "REMOVE": "remove, delete, erase, get rid of, take away, take out, demolish, tear down, knock "
    "down, clear away, eliminate, wipe out, pull down, bulldoze, raze, cut down, scrap, drop, "
    "dispose of, strip out, fell, chop down, clear out, weed out, tear out, do away with, ditch, "
    "destroy, take down, stop, must go, should go, has to go, have to go, vanish, "
    "disappear, shall go, ought to go, can go, end",
    "PAINT": "paint, recolor, color, repaint, dye, tint, coat, spray, colour in, spray paint",
    "CLAD": "clad, cover with, face with, dress, resurface, reclad, wrap, face, cover, pave, "
    "repave",
    "MAKE": "make, turn, set, change, convert, transform, let, have, give, switch, get, render, "
    "adjust, alter, put on, modify, update, exchange weather, bring, go for, fit, restyle, "
    "redesign, redecorate, remodel, refurbish",
    "ADD": "add, put, place, insert, create, build, spawn, erect, install, generate, drop in, "
    "bring in, include, construct, introduce, position, throw in, send, set up, "
    "stick, set down, lay out, dig, lay",
    "PLANT": "plant, sow, grow, line, plant out",
    "REPLACE": "replace, swap, exchange, substitute, swap out, trade, switch out, replace all",
    "MOVE": "move, shift, relocate, push, slide, displace, drag, nudge, translate",
    "ROTATE": "rotate, spin, swivel, pivot, twist",
    "SCALE": "scale, resize, enlarge, shrink, scale up, scale down, blow up, make bigger, "
    "upscale, downscale, magnify",
    "DOUBLE": "double",
    "TRIPLE": "triple, treble",
    "QUADRUPLE": "quadruple",
    "HALVE": "halve, cut in half, divide by two",
    "RAISE": "raise, increase, heighten, lift, elevate, extend, bump up, jack up, boost, grow "
    "taller, add height to",
    "LOWER": "lower, reduce, decrease, cut, shorten, diminish, cut down to, trim, bring down, "
    "lessen, cap, limit, shave, chop, knock, lop, trim down",
    "WIDEN": "widen, broaden, make wider",
    "NARROW": "narrow, narrow down, make narrower, slim down",
    "CLOSE": "close, close off, block off, shut, barricade, seal off, shut down, block, "
    "pedestrianize",
    "OPEN": "open, reopen, unblock, open up",
    "FILL": "fill, populate, crowd, people with, stock",
    "UNDO": "undo, reset, revert, roll back, rollback, take back, reverse, step back, go back, "
    "cancel",
    "REDO": "redo, reapply, undo the undo, undo the last undo, undo that undo, bring back the last "
    "change, restore the last change",
    "COPY": "copy, duplicate, clone, replicate, repeat, reproduce",
    "TURN_OFF": "turn off, switch off, put out, extinguish, turn out",
    "TURN_ON": "turn on, switch on, light up, illuminate",
    "IMPROVE": "improve, beautify, enhance, polish, fix, tweak, jazz up, spruce up, refine, "
    "prettify, better, do something with, surprise me, embellish, touch up, perfect",
    "APPLY": "apply, follow, use, carry out, execute, implement, do, read, take, incorporate",
}
VAGUE = (
    "nicer, better, prettier, more beautiful, more interesting, cooler, more realistic, fancier, "
    "more exciting, less boring, improved, more attractive, more lively, more appealing, "
    "different, more pleasant, more elegant, cozier, more alive, good looking, "
    "more impressive, more atmospheric, more natural, a bit nicer, more livable"
)
RANKS: Mapping[str, str] = {
    "tallest": "tallest, highest",
    "lowest": "lowest, shortest, smallest in height, least tall",
    "largest": "largest, biggest, widest, greatest",
    "smallest": "smallest, narrowest, littlest, tiniest",
    "longest": "longest",
    "oldest": "oldest",
    "nearest": "nearest, closest",
    "farthest": "farthest, furthest, most distant, farthest away, furthest away",
    "northernmost": "northernmost, most northern, most northerly",
    "southernmost": "southernmost, most southern, most southerly",
    "easternmost": "easternmost, most eastern, most easterly",
    "westernmost": "westernmost, most western, most westerly",
}
ORDINALS: Mapping[str, str] = {
    "2": "second, 2nd", "3": "third, 3rd", "4": "fourth, 4th", "5": "fifth, 5th",
    "6": "sixth, 6th", "7": "seventh, 7th", "8": "eighth, 8th", "9": "ninth, 9th",
    "10": "tenth, 10th", "1": "first, 1st",
}  # fmt: skip
RELATIONS: Mapping[str, str] = {
    "near": "near, near to, close to, next to, beside, adjacent to, in front of, around here, "
    "in the vicinity of, opposite, facing, nearby, bordering, neighboring, adjoining, "
    "within reach of, behind, at the edge of, not far from",
    "along": "along, alongside, lining, on both sides of, along both sides of, down, up and "
    "down, on either side of, along the edge of, flanking, along the side of, bordering on, "
    "on the sides of, to both sides of",
    "around": "around, surrounding, encircling, round, all around, circling, about the, "
    "surround, circle, ring around",
    "on": "on, onto, over, across, upon, atop, on top of, at, crossing, cross, span, spanning",
    "in": "in, inside, within, through, throughout, in the middle of, in the center of, "
    "amid, among, inside of, all over, at the center of, across the whole",
    "of": "of",
    "to": "to, into, as, towards, toward",
    "by": "by",
    "with": "with, having, featuring, that have, which have, which has, that has, made of, made "
    "from, made out of, built of, built from, out of, consisting of, for, from, in favor of, "
    "by means of",
    "from": "from, off, off of",
    "be": "is, are, be, was, were, should be, shall be, must be, ought to be, should become, "
    "become, becomes, need to be, needs to be, has to be, have to be, can be, will be, to be, "
    "turned, should get, shall get, shall become, gets, should have, should look, shall have, "
    "must have, must become, should turn, want it to be, be made, should be made, should now be, "
    "needs, need, could do with, could use, deserves, deserve, is short of, are short of, lacks, "
    "is lacking, are lacking, is missing, are missing, calls for, is crying out for, "
    "should, shall, must, i want, i would like, would like, i'd like, want",
    "and": "and, &, plus, as well as, along with, then, and then, also, and also",
    "but": "but, however, yet, though, although, while, whereas",
    "or": "or",
    "all": "all, every, each, all of, all the, both, whole, entire, every single, each and every, "
    "every one of, complete, everything in",
    "rest": "rest of the, the rest of, remaining, rest of, other, others, remaining of the",
    "it": "it, that, this, them, these, those, they",
    "direction": "in each direction, each way, per direction, in either direction, each direction, "
    "in both directions, per side direction, each side direction, on each side of the road, "
    "every direction, going each way, both ways, in every direction",
    "total": "in total, altogether, in all, combined",
    "every": "every, each",
    "apart": "apart",
    "times": "times, x, fold, ×, *",
    "twice": "twice, twice as, two times, doubly",
    "thrice": "thrice, three times",
    "half as": "half as",
    "factor": "factor, factor of, a factor of, by a factor of, by factor",
    "clockwise": "clockwise, to the right turn",
    "counterclockwise": "counterclockwise, anticlockwise, anti clockwise, counter clockwise",
    "every other": "every other, every second, alternate, every 2nd, each second",
    "every third": "every third, every 3rd, each third",
    "every fourth": "every fourth, every 4th, each fourth",
    "last": "last, latest, previous, recent, most recent, final",
    "change": "change, edit, step, action, modification, thing, operation, move",
    "more": "more, additional, further, extra",
    "please": "please, pls, kindly",
    "green": "green, greenery, vegetated, green space, planted, covered in greenery, of greenery",
}
MODES: Mapping[str, str] = {
    "run": "running, run, jogging, jog, sprinting, sprint, runner, jogger, runs, jogs, racing",
    "walk": "walking, walk, strolling, stroll, wandering, hiking, walker, ambling, sauntering, "
    "walks, strolls, promenading, on foot",
    "stand": "standing, waiting, stand, idle, idling, wait",
    "sit": "sitting, seated, sit",
    "ride": "riding, ride, cycling, pedaling",
    "drive": "driving, drive, cruising, cruise, moving, circulating",
    "park": "parked, parking",
    "fly": "hovering",
}

# Words that carry nothing a city could be measured by.
_FUNCTION_WORDS = """
    a an the i we you he she they me my our your his her us one ones who whom whose which what when
    where why how there here be been being am is are was were do does did done have has had having
    will would shall should can could may might must let's lets i'd we'd i'll i'm it's there's
    detached
        that's you'd please kindly just simply really quite very rather fairly pretty so too also
        even
    as at by for from in into of off on onto out over per than then to under up upon via with
    within and or but if because since until while during after before again once only own same
    such both each every either some any all most more other another well now like want need wish
    wants needs wishes love prefer desire fancy hope looking look looks make makes build generate
    create design construct produce render model show give gimme set put add place draw develop
    imagine picture simulate set get got sketch prepare compose lay made built laid like would
    go goes going come comes coming run runs lead leads leave leaves lie lies lying stand stands
    standing sit sits sitting rise rises rising stretch stretches fill fills filled cover covers
    covering covered surround surrounded surrounds surrounding join joined joins connect connects
    connected contain contains containing include includes including feature features featuring
    consist consists consisting locate located situated situate place placed arrange arranged
    follow follows following cross crosses crossed crossing pass passes passing flow flows flowing
    line lines lined split splits cut cuts divide divides divided separate separated dotted dot
    hit hits meet meets reach reaches take takes keep keeps measure measures measuring based base
    use used using rebuild recreate reconstruct reproduce drape turn turned possible style styled
    looks feel feeling feels vibe mood atmosphere flair charm typical character touch theme themed
    town city scene area place region part parts side sides kind sort type types thing things bit
    number amount total size sized layout plan version example setting view overall whole entire
    day light air sky weather condition conditions everywhere somewhere around about across along
    through throughout between among behind above below near next front back middle center edge end
    top bottom inside outside nice beautiful lovely pretty gorgeous stunning great good cool
    awesome cozy charming picturesque idyllic quiet calm peaceful tranquil vibrant dramatic
    realistic detailed impressive attractive elegant interesting romantic magical iconic wonderful
    pleasant clean tidy quaint serene atmospheric urban new old general generally mostly mainly
    largely predominantly chiefly primarily mix mixture mixed variety various different diverse
    where's first finally next lastly additionally moreover furthermore instead still maybe perhaps
    somehow probably ideally preferably possibly definitely certainly surely basically obviously
    hi hello hey thanks thank ok okay yes sorry dear sir madam assistant computer hmm well oh um er
    this that these those it its itself them their theirs themselves ourselves myself not no
    anyway together alone though although however therefore thus hence onto towards toward
    me's wanna gonna gotta lemme exactly precisely approximately
    standing have hosting houses host stay seen see through's itself's
    someone something anything everything nothing everyone nobody somebody none
    image picture file data input map provided given attached supplied uploaded following above
    hereby herewith enclosed according accordance basis
    wide wider tall high long deep direction directions way ways
    morning's proper properly nicely beautifully evenly randomly sparsely freely gently softly
    row rows series group groups estate everybody everyone choking hanging hangs fallen
    dead cold cool warm mild parallel reflecting bright brightly carries carry varies vary varying
    absolutely totally completely entirely fully
    sure ensure certain certainly welcome welcomes fishing becomes converted originally formerly
    once
    long-standing famous known called named typically usually normally visible sight directly
    immediately straight
"""
FUNCTION_WORDS = frozenset(_FUNCTION_WORDS.split())
