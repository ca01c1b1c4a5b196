"""A questionnaire for people: pictures without names, in an order of their own, rated 1 to 5."""
