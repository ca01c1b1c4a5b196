"""Where the sun stands.

References
----------
NOAA Global Monitoring Laboratory, "Solar calculation details", after Meeus, "Astronomical
Algorithms", 2nd edition, 1998. Good to 0.01 degrees between 1900 and 2100, refraction apart.
"""

from __future__ import annotations

from datetime import UTC, datetime
from math import acos, asin, atan2, cos, degrees, pi, radians, sin, tan

EPOCH = datetime(2000, 1, 1, 12, tzinfo=UTC)  # J2000.0
CENTURY = 36_525 * 86_400.0  # seconds


def sun_coordinates(when: datetime) -> tuple[float, float]:
    """Return declination (radians) and equation of time (minutes) at a moment with a time zone."""
    t = (when - EPOCH).total_seconds() / CENTURY
    mean_longitude = radians((280.46646 + t * (36000.76983 + 0.0003032 * t)) % 360.0)
    anomaly = radians(357.52911 + t * (35999.05029 - 0.0001537 * t))
    eccentricity = 0.016708634 - t * (0.000042037 + 0.0000001267 * t)
    center = (
        sin(anomaly) * (1.914602 - t * (0.004817 + 0.000014 * t))
        + sin(2 * anomaly) * (0.019993 - 0.000101 * t)
        + sin(3 * anomaly) * 0.000289
    )
    node = radians(125.04 - 1934.136 * t)
    apparent = mean_longitude + radians(center - 0.00569 - 0.00478 * sin(node))
    seconds = 21.448 - t * (46.8150 + t * (0.00059 - 0.001813 * t))
    obliquity = radians(23.0 + (26.0 + seconds / 60.0) / 60.0 + 0.00256 * cos(node))
    declination = asin(sin(obliquity) * sin(apparent))
    y = tan(obliquity / 2) ** 2
    equation = (
        y * sin(2 * mean_longitude)
        - 2 * eccentricity * sin(anomaly)
        + 4 * eccentricity * y * sin(anomaly) * cos(2 * mean_longitude)
        - 0.5 * y * y * sin(4 * mean_longitude)
        - 1.25 * eccentricity * eccentricity * sin(2 * anomaly)
    )
    return declination, 4.0 * degrees(equation)


def solar_position(
    latitude: float, longitude: float, when: datetime, *, refraction: bool = True
) -> tuple[float, float]:
    """Return the sun's elevation and azimuth.

    Parameters
    ----------
    latitude, longitude
        Degrees, north and east positive.
    when
        The moment; it must have a time zone.
    refraction
        Whether the air lifts the sun, as one sees it.

    Returns
    -------
    elevation, azimuth
        Radians; azimuth clockwise from north, in [0, 2 pi).
    """
    declination, equation = sun_coordinates(when)
    utc = when.astimezone(UTC)
    minutes = utc.hour * 60.0 + utc.minute + (utc.second + utc.microsecond / 1e6) / 60.0
    hour_angle = radians((minutes + equation + 4.0 * longitude) / 4.0 - 180.0)
    phi = radians(latitude)
    up = sin(phi) * sin(declination) + cos(phi) * cos(declination) * cos(hour_angle)
    elevation = pi / 2 - acos(max(-1.0, min(1.0, up)))
    azimuth = atan2(
        -cos(declination) * sin(hour_angle),
        cos(phi) * sin(declination) - sin(phi) * cos(declination) * cos(hour_angle),
    )
    if refraction:
        elevation += _refraction(elevation)
    return elevation, azimuth % (2 * pi)


def _refraction(elevation: float) -> float:
    """Atmospheric refraction after NOAA's piecewise fit, radians."""
    h = degrees(elevation)
    if h > 85.0:
        return 0.0
    slope = tan(elevation)
    if h > 5.0:
        seconds = 58.1 / slope - 0.07 / slope**3 + 0.000086 / slope**5
    elif h > -0.575:
        seconds = 1735.0 + h * (-518.2 + h * (103.4 + h * (-12.79 + h * 0.711)))
    else:
        seconds = -20.774 / slope
    return radians(seconds / 3600.0)


def hour_of_elevation(latitude: float, elevation: float, when: datetime, *, rising: bool) -> float:
    """Return the solar hour (12 = the sun due south or north) at which it stands at an elevation.

    Where the sun never gets there that day, the hour of its nearest pass is returned.
    """
    declination, _ = sun_coordinates(when)
    phi = radians(latitude)
    scale = cos(phi) * cos(declination)
    cosine = (sin(elevation) - sin(phi) * sin(declination)) / max(scale, 1e-9)
    hours = degrees(acos(max(-1.0, min(1.0, cosine)))) / 15.0
    return 12.0 - hours if rising else 12.0 + hours
