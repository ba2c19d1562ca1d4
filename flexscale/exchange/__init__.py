"""Files for other people's simulators: stiffness, tables, code, and sections of shells."""
