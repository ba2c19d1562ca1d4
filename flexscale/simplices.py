"""Numbering of nodes on quadratic simplices, in VTK's order."""

#: Corner pairs of the nodes 4 to 9 of a quadratic tet.
TET_EDGES = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))

#: Corner pairs of the nodes 3 to 5 of a quadratic triangle.
TRIANGLE_EDGES = ((0, 1), (1, 2), (2, 0))
