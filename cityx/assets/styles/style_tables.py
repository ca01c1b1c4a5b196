"""Which building generators a style is built of, by the use of buildings, with weights."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

Weights = Mapping[str, float]

# Style family -> use group -> generators and weights.
TABLE: Mapping[str, Mapping[str, Weights]] = MappingProxyType(
    {
        "european": {
            "house": {"suburban_house": 7, "cottage": 1, "bungalow": 1},
            "flats": {
                "palazzo": 8,
                "perimeter_block": 9,
                "mixed_use": 2,
                "panel_slab": 1.5,
                "brutalist": 0.3,
                "shop_house": 0.5,
                "art_deco": 0.5,
            },
            "office": {
                "office_slab": 5,
                "mixed_use": 2,
                "palazzo": 3,
                "glass_tower": 2,
                "postmodern_tower": 1,
                "brutalist": 0.7,
            },
            "retail": {"big_box": 3, "mixed_use": 2, "shop_house": 3, "palazzo": 1},
            "civic": {"palazzo": 4, "perimeter_block": 2, "mixed_use": 2, "brutalist": 1},
        },
        "brick": {
            "house": {"cottage": 5, "suburban_house": 3, "georgian_terrace": 2, "bungalow": 0.7},
            "flats": {
                "georgian_terrace": 12,
                "palazzo": 2,
                "mixed_use": 1.5,
                "panel_slab": 0.8,
                "walk_up": 1,
                "brutalist": 0.8,
                "shop_house": 1,
                "art_deco": 0.8,
            },
            "office": {
                "georgian_terrace": 3,
                "office_slab": 4,
                "mixed_use": 2,
                "glass_tower": 3,
                "palazzo": 2,
                "postmodern_tower": 1.5,
                "brutalist": 1,
            },
            "retail": {"georgian_terrace": 3, "shop_house": 3, "big_box": 2, "mixed_use": 2},
            "civic": {"georgian_terrace": 3, "palazzo": 3, "mixed_use": 1, "brutalist": 1},
        },
        "mediterranean": {
            "house": {"mediterranean_house": 5, "bungalow": 2, "suburban_house": 1},
            "flats": {
                "mediterranean_house": 10,
                "panel_slab": 2,
                "mixed_use": 3,
                "palazzo": 2,
                "perimeter_block": 1,
                "art_deco": 0.8,
            },
            "office": {
                "office_slab": 4,
                "glass_tower": 2,
                "mediterranean_house": 2,
                "postmodern_tower": 1,
            },
            "retail": {"mediterranean_house": 2, "shop_house": 2, "big_box": 3, "mixed_use": 1},
            "civic": {"mediterranean_house": 3, "palazzo": 3, "panel_slab": 1, "brutalist": 1},
        },
        "american": {
            "house": {"suburban_house": 5, "bungalow": 3, "cottage": 1},
            "flats": {
                "walk_up": 9,
                "mixed_use": 4,
                "panel_slab": 1.5,
                "brutalist": 0.4,
                "art_deco": 2,
            },
            "office": {
                "office_slab": 4,
                "glass_tower": 4,
                "setback_skyscraper": 4,
                "postmodern_tower": 3,
                "walk_up": 1.5,
                "brutalist": 0.7,
            },
            "retail": {"big_box": 5, "walk_up": 2, "shop_house": 2, "mixed_use": 1.5},
            "civic": {"walk_up": 2, "palazzo": 3, "office_slab": 2, "brutalist": 1},
        },
        "asian": {
            "house": {"japanese_lowrise": 5, "suburban_house": 2, "bungalow": 0.5},
            "flats": {
                "asian_block": 8,
                "japanese_lowrise": 6,
                "mixed_use": 3,
                "panel_slab": 1,
                "office_slab": 0.7,
            },
            "office": {
                "office_slab": 5,
                "asian_block": 2,
                "glass_tower": 3,
                "mixed_use": 2,
                "postmodern_tower": 1,
                "japanese_lowrise": 1,
            },
            "retail": {"shop_house": 3, "japanese_lowrise": 4, "big_box": 2, "office_slab": 1},
            "civic": {"asian_block": 2, "panel_slab": 1, "office_slab": 2, "brutalist": 1},
        },
        "modern": {
            "house": {"bungalow": 2, "suburban_house": 1, "mixed_use": 1},
            "flats": {"mixed_use": 7, "panel_slab": 1, "office_slab": 1, "asian_block": 1},
            "office": {"glass_tower": 5, "office_slab": 3, "mixed_use": 2, "postmodern_tower": 2},
            "retail": {"mixed_use": 3, "glass_tower": 1, "big_box": 2},
            "civic": {"mixed_use": 3, "office_slab": 2, "brutalist": 1},
        },
        "industrial": {
            "house": {"cottage": 2, "georgian_terrace": 1},
            "flats": {"walk_up": 5, "warehouse": 1, "georgian_terrace": 1},
            "office": {"walk_up": 2, "office_slab": 2},
            "retail": {"walk_up": 2, "big_box": 2, "shop_house": 1},
            "civic": {"walk_up": 3, "panel_slab": 1},
        },
        "house": {
            "house": {"suburban_house": 3, "cottage": 1, "bungalow": 1},
            "flats": {"suburban_house": 1, "perimeter_block": 1},
            "office": {"perimeter_block": 1, "office_slab": 1},
            "retail": {"big_box": 1, "shop_house": 1},
            "civic": {"perimeter_block": 1},
        },
    }
)
ALWAYS: Mapping[str, Weights] = MappingProxyType(
    {
        "industry": {"warehouse": 6, "sawtooth_factory": 1.5},
        "worship": {"church": 1},
        "shed": {"shed": 1},
    }
)
# Words of a brief that favour generators, and by how much, whatever the family.
STYLE_WORDS: Mapping[str, Weights] = MappingProxyType(
    {
        "brutalist": {"brutalist": 30, "panel_slab": 3},
        "soviet": {"panel_slab": 30, "brutalist": 3},
        "art_deco": {"setback_skyscraper": 900, "art_deco": 900},
        "postmodern": {"postmodern_tower": 30},
        "haussmann": {"palazzo": 40},
        "classical": {"palazzo": 10},
        "georgian": {"georgian_terrace": 10},
        "victorian": {"georgian_terrace": 6, "cottage": 3},
        "glass": {"glass_tower": 12},
        "futuristic": {"glass_tower": 12},
        "suburban": {"suburban_house": 4, "bungalow": 3},
        "japanese": {"japanese_lowrise": 6},
        "chinese": {"asian_block": 6},
    }
)
