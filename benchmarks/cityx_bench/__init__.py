"""The benchmark: tasks in words, drivers that solve them, and their rates of success."""
