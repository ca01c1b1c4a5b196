import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cityx.city.frame import Frame
from cityx.places.countries import _borders, country_at
from cityx.places.profiles import climate_of, keeps_left, profile_names, profile_of

# Towns at borders and coasts: country, side one drives on, family of houses, how minor roads give
# way, climate of trees, language over shops.
BORDER_TOWNS = {
    "Vladivostok": (43.115, 131.886, "RU right european teeth temperate ru"),
    "Boulogne-sur-Mer": (50.726, 1.614, "FR right european teeth temperate fr"),
    "Calais": (50.951, 1.858, "FR right european teeth temperate fr"),
    "Dover": (51.128, 1.313, "GB left brick double_dashes temperate en"),
    "Liège": (50.633, 5.567, "BE right european teeth temperate fr"),
    "Antwerp": (51.221, 4.399, "BE right european teeth temperate nl"),
    "Maastricht": (50.851, 5.691, "NL right european teeth temperate nl"),
    "Aachen": (50.776, 6.084, "DE right european dashes temperate de"),
    "Strasbourg": (48.584, 7.745, "FR right european teeth temperate fr"),
    "Kehl": (48.575, 7.815, "DE right european dashes temperate de"),
    "Basel": (47.558, 7.588, "CH right european teeth temperate de"),
    "Konstanz": (47.660, 9.176, "DE right european dashes temperate de"),
    "Geneva": (46.204, 6.143, "CH right european teeth temperate fr"),
    "Lugano": (46.004, 8.951, "CH right european teeth temperate it"),
    "Salzburg": (47.800, 13.045, "AT right european teeth temperate de"),
    "Bolzano": (46.498, 11.354, "IT right mediterranean teeth temperate de"),
    "Trieste": (45.650, 13.776, "IT right mediterranean teeth temperate it"),
    "Monaco": (43.738, 7.424, "MC right european teeth temperate fr"),
    "Gibraltar": (36.140, -5.353, "GI right mediterranean teeth warm en"),
    "Newry": (54.175, -6.340, "GB left brick double_dashes temperate en"),
    "Dundalk": (54.004, -6.402, "IE left brick double_dashes temperate en"),
    "Copenhagen": (55.676, 12.568, "DK right european teeth temperate -"),
    "Malmö": (55.605, 13.000, "SE right european teeth temperate -"),
    "Narva": (59.377, 28.190, "EE right european teeth north -"),
    "Tijuana": (32.515, -117.038, "MX right mediterranean stop warm es"),
    "San Diego": (32.716, -117.161, "US right american stop warm en"),
    "Monterrey": (25.687, -100.316, "MX right mediterranean stop warm es"),
    "El Paso": (31.762, -106.485, "US right american stop warm en"),
    "Montreal": (45.502, -73.567, "CA right american stop temperate fr"),
    "Toronto": (43.653, -79.383, "CA right american stop temperate en"),
    "Busan": (35.180, 129.076, "KR right asian dashes temperate -"),
    "Fukuoka": (33.590, 130.402, "JP left asian stop japan ja"),
    "Hong Kong": (22.280, 114.160, "HK left asian double_dashes tropic en"),
    "Shenzhen": (22.543, 114.058, "CN right asian dashes tropic -"),
    "Macau": (22.198, 113.544, "MO left asian double_dashes tropic pt"),
    "Singapore": (1.290, 103.852, "SG left asian dashes tropic en"),
    "Johor Bahru": (1.493, 103.741, "MY left asian dashes tropic en"),
    "Nairobi": (-1.286, 36.817, "KE left mediterranean dashes tropic en"),
    "Kinshasa": (-4.322, 15.307, "CD right mediterranean dashes tropic fr"),
    "Santiago": (-33.449, -70.669, "CL right mediterranean stop warm es"),
    "Porto Alegre": (-30.033, -51.230, "BR right mediterranean stop warm pt"),
}  # fmt: skip


@pytest.mark.parametrize("town", BORDER_TOWNS)
def test_a_town_at_a_border_is_built_as_its_country_builds(town):
    latitude, longitude, expected = BORDER_TOWNS[town]
    frame = Frame(latitude, longitude)
    profile = profile_of(frame)
    found = (
        country_at(latitude, longitude), profile.drive, profile.buildings.family,
        profile.painting.give_way.replace(" ", "_"), climate_of(frame), profile.shops.tongue or "-",
    )  # fmt: skip
    assert " ".join(found) == expected


@pytest.mark.parametrize(
    ("latitude", "longitude"),
    [(51.5, -0.1), (53.3, -6.3), (35.7, 139.7), (33.6, 130.4), (28.6, 77.2), (27.7, 85.3),
     (13.75, 100.5), (3.1, 101.7), (-6.2, 106.8), (-33.9, 151.2), (-8.55, 125.57), (5.85, -55.2),
     (-32.05, 115.75), (-36.85, 174.76), (-33.9, 18.4), (24.9, 67.0), (18.0, -76.8)],
)  # fmt: skip
def test_these_cities_keep_left(latitude, longitude):
    assert keeps_left(Frame(latitude, longitude))


@pytest.mark.parametrize(
    ("latitude", "longitude"),
    [(52.5, 13.4), (48.86, 2.35), (40.7, -74.0), (37.57, 127.0), (10.8, 106.7), (21.0, 105.8),
     (25.0, 121.5), (14.6, 121.0), (16.8, 96.2), (25.8, -80.2), (23.1, -82.4), (-20.14, -44.2),
     (55.8, 37.6), (34.5, 69.2)],
)  # fmt: skip
def test_these_cities_keep_right(latitude, longitude):
    assert not keeps_left(Frame(latitude, longitude))


def test_a_pier_is_of_its_coast_and_the_high_seas_are_of_nobody():
    assert country_at(50.70, 1.50) == "FR"  # 8 km off Boulogne
    assert country_at(45.0, -35.0) == ""
    assert profile_of(Frame(45.0, -35.0)).name == "world"


@given(st.floats(-90, 90), st.floats(-540, 540))
def test_every_place_has_a_profile(latitude, longitude):
    frame = Frame(latitude, longitude)
    assert profile_of(frame).drive in ("left", "right")
    assert climate_of(frame) in profile_of(frame).trees.street


def test_every_country_of_the_map_has_a_profile():
    assert {code.lower() for code in _borders().codes} <= set(profile_names())


def test_both_sides_of_each_land_border_are_found_a_little_away_from_it():
    borders = _borders()
    rng = np.random.default_rng(3)
    land = np.flatnonzero((borders.sides >= 0).all(axis=1))
    length = np.hypot(*(borders.end[land] - borders.start[land]).T)
    rows = rng.choice(land[length > 0.02], 300, replace=False)
    right = 0
    for row in rows.tolist():
        start, end = borders.start[row], borders.end[row]
        along = (end - start) / np.hypot(*(end - start))
        for side, sign in ((0, 1.0), (1, -1.0)):
            x, y = (start + end) / 2 + sign * 1e-3 * np.array([-along[1], along[0]])
            right += country_at(float(y), float(x)) == borders.codes[borders.sides[row, side]]
    assert right >= 0.98 * 600  # towns of the table, and slivers between lines, differ
