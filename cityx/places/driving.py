"""On which side of the road a place drives."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from cityx.city.frame import Frame

# (south, west, north, east) in degrees of left-driving countries, drawn inwards at land borders
# with countries that keep right.
LEFT_DRIVING = (
    (49.8, -10.8, 61.0, 1.8),  # Great Britain, Ireland, Channel (France is carved out below)
    (35.7, 14.1, 36.1, 14.6),  # Malta
    (34.5, 32.2, 35.7, 34.6),  # Cyprus
    (24.0, 122.9, 45.6, 146.0),  # Japan (Korea and the Russian coast are carved out below)
    (6.0, 68.0, 35.6, 88.1),  # India, Sri Lanka, Nepal
    (21.5, 88.1, 28.3, 92.4),  # Bangladesh, Bhutan
    (22.0, 91.5, 28.0, 95.5),  # north-east India
    (23.6, 61.0, 36.9, 75.5),  # Pakistan
    (5.6, 97.4, 20.4, 102.6),  # Thailand
    (13.5, 102.6, 18.3, 104.8),  # Isan
    (0.8, 99.6, 7.4, 119.3),  # Malaysia, Singapore, Brunei
    (-11.1, 95.0, 6.0, 141.1),  # Indonesia
    (-10.7, 141.0, -0.9, 156.0),  # Papua New Guinea
    (22.1, 113.82, 22.57, 114.45),  # Hong Kong
    (22.1, 113.52, 22.22, 113.60),  # Macau
    (-44.0, 112.9, -10.0, 154.0),  # Australia
    (-47.5, 166.0, -34.0, 179.0),  # New Zealand
    (-35.0, 16.4, -22.1, 33.0),  # South Africa, Lesotho, Eswatini
    (-29.0, 11.7, -17.0, 25.3),  # Namibia
    (-26.9, 20.0, -17.8, 29.4),  # Botswana
    (-22.4, 25.2, -8.2, 33.1),  # Zambia, Zimbabwe
    (-17.2, 32.7, -9.4, 35.9),  # Malawi
    (-26.9, 32.0, -10.5, 40.9),  # Mozambique
    (-11.7, 30.8, -1.0, 40.5),  # Tanzania
    (-1.5, 29.6, 4.2, 35.0),  # Uganda
    (-4.7, 34.0, 4.6, 41.9),  # Kenya
    (-20.6, 57.2, -19.9, 57.9),  # Mauritius
    (17.6, -78.5, 18.6, -76.1),  # Jamaica
    (10.0, -61.95, 11.4, -60.4),  # Trinidad, Tobago
    (13.0, -59.7, 13.4, -59.4),  # Barbados
    (20.9, -79.4, 27.3, -72.7),  # Bahamas (Florida and Cuba are carved out below)
    (1.2, -61.4, 8.6, -56.5),  # Guyana
    (-19.3, 176.8, -15.7, 180.0),  # Fiji
)
RIGHT_DRIVING = (
    (48.0, -5.2, 49.3, 8.0),  # Normandy and south of it
    (48.6, 1.3, 51.12, 8.0),  # Picardy, Calais
    (48.6, 0.2, 50.2, 8.0),  # Upper Normandy
    (33.0, 124.0, 43.5, 129.7),  # Korea
    (42.2, 129.7, 49.0, 140.0),  # Russian coast
    (21.8, 117.0, 25.4, 122.2),  # Taiwan
    (10.0, 102.75, 14.4, 107.8),  # Cambodia
    (14.6, 102.75, 22.6, 108.5),  # Laos beyond the Mekong, Vietnam
    (8.3, 104.6, 23.5, 109.6),  # Vietnam
    (5.0, 119.4, 19.5, 127.0),  # Philippines
    (9.6, 92.4, 28.6, 97.9),  # Burma
    (29.0, 60.5, 38.6, 66.2),  # Afghanistan, Iran's east
    (33.9, 66.2, 38.6, 70.9),  # Kabul
    (27.5, 80.2, 46.0, 96.0),  # Tibet
    (17.93, 102.2, 19.5, 102.75),  # Vientiane
    (-12.2, 25.0, -8.0, 28.3),  # Katanga
    (25.0, -81.5, 27.5, -80.0),  # Florida
    (19.7, -79.5, 22.4, -74.1),  # Cuba
)
# Cities and lands that a carved box would take although they keep left.
LEFT_AGAIN = (
    (26.3, 80.0, 30.5, 88.2),  # Nepal, Sikkim
    (22.0, 91.5, 28.0, 94.6),  # Assam, Manipur, Chittagong
    (24.0, 66.2, 31.5, 72.0),  # Sindh, southern Punjab
    (5.6, 97.8, 20.4, 101.0),  # western Thailand
    (29.9, 66.4, 31.0, 67.6),  # Quetta
    (33.0, 129.0, 34.8, 132.0),  # Kyushu, Tsushima
    (42.2, 139.3, 45.6, 146.0),  # Hokkaido
    (17.2, 102.0, 17.92, 104.3),  # Udon Thani
)


def _in_any(latitude: float, longitude: float, boxes: tuple[tuple[float, ...], ...]) -> bool:
    return any(s <= latitude <= n and w <= longitude <= e for s, w, n, e in boxes)


def keeps_left(frame: Frame, asked: str = "auto") -> bool:
    """Tell whether traffic keeps to the left: as asked, or with "auto" as in the country."""
    word = drives_on(frame.latitude, frame.longitude) if asked == "auto" else asked
    return word == "left"


def drives_on(latitude: float, longitude: float) -> str:
    """Return "left" or "right", the side one drives on at a place (degrees).

    Boxes decide, so within some 50 km of a border where the side changes the answer may be wrong;
    Timor and Suriname, which keep left, count with their neighbours.
    """
    if _in_any(latitude, longitude, LEFT_AGAIN):
        return "left"
    if _in_any(latitude, longitude, RIGHT_DRIVING):
        return "right"
    return "left" if _in_any(latitude, longitude, LEFT_DRIVING) else "right"
