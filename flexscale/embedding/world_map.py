"""World vectors as combinations of image vectors, with first and second derivatives in the
unknowns.

Row r of the world vectors is

    y_r = sum_t (c0_t + p_r c1_t + q_r c2_t) X_t

over its terms t, X_t the image vectors of `curvature_map`. A free vertex or gradient is one term
with c0 = 1. Substrate that is bonded to a scale takes several: the barycentric weights of the
scale's base. On an outline the derivative across it keeps its in-plane part free, x_n = F (p nu + q
s) with F the base's deformation gradient: that is where the two unknowns p, q of a row come from
(rest: p = 1, q = 0).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numba import njit

from flexscale.arrays import FloatArray, IntArray
from flexscale.embedding.bends import Bend
from flexscale.embedding.curvature_map import (
    ImageVectors,
    curve_images,
    flat_curvature_rates,
    place_images,
)


@dataclass(frozen=True)
class World:
    """World vectors at a state z, and their first derivatives.

    Attributes
    ----------
    y : (n_rows, 3).
    kappa_rate : (n_rows, 3) dy/dkappa at fixed z.
    jacobian : (n_columns, 3): dy/dz[column], rows of y one after the other (see `WorldMap.indptr`).
    image_x : (n_images, 3) image vectors; image_jacobian : (n_images, 3, 6) in (home, S);
        image_kappa_rate : (n_images, 3).
    """

    y: FloatArray
    kappa_rate: FloatArray
    jacobian: FloatArray
    image_x: FloatArray
    image_jacobian: FloatArray
    image_kappa_rate: FloatArray


class WorldMap:
    """The map z -> y of a periodic cell.

    Parameters
    ----------
    images : image vectors, n of them.
    term_indptr : (n_rows + 1,) terms of each row.
    terms : (n_terms,) image vector of each term; all terms of a row belong to one lattice image.
    weights : (n_terms, 3) c0, c1, c2.
    slide : (n_rows,) index in z of p (q follows), or -1.
    n_unknowns : length of z; its last three entries are S.

    Attributes
    ----------
    indptr : (n_rows + 1,) columns of each row: home unknowns of its terms, then S if shifted, then
        p, q.
    columns : (indptr[-1],) indices into z.
    """

    def __init__(
        self,
        images: ImageVectors,
        term_indptr: IntArray,
        terms: IntArray,
        weights: FloatArray,
        slide: IntArray,
        n_unknowns: int,
    ) -> None:
        self.images = images
        self.term_indptr = term_indptr
        self.terms = terms
        self.weights = weights
        self.slide = slide
        self.n_unknowns = n_unknowns
        self.n_rows = len(slide)
        self.shifted = np.any(images.shifts[terms[term_indptr[:-1]]] != 0.0, axis=1)
        n_columns = 3 * np.diff(term_indptr) + 3 * self.shifted + 2 * (slide >= 0)
        self.indptr = np.concatenate([[0], np.cumsum(n_columns)])
        self.columns = np.empty(self.indptr[-1], dtype=np.int64)
        _fill_columns(
            term_indptr,
            images.nodes[terms],
            self.shifted,
            slide,
            n_unknowns,
            self.indptr,
            self.columns,
        )

    def _image_arguments(self, z: FloatArray, bend: Bend) -> tuple:
        i = self.images
        return (z, bend.curvature, bend.direction, i.kinds, i.nodes, i.shifts, i.anchors)

    def place(self, z: FloatArray, bend: Bend) -> World:
        """World vectors and first derivatives at state z under `bend`."""
        n = len(self.images.kinds)
        x, jacobian, rate = np.empty((n, 3)), np.empty((n, 3, 6)), np.empty((n, 3))
        place_images(*self._image_arguments(z, bend), x, jacobian, rate)
        world = World(
            y=np.zeros((self.n_rows, 3)),
            kappa_rate=np.zeros((self.n_rows, 3)),
            jacobian=np.zeros((self.indptr[-1], 3)),
            image_x=x,
            image_jacobian=jacobian,
            image_kappa_rate=rate,
        )
        _combine(z, x, rate, *self._structure(), world.y, world.kappa_rate)
        _combine_jacobian(
            z, x, jacobian, *self._structure(), self.shifted, self.indptr, world.jacobian
        )
        return world

    def combine(self, z: FloatArray, image_rates: FloatArray) -> FloatArray:
        """(n_rows, 3): the rows' rates for given rates (n_images, 3) of the image vectors."""
        out, unused = np.zeros((self.n_rows, 3)), np.zeros((self.n_rows, 3))
        _combine(z, image_rates, image_rates, *self._structure(), out, unused)
        return out

    def flat_rates(self, z: FloatArray) -> list[FloatArray]:
        """Three (n_rows, 3): derivatives of y at the flat rest state by unit kappa_xx, kappa_yy,
        and kappa_xy."""
        return [self.combine(z, rates) for rates in flat_curvature_rates(self.images, z)]

    def _structure(self) -> tuple:
        return (self.term_indptr, self.terms, self.weights, self.slide)

    def elastic_parts(self, z: FloatArray) -> FloatArray:
        """(0,): no unknown has an energy of its own, all are of world vectors."""
        return np.zeros(0)

    def add_elastic_gradient(self, z: FloatArray, gradient: FloatArray) -> None:
        """As `elastic_parts`."""

    def pull_gradient(self, world: World, forces: FloatArray) -> FloatArray:
        """(n_unknowns,) dE/dz = J^T dE/dy for forces dE/dy (n_rows, 3)."""
        out = np.zeros(self.n_unknowns)
        _pull_gradient(self.indptr, self.columns, world.jacobian, forces, out)
        return out

    def second_order(
        self, z: FloatArray, bend: Bend, world: World, forces: FloatArray
    ) -> SecondOrder:
        """forces . d2y: the part of the pulled-back Hessian that the map itself contributes."""
        image_forces = np.zeros_like(world.image_x)
        _spread(z, forces, *self._structure(), image_forces)
        n = len(image_forces)
        hessian, mixed = np.empty((n, 6, 6)), np.empty((n, 6))
        curve_images(*self._image_arguments(z, bend), image_forces, hessian, mixed)
        return SecondOrder(hessian, mixed)


@dataclass(frozen=True)
class SecondOrder:
    """Second derivatives of the image vectors contracted with forces.

    Attributes
    ----------
    hessian : (n_images, 6, 6) in (home, S).
    mixed : (n_images, 6) in (home, S) and kappa.
    """

    hessian: FloatArray
    mixed: FloatArray

    def positive_part(self) -> SecondOrder:
        """Without directions of negative curvature, image by image."""
        return replace(self, hessian=positive_part(self.hessian))


def positive_part(matrices: FloatArray) -> FloatArray:
    """(n, k, k) symmetric matrices with their negative eigenvalues set to zero."""
    values, modes = np.linalg.eigh(matrices)
    modes *= np.sqrt(np.maximum(values, 0.0))[:, None, :]
    return np.asarray(modes @ np.swapaxes(modes, 1, 2))


@njit(cache=True)
def _fill_columns(term_indptr, term_nodes, shifted, slide, n_unknowns, indptr, columns):
    for r in range(len(slide)):
        k = indptr[r]
        for t in range(term_indptr[r], term_indptr[r + 1]):
            for c in range(3):
                columns[k] = term_nodes[t] + c
                k += 1
        if shifted[r]:
            for c in range(3):
                columns[k] = n_unknowns - 3 + c
                k += 1
        if slide[r] >= 0:
            columns[k] = slide[r]
            columns[k + 1] = slide[r] + 1


@njit(cache=True)
def _weight(z, weights, slide):
    if slide < 0:
        return weights[0]
    return weights[0] + z[slide] * weights[1] + z[slide + 1] * weights[2]


@njit(cache=True)
def _combine(z, x, rate, term_indptr, terms, weights, slide, y, y_rate):
    for r in range(len(slide)):
        for t in range(term_indptr[r], term_indptr[r + 1]):
            w = _weight(z, weights[t], slide[r])
            for c in range(3):
                y[r, c] += w * x[terms[t], c]
                y_rate[r, c] += w * rate[terms[t], c]


@njit(cache=True)
def _combine_jacobian(z, x, jacobian, term_indptr, terms, weights, slide, shifted, indptr, out):
    for r in range(len(slide)):
        k = indptr[r]
        stretch = k + 3 * (term_indptr[r + 1] - term_indptr[r])
        free = stretch + (3 if shifted[r] else 0)
        for t in range(term_indptr[r], term_indptr[r + 1]):
            w = _weight(z, weights[t], slide[r])
            j = jacobian[terms[t]]
            for c in range(3):
                for d in range(3):
                    out[k + d, c] = w * j[c, d]
                    if shifted[r]:
                        out[stretch + d, c] += w * j[c, 3 + d]
                if slide[r] >= 0:
                    out[free, c] += weights[t, 1] * x[terms[t], c]
                    out[free + 1, c] += weights[t, 2] * x[terms[t], c]
            k += 3


@njit(cache=True)
def _pull_gradient(indptr, columns, jacobian, forces, out):
    for r in range(len(forces)):
        for k in range(indptr[r], indptr[r + 1]):
            out[columns[k]] += (
                jacobian[k, 0] * forces[r, 0]
                + jacobian[k, 1] * forces[r, 1]
                + jacobian[k, 2] * forces[r, 2]
            )


@njit(cache=True)
def _spread(z, forces, term_indptr, terms, weights, slide, out):
    for r in range(len(slide)):
        for t in range(term_indptr[r], term_indptr[r + 1]):
            w = _weight(z, weights[t], slide[r])
            for c in range(3):
                out[terms[t], c] += w * forces[r, c]
