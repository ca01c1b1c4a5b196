"""Shopfronts, signs, lettering and the rooms behind the panes."""
