"""Shop words: what stands over a shop whose name no map tells, by language and kind of shop."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

# Tags of shop=* and amenity=* -> kind of shop.
KINDS: Mapping[str, str] = MappingProxyType(
    {
        word: kind
        for kind, words in {
            "bakery": "bakery pastry confectionery",
            "cafe": "cafe ice_cream tea coffee internet_cafe",
            "restaurant": "restaurant food_court",
            "quick": "fast_food",
            "bar": "bar pub biergarten nightclub",
            "pharmacy": "pharmacy chemist medical_supply",
            "grocer": "supermarket convenience greengrocer grocery deli beverages",
            "clothes": "clothes boutique fashion shoes bag fabric tailor",
            "hair": "hairdresser beauty cosmetics massage nails",
            "books": "books stationery newsagent copyshop",
            "flowers": "florist garden_centre",
            "butcher": "butcher seafood",
            "optician": "optician hearing_aids",
            "jeweller": "jewelry watches pawnbroker",
            "kiosk": "kiosk tobacco variety_store lottery",
            "phones": "mobile_phone electronics computer hifi",
            "bicycles": "bicycle sports outdoor",
            "bank": "bank bureau_de_change",
            "wine": "alcohol wine",
            "cleaner": "dry_cleaning laundry",
            "travel": "travel_agency estate_agent insurance",
            "furniture": "furniture interior_decoration houseware antiques art gift music toys",
        }.items()
        for word in words.split()
    }
)
# What shops sell where nothing is known, and how often.
USUAL: Mapping[str, float] = MappingProxyType(
    {
        "bakery": 7, "cafe": 9, "restaurant": 11, "quick": 6, "bar": 5, "pharmacy": 4, "grocer": 7,
        "clothes": 10, "hair": 9, "books": 4, "flowers": 3, "butcher": 2, "optician": 3,
        "jeweller": 2, "kiosk": 4, "phones": 3, "bicycles": 2, "bank": 2, "wine": 2, "cleaner": 3,
        "travel": 3, "furniture": 5,
    }
)  # fmt: skip
Words = Mapping[str, tuple[str, ...]]
WORDS: Mapping[str, Words] = MappingProxyType(
    {
        "en": {
            "bakery": ("Bakery", "The Bread Shop", "Cakes & Pastries"),
            "cafe": ("Café", "Coffee House", "Espresso Bar", "Tea Room"),
            "restaurant": ("Restaurant", "Trattoria", "Brasserie", "Noodle Bar", "Curry House"),
            "quick": ("Fish & Chips", "Pizza", "Sandwiches", "Burgers", "Kebab"),
            "bar": ("The Crown", "Wine Bar", "The Red Lion", "Cocktails"),
            "pharmacy": ("Pharmacy", "Chemist"), "grocer": ("Food & Wine", "Supermarket", "Grocer"),
            "clothes": ("Menswear", "Boutique", "Shoes", "Tailors", "Outfitters"),
            "hair": ("Barber", "Hair Salon", "Nails & Beauty"),
            "books": ("Books", "Bookshop", "News", "Stationers"), "flowers": ("Florist", "Flowers"),
            "butcher": ("Butcher", "Fishmonger"), "optician": ("Opticians", "Eye Care"),
            "jeweller": ("Jewellers", "Watches"), "kiosk": ("News & Tobacco", "Sweets"),
            "phones": ("Phones", "Computers"), "bicycles": ("Cycles", "Sports"),
            "bank": ("Bank",), "wine": ("Wines", "Off Licence"),
            "cleaner": ("Dry Cleaners", "Launderette"), "travel": ("Travel", "Estate Agents"),
            "furniture": ("Interiors", "Antiques", "Gallery", "Records", "Toys", "Gifts"),
        },
        "de": {
            "bakery": ("Bäckerei", "Konditorei", "Backstube"),
            "cafe": ("Café", "Eiscafé", "Kaffeehaus"),
            "restaurant": ("Restaurant", "Gasthaus", "Ristorante", "Sushi"),
            "quick": ("Imbiss", "Döner Kebap", "Pizza", "Bistro"),
            "bar": ("Kneipe", "Zum Anker", "Bar", "Bierstube"),
            "pharmacy": ("Apotheke", "Drogerie"), "grocer": ("Supermarkt", "Feinkost", "Bioladen"),
            "clothes": ("Mode", "Schuhe", "Herrenausstatter", "Textilien"),
            "hair": ("Friseur", "Haarstudio", "Nagelstudio", "Kosmetik"),
            "books": ("Buchhandlung", "Schreibwaren", "Bücher", "Copyshop"),
            "flowers": ("Blumen", "Floristik"), "butcher": ("Fleischerei", "Metzgerei"),
            "optician": ("Optiker", "Brillen"), "jeweller": ("Juwelier", "Uhren & Schmuck"),
            "kiosk": ("Spätkauf", "Tabak & Presse", "Lotto"), "phones": ("Handyshop", "Computer"),
            "bicycles": ("Fahrräder", "Sport"), "bank": ("Sparkasse",),
            "wine": ("Weinhandlung", "Getränke"), "cleaner": ("Reinigung", "Waschsalon"),
            "travel": ("Reisebüro", "Immobilien", "Versicherung"),
            "furniture": ("Möbel", "Antiquitäten", "Galerie", "Geschenke", "Spielwaren"),
        },
        "fr": {
            "bakery": ("Boulangerie", "Pâtisserie"), "cafe": ("Café", "Salon de thé"),
            "restaurant": ("Restaurant", "Brasserie", "Bistrot"),
            "quick": ("Crêperie", "Pizza", "Kebab"), "bar": ("Bar", "Bar-Tabac", "Cave à bières"),
            "pharmacy": ("Pharmacie",), "grocer": ("Alimentation", "Primeurs", "Épicerie"),
            "clothes": ("Prêt-à-porter", "Chaussures", "Mode"),
            "hair": ("Coiffeur", "Coiffure", "Institut de beauté"),
            "books": ("Librairie", "Papeterie", "Presse"), "flowers": ("Fleuriste", "Fleurs"),
            "butcher": ("Boucherie", "Poissonnerie"), "optician": ("Opticien",),
            "jeweller": ("Bijouterie", "Horloger"), "kiosk": ("Tabac", "Presse"),
            "phones": ("Téléphonie", "Informatique"), "bicycles": ("Cycles", "Sports"),
            "bank": ("Banque",), "wine": ("Caviste", "Vins"), "cleaner": ("Pressing", "Laverie"),
            "travel": ("Voyages", "Immobilier", "Assurances"),
            "furniture": ("Antiquités", "Galerie", "Décoration", "Cadeaux", "Jouets"),
        },
        "it": {
            "bakery": ("Panificio", "Pasticceria"), "cafe": ("Caffè", "Gelateria"),
            "restaurant": ("Ristorante", "Trattoria", "Osteria"), "quick": ("Pizzeria", "Panini"),
            "bar": ("Bar", "Enoteca"), "pharmacy": ("Farmacia",),
            "grocer": ("Alimentari", "Frutta e Verdura"), "clothes": ("Abbigliamento", "Calzature"),
            "hair": ("Parrucchiere", "Barbiere"), "books": ("Libreria", "Cartoleria"),
            "flowers": ("Fiori",), "butcher": ("Macelleria", "Pescheria"), "optician": ("Ottica",),
            "jeweller": ("Gioielleria",), "kiosk": ("Tabacchi", "Edicola"),
            "phones": ("Telefonia",), "bicycles": ("Biciclette",), "bank": ("Banca",),
            "wine": ("Vini",), "cleaner": ("Lavanderia",), "travel": ("Viaggi", "Immobiliare"),
            "furniture": ("Arredamento", "Antiquariato", "Ferramenta"),
        },
        "es": {
            "bakery": ("Panadería", "Pastelería"), "cafe": ("Café", "Cafetería"),
            "restaurant": ("Restaurante", "Mesón"), "quick": ("Bocadillos", "Pizzería"),
            "bar": ("Bar", "Taberna", "Bodega"), "pharmacy": ("Farmacia",),
            "grocer": ("Alimentación", "Frutería", "Ultramarinos"), "clothes": ("Moda", "Zapatos"),
            "hair": ("Peluquería", "Barbería"), "books": ("Librería", "Papelería"),
            "flowers": ("Floristería",), "butcher": ("Carnicería", "Pescadería"),
            "optician": ("Óptica",), "jeweller": ("Joyería",), "kiosk": ("Estanco", "Lotería"),
            "phones": ("Móviles",), "bicycles": ("Bicicletas",), "bank": ("Banco",),
            "wine": ("Vinos",), "cleaner": ("Tintorería", "Lavandería"),
            "travel": ("Viajes", "Inmobiliaria"), "furniture": ("Muebles", "Ferretería", "Regalos"),
        },
        "ja": {
            "bakery": ("パン工房", "ベーカリー", "和菓子"), "cafe": ("喫茶", "カフェ", "珈琲館"),
            "restaurant": ("食堂", "寿司", "そば処", "レストラン", "中華料理", "焼肉"),
            "quick": ("ラーメン", "カレー", "牛丼", "餃子"), "bar": ("居酒屋", "スナック", "バー"),
            "pharmacy": ("薬局", "くすり"), "grocer": ("スーパー", "青果", "コンビニ"),
            "clothes": ("洋服", "ブティック", "靴", "呉服"),
            "hair": ("美容室", "理容", "ヘアサロン"),
            "books": ("書店", "文具", "古本"), "flowers": ("生花店", "フラワー"),
            "butcher": ("精肉店", "鮮魚"), "optician": ("メガネ", "眼鏡"),
            "jeweller": ("時計宝石", "質"), "kiosk": ("たばこ", "宝くじ"),
            "phones": ("ケータイ", "パソコン"), "bicycles": ("サイクル", "自転車"),
            "bank": ("銀行",),
            "wine": ("酒店", "酒"), "cleaner": ("クリーニング",), "travel": ("不動産", "旅行"),
            "furniture": ("家具", "雑貨", "ギャラリー", "歯科", "整骨院"),
        },
    }
)  # fmt: skip
# Understood nearly everywhere; for places whose language is not in the table.
WORLD: Words = MappingProxyType(
    {
        "bakery": ("Café",), "cafe": ("Café", "Espresso"), "restaurant": ("Restaurant", "Sushi"),
        "quick": ("Pizza", "Kebab", "Burger"), "bar": ("Bar", "Pub"), "pharmacy": ("Pharma",),
        "grocer": ("Market", "Mini Market"), "clothes": ("Moda", "Boutique"), "hair": ("Salon",),
        "books": ("Foto", "Copy"), "flowers": ("Flora",), "butcher": ("Delikatess",),
        "optician": ("Optik",), "jeweller": ("Diamant",), "kiosk": ("Kiosk",),
        "phones": ("Mobile", "Computer"), "bicycles": ("Sport", "Bike"), "bank": ("Bank",),
        "wine": ("Vino",), "cleaner": ("Express",), "travel": ("Tour",), "furniture": ("Galeria",),
    }
)  # fmt: skip
# South, west, north, east, language; the first box that holds a place wins.
_TONGUES = (
    (24.0, 122.9, 46.0, 146.0, "ja"),
    (49.8, -11.0, 61.0, 1.8, "en"),
    (46.2, 9.6, 47.5, 17.0, "de"),
    (36.0, 6.7, 46.2, 18.6, "it"),
    (36.0, -9.6, 43.4, 3.4, "es"),
    (47.3, 7.55, 55.0, 15.1, "de"),
    (47.5, 9.5, 49.0, 17.1, "de"),
    (49.3, 6.05, 53.7, 7.6, "de"),
    (42.3, -5.5, 51.1, 7.6, "fr"),
    (25.0, -170.0, 72.0, -52.0, "en"),
    (-56.0, -90.0, 25.0, -56.0, "es"),
    (-48.0, 110.0, -11.0, 180.0, "en"),
)


def tongue_of(latitude: float, longitude: float) -> str:
    """Name the language of signs at a place (WGS84 degrees), a key of `WORDS`, or ""."""
    for south, west, north, east, tongue in _TONGUES:
        if south <= latitude <= north and west <= longitude <= east:
            return tongue
    return ""


def words_of(tongue: str) -> Words:
    """Return the words of a language by kind of shop."""
    return WORDS.get(tongue, WORLD)
