"""Where cameras stand, and what they see."""
