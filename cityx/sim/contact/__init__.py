"""The contact engine: robots of a user's own in MuJoCo, in a window of a city that goes with them.

>>> from cityx.sim.contact.window import ContactWindow
>>> window = ContactWindow("soho", "robot.xml", at=(12.0, 40.0))  # doctest: +SKIP
>>> window.step([1.0, 1.0])  # doctest: +SKIP
"""
