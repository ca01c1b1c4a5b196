"""The benchmark: tasks in words, who solves them, and how often that succeeds."""
