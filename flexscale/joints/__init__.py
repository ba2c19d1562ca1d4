"""The joint between two scales: its cross-section as a solid, and the law fitted to it."""
