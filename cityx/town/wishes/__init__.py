"""Actions that make a layout meet a wish: a river, a park, a number of towers."""
