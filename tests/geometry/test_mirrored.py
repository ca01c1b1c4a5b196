import numpy as np
import pytest

from cityx.geometry.mirrored import images, near

SITE = (-100.0, -50.0, 300.0, 250.0)


def test_every_image_meets_its_site_at_the_common_border():
    low, high = np.array(SITE[:2]), np.array(SITE[2:])
    corners = np.array([[*low, *high]])
    assert len([*images(SITE, 300.0)]) > 3
    for image in images(SITE, 300.0):
        (box,) = image.placed(corners)
        assert box[2:] - box[:2] == pytest.approx(high - low)
        steps = (box[:2] - low) / (high - low)
        assert steps == pytest.approx(np.round(steps))


def test_images_and_site_do_not_overlap():
    corner = np.array([[SITE[0], SITE[1], SITE[2], SITE[3]]])
    boxes = [image.placed(corner)[0] for image in images(SITE, 500.0)]
    places = {tuple(np.round(box[:2], 6)) for box in boxes}
    assert len(places) == len(boxes) == 24
    assert SITE[:2] not in places


def test_a_street_that_leaves_the_site_meets_its_own_image():
    leaves = np.array([[SITE[2], 40.0, SITE[2], 46.0]])
    east = next(i for i in images(SITE, 200.0) if i.sign[0] < 0 < i.sign[1] and i.shift[0] > 0)
    assert east.placed(leaves) == pytest.approx(leaves)


def test_what_stands_across_the_border_or_far_off_has_no_image():
    boxes = np.array(
        [[280.0, 0.0, 299.0, 20.0], [290.0, 0.0, 310.0, 20.0], [-90.0, 0.0, -80.0, 20.0]]
    )
    east = next(i for i in images(SITE, 200.0) if i.sign[0] < 0 < i.sign[1] and i.shift[0] > 0)
    assert near(east, boxes, SITE, 200.0).tolist() == [True, False, False]
