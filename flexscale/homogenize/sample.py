"""One sample of a line: numbers of an equilibrium, and what the next one starts from."""

from __future__ import annotations

from typing import TypedDict

from flexscale.arrays import FloatArray


class Sample(TypedDict, total=False):
    """What `line.follow_line` yields, a checkpoint keeps and a sweep's dataset is made of.

    Every sample has curvature and status; the others are there if it converged, those of contact if
    scales can touch. Energies are per rest area, N mm-1; a native model has some of the parts.
    """

    curvature: float  # mm-1
    status: int  # `status.SolveStatus`
    newton_iterations: int
    energy_density: float
    energy_density_membrane: float
    energy_density_bending: float
    energy_density_solid: float
    energy_density_scales: float
    energy_density_joints: float
    energy_density_contact: float
    moment: float  # N, derivative of the energy density by the magnitude of the curvature
    moment_xx: float  # N, derivatives by k_xx, k_yy and 2 k_xy, along rays of tensors
    moment_yy: float
    moment_xy: float
    membrane_force_xx: float  # N mm-1, of a lattice that is held; likewise
    membrane_force_yy: float
    membrane_force_xy: float
    stretch: FloatArray  # (3,) F of the lattice: xx, yy, xy
    residual_norm: float  # N
    mean_offset: float  # mm
    negative_eigenvalues: int
    saddles_left: int
    outside_range: int  # stations of joints beyond their law's range
    min_gap: float  # mm
    contact_pairs: int
    contact_force: float  # N
    barrier_stiffness: float  # N mm-3
    energy_density_returning: float  # of the equilibrium met on the way back
    moment_returning: float
    state: FloatArray  # (n_unknowns,) z
    rate: FloatArray  # dz/d|kappa|
    second_rate: FloatArray  # its change since the state before, per |kappa|
