"""Who decides what runs: workflows, the journal and the run loop."""
