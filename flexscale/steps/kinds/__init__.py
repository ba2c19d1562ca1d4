"""Every step is one room: its block, what it takes, how it computes, its figures."""
