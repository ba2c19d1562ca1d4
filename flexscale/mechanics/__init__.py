"""Energies as pure functions of world vectors; nothing here knows of periodicity or curvature."""
