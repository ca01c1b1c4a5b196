"""Parking: bays, parked cars, lanes of parking along kerbs."""
