"""Conversions between the formats of the protocol."""
