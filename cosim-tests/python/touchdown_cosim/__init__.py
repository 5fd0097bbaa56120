"""FMPy master of the lander: executes cosim-tests/schedule.toml on the two FMUs."""
