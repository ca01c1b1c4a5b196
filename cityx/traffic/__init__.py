"""Traffic by SUMO: the network as SUMO has it, its simulation, its files."""
