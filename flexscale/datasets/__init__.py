"""Labelled results on disk: schemas, identity, atomic writing, and queries.

A side tower on floor 0: reading results needs neither gmsh nor numba.
"""
