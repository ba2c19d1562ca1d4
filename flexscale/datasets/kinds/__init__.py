"""Every kind of dataset is one room: its table, its check, and how it is built from arrays."""
