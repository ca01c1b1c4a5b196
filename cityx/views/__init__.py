"""Views: where cameras stand, and what they see."""
