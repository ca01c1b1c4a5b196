"""Parcels as a source: what stands on the plots of a town, as tagged shapes."""
