"""The bridge: environments that are stepped by other processes, by messages over a socket."""
