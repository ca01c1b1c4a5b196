"""What an environment tells of lights."""

import pytest

from cityx.city.environment import AFTER_DARK, Environment


@pytest.mark.parametrize(
    ("hour", "lamps", "shops", "glow"),
    [(12.0, 0.0, 0.0, 1.0), (6.0, 0.0, 0.0, 0.0), (20.5, 0.0, 0.0, 0.0),
     (18.0, 1.0, 0.9, 0.9 * AFTER_DARK), (3.0, 1.0, 0.0, 0.0)],
)  # fmt: skip
def test_rooms_of_shops_are_lit_while_they_are_open(hour, lamps, shops, glow):
    found = Environment(hour=hour, lamps=lamps, shop_lights=shops).shop_glow
    assert found == pytest.approx(glow)
