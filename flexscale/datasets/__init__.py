"""Labelled results on disk: schemas, identity, atomic writing, and queries.

A side tower on floor 0: reading results needs neither gmsh nor numba.
"""

import os

# HDF5 locks its files by `flock`, which some shared disks do not have. None of ours is ever written
# in place or by two.
os.environ.setdefault("HDF5_USE_FILE_LOCKING", "FALSE")
