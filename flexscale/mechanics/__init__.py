"""Energies as pure functions of world vectors, and their assembly; nothing here knows of periodicity or curvature."""
