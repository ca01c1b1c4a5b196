"""The phrase book: the words an instruction may use, by what they say.

Triggers stand in one line, parted by commas. Plurals, -ing, -ed and British spellings need no
trigger of their own; hyphens count as spaces; the longest trigger wins.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from cityx.assets.furniture.street_furniture import outside_pieces
from cityx.assets.styles.style_shares import outside_styles
from cityx.assets.trees.species import OUTSIDE_TREES
from cityx.language.lexicon import changing, nouns, speech

Book = Mapping[str, Mapping[str, str]]

# Key of a slot -> value -> triggers.
SLOTS: Book = {
    "style": {
        "modern": "modern, modernist, contemporary, present day, sleek, minimalist, minimalistic, "
        "21st century, up to date, state of the art, newly built, bauhaus, international style, "
        "modern looking, today's",
        "futuristic": "futuristic, sci fi, scifi, science fiction, cyberpunk, cyber punk, "
        "high tech, hi tech, space age, utopian, dystopian, blade runner, from the future, "
        "of the future, future, solarpunk, next century, 22nd century",
        "european": "european, euro, central european, western european, continental, "
        "old world, eu style, europe, north european, northern european, french, german, "
        "austrian, viennese, swiss, polish, czech, prague, vienna, berlin, wilhelminian",
        "haussmann": "haussmann, haussmannian, parisian, paris, paris like",
        "japanese": "japanese, japan, nippon, tokyo, kyoto, osaka, edo, tokyo like",
        "chinese": "chinese, china, cantonese, hutong, hong kong, shanghai, beijing, peking",
        "asian": "asian, oriental, east asian, south east asian, southeast asian, far eastern, "
        "korean, seoul, vietnamese, thai, bangkok",
        "american": "american, us style, usa, north american, new york, new yorker, manhattan, "
        "manhattan like, chicago, midwestern, brooklyn, los angeles, us american, californian",
        "british": "british, english, london, london like, uk style",
        "victorian": "victorian, victoria era, 19th century",
        "georgian": "georgian, 18th century, bath like",
        "mediterranean": "mediterranean, italian, spanish, greek, tuscan, provencal, southern "
        "european, portuguese, andalusian, santorini, amalfi, roman, cycladic, catalan",
        "medieval": "medieval, middle ages, half timbered, timber framed, dark ages, feudal",
        "gothic": "gothic, neo gothic, gothic revival",
        "baroque": "baroque, rococo, renaissance",
        "classical": "classical, neoclassical, classic, neo classical, beaux arts, belle epoque, "
        "stately, historicist, traditional, old fashioned, historical",
        "art_deco": "art deco, artdeco, deco, 1920s, roaring twenties, streamline moderne",
        "art_nouveau": "art nouveau, jugendstil",
        "brutalist": "brutalist, brutalism, raw concrete style",
        "soviet": "soviet, soviet era, soviet style, eastern bloc, communist, khrushchev, "
        "plattenbau, panel block, stalinist, ddr, gdr",
        "scandinavian": "scandinavian, nordic, swedish, norwegian, danish, finnish, icelandic",
        "dutch": "dutch, amsterdam, flemish, holland, amsterdam like",
        "arabic": "arabic, arabian, arab, middle eastern, moorish, moroccan, persian, islamic, "
        "ottoman, oriental bazaar, turkish, egyptian",
        "indian": "indian, mughal, mumbai, delhi",
        "latin_american": "latin american, mexican, brazilian, cuban, colonial, spanish colonial",
        "postmodern": "postmodern, post modern, postmodernist",
        "rustic": "rustic, country style, farmhouse style, alpine, tyrolean, chalet style",
    },
    "district": {
        "downtown": "downtown, down town, city center, town center, inner city, city core, "
        "central business district, cbd, business district, business quarter, financial district, "
        "office district, office quarter, metropolitan center, urban core, urban center, midtown, "
        "banking district, banking quarter, high rise district, skyscraper district, "
        "heart of the city, heart of town, financial center, central district",
        "old_town": "old town, old quarter, old city, historic center, historic core, "
        "historic quarter, historic district, historic town, historic city, historical center, "
        "historical quarter, historical district, altstadt, ancient town, ancient quarter, "
        "ancient city, walled town, walled city, heritage quarter, heritage district, "
        "medieval center, medieval town, medieval quarter, medieval city, casbah, medina",
        "suburban": "suburban, suburb, suburbia, garden suburb, outskirt, outer district, "
        "commuter town, commuter belt, bedroom community, urban fringe, subdivision, "
        "single family neighborhood, garden city, exurb, cul de sac neighborhood",
        "industrial": "industrial, industry, industrial area, industrial estate, industrial zone, "
        "industrial district, industrial quarter, industrial park, industrial site, "
        "factory district, manufacturing district, manufacturing area, heavy industry, works "
        "area, business park, logistics park, logistics hub, warehouse district, "
        "industrial complex, freight area, mill town",
        "coastal": "coastal, seaside, by the sea, coast, seaside resort, coastal resort, beach "
        "town, oceanfront, seafront, by the ocean, on the coast, at the sea, shore town, "
        "at the seaside, on the sea, along the coast, maritime, beach resort, riviera, coastline, "
        "on the seashore, next to the sea, facing the sea, on the shore",
        "harbour": "harbor town, port town, port city, harbor city, harbor district, "
        "harbor quarter, docklands, dockland, docks, dockside, port district, port area, "
        "harbor area, fishing port, waterfront district, shipyard district, wharf district",
        "residential": "residential, residential area, residential quarter, residential district, "
        "residential neighborhood, housing estate, housing area, housing development, "
        "housing district, dormitory town, apartment district, living quarter, bedroom suburb, "
        "residential zone, dwelling area, council estate, neighborhood, quiet neighborhood",
        "village": "village, hamlet, country village, rural settlement, farming community, "
        "rural, countryside, country town, farm village, fishing village, mountain village, "
        "rural village, settlement in the country, farmland, small settlement",
        "commercial": "commercial, commercial area, commercial district, shopping district, "
        "shopping area, retail district, retail area, retail park, shopping street, market "
        "district, high street, shopping quarter, commercial zone, shopping precinct, "
        "commercial quarter, retail quarter, bazaar, trade district, shopping mile",
        "campus": "campus, university campus, university district, college campus, "
        "university quarter, science park, research park, college town, university town, "
        "technology park, tech park",
        "mixed_use": "mixed use, mixed use district, mixed use quarter, mixed quarter, "
        "mixed neighborhood, mixed development",
        "entertainment": "entertainment district, nightlife district, theater district, "
        "red light district, amusement district",
        "slum": "slum, favela, shanty town, shantytown, informal settlement",
    },
    "density": {
        "high": "dense, densely built, densely built up, high density, tightly packed, compact, "
        "crowded together, closely packed, close packed, packed, jam packed, built up, "
        "densely packed, cramped, congested city, close knit, closely built, tightly built, "
        "highly dense, very dense, crammed, concrete jungle, dense jungle of, jungle of, "
        "forest of skyscrapers, forest of towers, "
        "heavily built up, heavily built, cheek by jowl, wall to wall, dense city, dense urban, "
        "densely populated, "
        "shoulder to shoulder, packed together, packed close together, densely",
        "medium": "medium density, moderately dense, mid density, moderate density, "
        "medium dense, neither dense nor sparse, average density",
        "low": "sparse, sparsely built, sparsely built up, low density, spread out, "
        "loosely built, scattered, thinly built, thinly settled, airy, widely spaced, "
        "far apart, sprawling, loosely spaced, sparsely populated, thinly populated, loose, "
        "few and far between, well spaced, sparsely, with a lot of space between, spacious",
    },
    "weather": {
        "clear": "clear, sunny, sunshine, clear sky, blue sky, cloudless, cloudless sky, "
        "bright sunshine, fair weather, sunlit, sun drenched, bright sun, blazing sunshine, "
        "blazing sun, sun, fine weather, good weather, nice weather, "
        "sun kissed, clear weather, not a cloud, not a cloud in the sky, unclouded, "
        "bright blue sky, strong sun, brilliant sunshine, sun shine, "
        "beautiful weather, bright and sunny, glorious weather, bathed in sunlight, sunlight, "
        "dry weather, in the sun, under the sun, without a cloud in the sky",
        "cloudy": "cloudy, partly cloudy, some clouds, few clouds, a few clouds, scattered "
        "clouds, broken clouds, cloud, light clouds, sunny spells, fluffy clouds, fair with "
        "clouds, passing clouds, partially cloudy, slightly cloudy, half cloudy, "
        "sun and clouds, puffy clouds, white clouds, mostly sunny",
        "overcast": "overcast, overcast sky, gray sky, grey skies, leaden sky, dull weather, "
        "gloomy, dull, gray day, gray weather, heavy clouds, thick clouds, covered sky, "
        "dreary, bleak, cloud covered, cloud cover, clouded over, low clouds, dark clouds, "
        "heavily clouded, fully clouded, closed cloud cover, completely clouded, sunless, "
        "very cloudy, dull sky, leaden, mostly cloudy, gray clouds, blanket of cloud",
        "rain": "rain, rainy, raining, wet weather, rainfall, rain falls, rainy weather, "
        "rain soaked, in the rain, steady rain, wet day, it rains, pluvial, rainstorm, "
        "rain swept, raindrop, shower, rain washed",
        "storm": "storm, stormy, thunderstorm, thunder, lightning, thunder and lightning, "
        "tempest, hurricane, gale, thundery, severe weather, typhoon, lightning storm, "
        "squall, electrical storm, lightning bolts, thunder storm, stormy weather",
        "fog": "fog, foggy, mist, misty, low visibility, poor visibility, fogbound, foggy "
        "weather, wreathed in mist, shrouded in mist, shrouded in fog, ground fog, sea fog, "
        "patchy fog, veiled in mist, murk, ground mist, mist covered, fog covered",
        "haze": "haze, hazy, smog, smoggy, hazy air, dusty air, polluted air, heat haze, murky, "
        "air pollution, hazy sky, milky sky, hazy sunshine, polluted, exhaust haze, dusty haze, "
        "hazy weather",
        "snow": "snow, snowy, snowing, snowfall, snowed in, snow covered, snow capped, "
        "covered in snow, covered with snow, under snow, blanketed in snow, snow clad, "
        "snowflake, snowy weather, blanket of snow, snowscape, wintry, frosted, "
        "snow laden, snowbound, snow bound, snow topped, white christmas, wintery, "
        "layer of snow, snow lies, covered in white, blanketed in white",
    },
    "time": {
        "dawn": "dawn, daybreak, break of day, first light, crack of dawn, cockcrow, day break, "
        "early dawn, before sunrise, just before sunrise, before the sun comes up, "
        "just before the sun comes up, before the sun rises, sky is getting light, "
        "before daybreak, first rays",
        "sunrise": "sunrise, sun up, sunup, rising sun, sun rises, as the sun rises, morning sun "
        "rises, sun comes up, sun is rising",
        "morning": "morning, early morning, mid morning, late morning, breakfast time, "
        "in the morning, forenoon, morning light, morning hours, a . m .",
        "noon": "noon, midday, mid day, high noon, noonday, noontime, lunchtime, lunch time, "
        "middle of the day, twelve o'clock, daytime, broad daylight, day time, by day, "
        "during the day, full daylight, sun high in the sky, high sun, sun overhead, "
        "sun at its highest, noon sun, at its zenith",
        "afternoon": "afternoon, late afternoon, early afternoon, mid afternoon, "
        "afternoon light, tea time",
        "golden_hour": "golden hour, golden light, magic hour, golden evening light, "
        "low golden sun, warm low sun, golden hour light",
        "sunset": "sunset, sundown, sun go down, the sun go down, setting sun, sun sets, "
        "as the sun sets, sun goes down, sun set, "
        "sun is setting, evening sun sets, sun going down, sinking sun",
        "dusk": "dusk, twilight, nightfall, blue hour, gloaming, after sunset, just after sunset, "
        "dimming light, getting dark, got dark, gets dark, growing dark, night is falling, "
        "night falls, darkness falls, "
        "dark is falling, light is fading, fading light, last light, day is ending, "
        "at the fall of night, evening twilight, crepuscule",
        "evening": "evening, late evening, early evening, in the evening, dinner time, "
        "evening hours",
        "night": "night, nighttime, night time, midnight, at night, late at night, by night, "
        "nocturnal, nite, after dark, dead of night, middle of the night, in the dark, "
        "nightly, moonlight, deep night, small hours, night scene, overnight, night sky, "
        "darkness, witching hour, tonight, under the stars, after nightfall",
    },
    "season": {
        "spring": "spring, springtime, cherry blossom season, cherry blossom, spring day, "
        "early spring, late spring, in bloom, april, may time, march",
        "summer": "summer, summertime, midsummer, high summer, summer day, summery, hot summer, "
        "warm summer, hot summer day, june, july, "
        "august, late summer, dog days",
        "autumn": "autumn, fall season, fall colors, autumnal, in the fall, autumn leaves, fall "
        "foliage, golden leaves, october, november, september, falling leaves, late autumn, "
        "indian summer, autumn colors",
        "winter": "winter, wintertime, midwinter, christmas, january, february, december, "
        "cold winter, freezing winter, cold winter day, winter day, deep winter, "
        "in winter, winter time",
    },
    "building.roof": {
        "flat": "flat roof, flat roofed, flat top, flat topped, level roof",
        "gabled": "gabled roof, gabled, gable roof, pitched roof, saddle roof, sloping roof, "
        "sloped roof, steep roof, pointed roof, gable, saddleback roof, pitch roof",
        "hipped": "hipped roof, hip roof, hipped",
        "mansard": "mansard roof, mansard, gambrel roof",
        "pyramidal": "pyramid roof, pyramidal roof, tent roof",
        "dome": "dome, domed roof, dome roof, cupola, domed",
        "round": "barrel roof, round roof, vaulted roof, curved roof, barrel vault",
        "sawtooth": "sawtooth roof, saw tooth roof, sawtooth",
        "tile": "tiled roof, tile roof, terracotta roof, clay tile, roof tile, tiled, "
        "terracotta tile, clay roof, clay tile roof",
        "thatch": "thatched roof, thatched, thatch, thatch roof, straw roof",
        "slate": "slate roof, slate, slated roof, shingle roof, shingled roof",
        "green": "green roof, roof garden, planted roof, rooftop garden, living roof, "
        "grass roof, vegetated roof",
        "metal": "metal roof, tin roof, copper roof, corrugated roof, sheet metal roof",
    },
    "roads.pattern": {
        "grid": "grid, regular grid, gridiron, grid pattern, street grid, chequerboard, "
        "checkerboard, rectangular grid, grid plan, grid layout, right angled streets, "
        "at right angles, orthogonal, manhattan grid, rectilinear, regular blocks, grid like, "
        "gridded, grid of streets, strict grid, chessboard, square grid, square blocks, "
        "rectangular blocks, straight streets, perpendicular streets, orthogonal grid, grid city, "
        "grid road, streets in a grid, perpendicular",
        "organic": "organic, winding, wind gently, curvy, curving, crooked, meandering, "
        "irregular streets, twisting, twisted streets, maze of streets, maze of alleys, maze of "
        "lanes, labyrinth, labyrinthine, sinuous, winding streets, warren of streets, serpentine, "
        "irregular, haphazard, tangled, tangle of streets, unplanned, snaking, maze, maze like, "
        "bendy, curvilinear, higgledy piggledy, zigzag, windy streets, curved streets, wiggly, "
        "grown over centuries, irregular pattern, winding road, bent streets",
        "radial": "radial, star shaped, hub and spoke, radiating, fanning out, radiate, "
        "star like, spoke like, radial concentric, spokes, concentric, like a star, spider web, "
        "fan out, star pattern, cobweb, like the spokes of a wheel, sunburst, like spokes, "
        "spiderweb, starburst, radially, leading to the center, converge on, converging on, "
        "meet at a central, branch out from",
        "ring": "ring shaped, circular streets, ring pattern, circular plan, circular layout, "
        "round city, rings of streets",
        "cul_de_sac": "cul de sac, culs de sac, dead end street, dead end road, dead ends, "
        "looping streets",
        "superblock": "superblock, super block, perimeter superblocks",
        "mixed": "mixed street pattern, mix of street patterns",
    },
    "terrain": {
        "flat": "flat landscape, flat terrain, flat ground, flat land, level ground, on a plain, "
        "plain, flat country, level terrain, perfectly flat, on flat land",
        "hilly": "hilly, hill, rolling hills, hillside, hilltop, undulating, on a hill, sloping "
        "ground, uneven terrain, on a slope, rolling terrain, foothill, hilly terrain, "
        "hilly ground",
        "mountainous": "mountainous, mountain, alpine valley, mountain side, in the mountains, "
        "steep terrain, mountain valley, among mountains, at the foot of a mountain",
        "valley": "valley, in a valley, ravine",
    },
    "lights": {
        "neon": "neon light, neon sign, neon lit, neon, neon advertising, neon glow, neon tube, "
        "neon lighting",
        "on": "lights on, lamps lit, lit up, illuminated, lit windows, lighted windows, "
        "street lamps lit, lanterns glow, lamps glow, lights glow, lamps shine, lanterns shine, "
        "windows glow, street lights on, glowing windows, lit, brightly lit, lamps burning, "
        "lights are on, lit street lamps, glowing street lamps, city lights, illuminated windows, "
        "street lights lit, lamp lit, well lit, lanterns lit, lamplight, lights glowing, lamps on, "
        "lamps are on, street lamps on, street lamps are on, street lights are on",
        "off": "lights off, lamps off, blackout, power cut, unlit, lights out, "
        "street lights off, power outage, lights are off, in darkness, without lighting, "
        "lamps are off, street lamps off, street lamps are off, street lights are off",
    },
    "wetness": {
        "high": "wet street, wet asphalt, wet road, wet pavement, wet ground, puddle, "
        "rain slicked, after the rain, glistening streets, wet, dripping wet, shiny with water, "
        "streets are shiny, shiny streets, shiny asphalt, gleaming asphalt, "
        "after a shower, just rained, rain slick, slick streets, flooded, soaking wet, "
        "reflections on the wet, after rain, waterlogged, after a downpour",
        "low": "dry streets, dry ground, dry road, dry asphalt, dry pavement",
    },
    "traffic": {
        "heavy": "traffic jam, rush hour, congested, congestion, gridlock, bumper to bumper, "
        "peak hour, stop and go, clogged with cars, busy traffic, busy road, jammed, "
        "busy street, full of cars, full of traffic, bustling traffic, choked with traffic, "
        "clogged, heavy traffic, dense traffic, lots of traffic, peak hours, thick traffic, "
        "traffic is heavy, crowded roads, busy with cars, jammed with cars, packed with cars, "
        "rush hour traffic, much traffic, high traffic, traffic is dense, chock full of cars, "
        "heavily trafficked",
        "medium": "moderate traffic, normal traffic, average traffic, medium traffic, some "
        "traffic, regular traffic, usual traffic",
        "light": "light traffic, little traffic, hardly any traffic, sparse traffic, thin "
        "traffic, low traffic, quiet road, quiet street, scarcely any traffic, barely any "
        "traffic, traffic is light, calm traffic, not much traffic, minimal traffic, "
        "almost no traffic, traffic calmed, the odd car, an occasional car, occasional car, "
        "nearly no traffic, slow traffic day, nearly empty roads, barely a car, hardly a car",
    },
    "pedestrians": {
        "heavy": "crowded sidewalk, crowded street, crowded pavement, crowd, busy sidewalk, "
        "bustling sidewalk, busy pavement, throng, full of people, packed with people, "
        "bustling, crowds of people, pedestrians everywhere, people everywhere, hustle and "
        "bustle, teeming with people, lively, thronged, swarming with people, busy with people, "
        "bustling crowd, full of pedestrians, packed sidewalks, full of life, crowded with people, "
        "milling crowds, crowded with pedestrians, lots of foot traffic, heavy foot traffic, "
        "busy with pedestrians, crowded with shoppers, full of shoppers, mobbed, animated, "
        "throngs of people, crowds of shoppers, crowded, packed with pedestrians",
        "light": "odd passer by, few passers by, a handful of people, occasional passer by, "
        "occasional pedestrian, hardly anyone, hardly anybody, hardly a soul, barely anyone, "
        "almost no people, hardly any people, hardly any pedestrians, "
        "a lone walker, lonely walker, nearly nobody about, few people about, "
        "light foot traffic, some strollers, almost nobody",
    },
    "building.feature": {
        "balcony": "balcony, balconies, loggia",
        "arcade": "arcade, arcaded, colonnade",
        "shopfront": "shop on the ground floor, shops on the ground floor, ground floor shop, "
        "ground floor retail, shops at street level, retail at ground level, shopfront, "
        "storefront, shops below, shop fronts, retail on the ground floor, shop windows",
        "antenna": "rooftop antenna, antenna on the roof",
        "chimney": "chimney, smokestack, smoke stack",
        "bay_window": "bay window",
        "solar": "solar panel, photovoltaic panel",
        "awning": "awning, canopy",
    },
    "size": {
        "small": "small town, small city, little town, tiny town, tiny city, small scale, "
        "small sized, compact town, pocket sized, miniature, mini city",
        "medium": "medium sized, mid sized, medium size, middle sized, of medium size, midsize, "
        "average sized, medium scale",
        "large": "large city, big city, huge city, large town, large scale, mega city, megacity, "
        "giant city, vast city, sprawling metropolis, megalopolis, enormous city, "
        "big town, large sized, massive city, gigantic city",
    },
}

# Triggers that say several things at once.
TOGETHER: Mapping[str, str] = {
    "weather=rain rain.intensity=light": "drizzle, drizzly, drizzling, light shower, sprinkle, "
    "spitting rain, light rain, gentle rain, soft rain, fine rain, slight rain, light drizzle",
    "weather=rain rain.intensity=heavy": "downpour, pouring rain, torrential rain, pouring, "
    "heavy rain, cloudburst, deluge, monsoon, lashing rain, bucketing down, heavy shower, "
    "raining cats and dogs, torrent, heavy downpour, driving rain, torrential downpour, "
    "monsoon rain, pelting rain",
    "weather=snow snow.intensity=light": "dusting of snow, light snow, snow flurry, flurry, "
    "light snowfall, sprinkling of snow, few snowflakes, light dusting of snow, thin snow, "
    "thin layer of snow, a little snow, some snow, gentle snow, gentle snowfall, powdering of "
    "snow, light layer of snow, thin blanket of snow, slight snow, soft snowfall, snow dusted, "
    "dusted with snow, hint of snow",
    "weather=snow snow.intensity=heavy": "blizzard, snowstorm, snow storm, deep snow, "
    "heavy snow, heavy snowfall, thick snow, thick blanket of snow, snowdrift, buried in snow, "
    "thick layer of snow, whiteout, snowed under, dense snowfall, knee deep snow",
    "weather=fog fog.intensity=heavy": "thick fog, dense fog, heavy fog, pea soup, pea souper, "
    "thick mist, dense mist, heavy mist, deep fog",
    "weather=fog fog.intensity=light": "light fog, light mist, thin fog, thin mist, slight fog, "
    "slight mist, wisps of fog, wisps of mist, hint of fog, touch of mist, faint mist, some mist",
    "weather=clear time=night": "starry sky, starry, starlit, moonlit, star filled sky, starry "
    "night, clear night, moonlit night, starry night sky, full moon, stars",
    "season=winter time=evening": "christmas eve",
    "traffic=light pedestrians=light": "quiet streets, calm streets, sleepy streets, "
    "peaceful streets, nearly empty streets, almost deserted",
    "traffic=heavy pedestrians=heavy": "bustling streets, hustling and bustling, busy downtown",
    "not=vehicle not=pedestrian": "deserted, deserted streets, empty streets, abandoned, "
    "ghost town, lifeless, uninhabited, depopulated, devoid of life, empty of life",
    "not=vehicle": "car free, carfree, traffic free, pedestrianized, pedestrianised, vehicle free, "
    "pedestrian zone, pedestrian precinct, pedestrian only, auto free, motor free, "
    "pedestrian area",
    "not=pedestrian": "pedestrian free, people free, nobody is outside, nobody outside, "
    "not a soul, "
    "nobody about, nobody around, no one around, no one about, nobody on the streets, nobody in "
    "sight, nobody to be seen, not a soul in sight, not a soul to be seen, nobody is about, "
    "nobody is around, no one is outside, no one in sight, nobody walks, nobody is on the streets",
    "not=tree": "treeless, tree free, barren of trees, without a tree, not a single tree",
    "not=bridge": "bridgeless",
    "roads.width=narrow roads.pattern=organic": "maze of narrow streets, narrow winding lanes, "
    "tangle of alleys, warren of alleys, labyrinth of alleys, maze of alleyways",
    "nature.trees=many": "leafy, tree lined, lots of greenery, green city, verdant, lush, "
    "wooded, tree filled, full of trees, rich in trees, plenty of greenery, lush vegetation, "
    "much greenery, well treed, avenue of trees, green and leafy, lots of green, very green, "
    "lush green, lots of vegetation, heavily planted, forested, dense vegetation, green oasis, "
    "rows of trees, rich vegetation, lined with trees, greenery everywhere, trees everywhere, "
    "shaded by trees, tree shaded, greenery, abundant vegetation, lush greenery, flanked by trees, "
    "trees on both sides, plenty of green, bordered by trees",
    "nature.trees=few": "hardly any trees, sparse vegetation, little vegetation, little greenery, "
    "hardly any greenery, few trees, barely any trees, almost no trees, scarcely any trees, "
    "not many trees, a tree here and there, the odd tree, hardly a tree, sparse trees, "
    "sparse greenery, scarce trees, scattered trees, not much green, not much greenery, bare",
    "building.height=tall building.type=tower": "towering skyscraper, soaring skyscraper, "
    "soaring tower, sky high towers, supertall, supertall tower, giant skyscraper",
    "building.height=low": "low rise, low slung, low lying buildings, lowrise",
    "building.height=medium": "mid rise, medium rise, midrise, mid height, medium height, "
    "not too tall, not too high, not very high, not overly tall, moderately tall, moderately high",
    "density=medium": "not too dense, not very dense, not overly dense, not so dense",
    "building.height=varied": "varied heights, varying heights, mixed heights, "
    "different heights, various heights",
}

# Kind of words -> what they say -> triggers, of the words that need others beside them.
TABLES: Book = {
    "material": nouns.MATERIALS, "color": nouns.COLOURS, "source": speech.SOURCES,
    "amount": speech.AMOUNTS, "strength": speech.STRENGTHS, "size": speech.SIZES,
    "height": speech.HEIGHTS, "width": speech.WIDTHS, "side": speech.SIDES,
    "axis": speech.AXES, "use": speech.USES, "bound": speech.BOUNDS,
    "compared": speech.COMPARED, "attr": speech.ATTRIBUTES, "verb": speech.VERBS,
    "rank": speech.RANKS, "ordinal": speech.ORDINALS, "rel": speech.RELATIONS,
    "mode": speech.MODES, "surface": changing.SURFACES, "direction": changing.DIRECTIONS,
    "strip": changing.STRIPS, "degree": changing.DEGREES, "later": changing.LATER,
}  # fmt: skip
# The same where the kind says all.
LISTS: Mapping[str, str] = {
    "any_source": speech.ANY_SOURCE, "approx": speech.APPROX, "exact": speech.EXACT,
    "neg": speech.NEGATIONS, "after_neg": speech.AFTER_NEGATIONS, "neither": speech.NEITHER,
    "nothing_but": speech.NOTHING_BUT, "except": speech.EXCEPTIONS, "keep": speech.KEEPS,
    "unchanged": speech.UNCHANGED, "vague": speech.VAGUE,
}  # fmt: skip

_TITLES = {
    "material": "Materials", "color": "Colours", "source": "Words for input files",
    "amount": "Amounts", "strength": "Strength of rain, snow, fog and traffic",
    "size": "Sizes", "height": "Heights without a number", "width": "Widths without a number",
    "side": "Sides", "axis": "Directions of main streets", "use": "Uses of buildings",
    "bound": "Bounds", "compared": "Comparisons", "attr": "What a number measures",
    "verb": "Commands", "rank": "Ranks", "ordinal": "Places in a rank",
    "rel": "Relations", "mode": "What people do", "surface": "Surfaces of streets",
    "direction": "Which way one drives", "strip": "What lies beside lanes",
    "degree": "More and less of the weather", "later": "Later and earlier", "neg": "Denials",
    "after_neg": "Denials behind", "neither": "Neither asked for nor denied", "keep": "Protection",
    "unchanged": "Protection behind", "except": "Exceptions",
    "vague": "Wishes that need a question",
    "any_source": "Words for whatever file came along", "approx": "About", "exact": "Exactly",
    "nothing_but": "Nothing but",
}  # fmt: skip


def entries() -> Iterator[tuple[str, str, str]]:
    """Yield kind, value and triggers of everything in the phrase book."""
    for key, values in SLOTS.items():
        for value, triggers in values.items():
            yield "slot", f"{key}={value}", triggers
    for style in sorted(outside_styles() - set(SLOTS["style"])):
        yield "slot", f"style={style}", style.replace("_", " ")
    for several, triggers in TOGETHER.items():
        yield "slot", several, triggers
    outside = {word for words in nouns.outside_types().values() for word in words}
    for group, names in nouns.NOUNS.items():
        for noun, triggers in names.items():
            own = ", ".join(word for word in triggers.split(", ") if word not in outside)
            yield "noun", f"{group}:{noun}", own
    for noun, words in nouns.outside_types().items():
        yield "noun", f"type:{noun}", ", ".join(words)
    for noun, piece in outside_pieces().items():
        spoken = dict.fromkeys((noun.replace("_", " "), *piece.words))
        yield "noun", f"element:{noun}", ", ".join(spoken)
    trees = dict.fromkeys(word for tree in OUTSIDE_TREES.values() for word in tree.words)
    if trees:
        yield "noun", "plant:tree", ", ".join(trees)
    for kind, table in TABLES.items():
        for value, triggers in table.items():
            yield kind, value, triggers
    for kind, triggers in LISTS.items():
        yield kind, kind, triggers


def phrase_book() -> str:
    """Return the phrase book as Markdown."""
    lines = [
        "# Phrase book",
        "",
        "The words an instruction may use. Plurals, -ing, -ed, hyphens and British or American",
        "spelling make no difference; the longest phrase wins; a word that is not here is listed",
        'as not understood, never guessed at. `cityx explain "TEXT"` shows what was read.',
    ]
    for key, values in SLOTS.items():
        lines += _table(f"`{key}`", values)
    lines += _table("Several at once", TOGETHER)
    for group, names in nouns.NOUNS.items():
        lines += _table(f"Nouns: {group}", names)
    for kind, table in TABLES.items():
        lines += _table(_TITLES[kind], table)
    for kind, triggers in LISTS.items():
        lines += _table(_TITLES[kind], {kind: triggers})
    return "\n".join(lines) + "\n"


def _table(title: str, values: Mapping[str, str]) -> list[str]:
    rows = [f"| `{value}` | {triggers.replace('|', '/')} |" for value, triggers in values.items()]
    return ["", f"## {title}", "", "| reads as | words |", "| --- | --- |", *rows]
