"""Planning: from a brief and a state to the actions that bring about what is asked for."""
