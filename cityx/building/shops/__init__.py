"""Shops: names, signs and shopfronts on ground floors."""
