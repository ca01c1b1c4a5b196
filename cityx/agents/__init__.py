"""Agents: roles that decide which actions run, plans, the journal and the run loop."""
