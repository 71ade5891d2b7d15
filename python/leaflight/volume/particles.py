# SPDX-License-Identifier: GPL-3.0-or-later
"""Densities of particles in the unit cube, in place of the thesis's data, which are not public.

They are of the same kind (thesis 5.1): seeded sets of particles. Each set is convolved with a
    Gaussian into a density, scaled to 0..255. The electron of a hydrogen atom is an example of very
    smooth data.
"""

import numpy as np

from ..arrays import Array
from .volume import Volume, on_unit_cube

# Cutoff radius of a Gaussian, in standard deviations.
KERNEL_REACH = 4.0
# Number of molecules in a droplet of radius 1.
DROPLET_DENSITY = 1_500_000
# Half the side of the box around the hydrogen atom, in Bohr radii: 98 % of the density is in it.
HYDROGEN_REACH = 20.0


def nucleons(n: int = 101) -> list[Volume]:
    """Returns protons and neutrons in the crust of a neutron star: two Volumes of n^3 nodes.

    Nuclei have irregular, elongated shapes, and some are joined. Both kinds are mixed in them. A
    thin gas of neutrons surrounds them.
    """
    protons, neutrons = _nucleon_positions()
    return [
        _density("nucleons:0", "protons", protons, 0.02, n),
        _density("nucleons:1", "neutrons", neutrons, 0.02, n),
    ]


def _nucleon_positions() -> tuple[Array, Array]:
    rng = np.random.default_rng(1)
    candidates = []
    for center in _scattered(rng.uniform(0.15, 0.85, (2000, 3)), distance=0.18)[:22]:
        axes = rng.uniform(0.05, 0.13, 3)
        candidates.append(center + _ball(rng, 200) @ (_rotation(rng) * axes).T)
    # Nucleons repel each other.
    nuclei = _scattered(np.concatenate(candidates), distance=0.026)
    gas = _scattered(rng.uniform(0.07, 0.93, (200, 3)), distance=0.08)
    is_proton = rng.random(len(nuclei)) < 0.45
    return nuclei[is_proton], np.concatenate([nuclei[~is_proton], gas])


def lapr(n: int = 120) -> list[Volume]:
    """Returns a dirt particle and the water that lifts it: laser-assisted particle removal.

    Two Volumes of n^3 nodes. The wet surface is the bottom of the cube, z = 0.
    """
    rng = np.random.default_rng(2)
    center, radius = np.array([0.5, 0.5, 0.6]), 0.2
    # Atoms on a lattice, in a ball with a dented outline.
    lattice = _lattice(radius, spacing=0.042) @ _rotation(rng).T
    dents = _directions(rng, 9)
    outline = radius * (1 - 0.3 * (_unit(lattice) @ dents.T > 0.8).any(axis=1))
    dirt = center + lattice[np.linalg.norm(lattice, axis=1) < outline]
    dirt += rng.normal(0, 0.004, dirt.shape)

    water = np.concatenate([_film(rng, 18_000), _plume(rng, 200)])
    water = water[np.linalg.norm(water - center, axis=1) > radius + 0.03]
    water = water[((water > 0.05) & (water < 0.95)).all(axis=1)]
    return [
        _density("lapr:0", "dirt", dirt, 0.024, n),
        _density("lapr:1", "water", water, 0.016, n),
    ]


def _film(rng: np.random.Generator, count: int) -> Array:
    """Returns water left on the surface, thinner near the explosion in the middle."""
    points = rng.uniform((0.06, 0.06, 0.0), (0.94, 0.94, 1.0), (count, 3))
    distance = np.linalg.norm(points[:, :2] - 0.5, axis=1)
    points[:, 2] = 0.07 + 0.08 * points[:, 2] * np.minimum(1, distance / 0.3)
    left: Array = points[rng.random(count) < np.minimum(1, distance / 0.3)]
    return left


def _plume(rng: np.random.Generator, droplets: int) -> Array:
    """Returns droplets that fly up and away from below the particle; faster ones are smaller."""
    directions = _directions(rng, droplets)
    directions[:, 2] = np.abs(directions[:, 2]) + 0.25
    speeds = rng.uniform(0.15, 0.85, (droplets, 1))
    centers = (0.5, 0.5, 0.12) + speeds * _unit(directions)
    radii = rng.uniform(0.02, 0.05, (droplets, 1)) * (1.3 - speeds)
    return np.concatenate(
        [
            center + radius * _ball(rng, int(DROPLET_DENSITY * radius**3))
            for center, radius in zip(centers, radii[:, 0])
        ]
    )


def neuron(n: int = 150) -> Volume:
    """Returns a neuron with branching dendrites: a mostly empty Volume of n^3 nodes."""
    return _density("neuron", "neuron", _neuron_positions(), 0.014, n)


def _neuron_positions() -> Array:
    rng = np.random.default_rng(3)
    center = np.array([[0.5, 0.45, 0.5]])
    points = [center + 0.06 * _ball(rng, 250)]
    ends = [(center, direction[None]) for direction in _directions(rng, 7)]
    for _ in range(3):
        growing, ends = ends, []
        for position, direction in growing:
            for _ in range(int(rng.uniform(20, 50))):
                direction = _unit(direction + 0.12 * rng.normal(size=(1, 3)))
                position = position + 0.005 * direction
                points.append(position)
            fork = 0.5 * rng.normal(size=(1, 3))
            ends += [(position, _unit(direction + fork)), (position, _unit(direction - fork))]
    positions = np.concatenate(points)
    kept: Array = positions[(np.abs(positions - 0.5) < 0.44).all(axis=1)]
    return kept


def hydrogen(n: int = 64) -> Volume:
    """Returns the electron of a hydrogen atom in the state 3d_z2, a Volume of n^3 nodes.

    Values are the probability density |psi_320|^2 over its maximum, 0..1. Two lobes lie along z,
    and a ring of a quarter of their height surrounds them.
    """
    return on_unit_cube(n, _electron_3d, "hydrogen", "hydrogen")


def _electron_3d(n: int) -> Array:
    """Returns psi_320 = r^2 exp(-r/3) (3 cos^2 theta - 1) / (81 sqrt(6 pi)), r in Bohr radii.

    Griffiths, Introduction to Quantum Mechanics, Tables 4.3 and 4.7.
    """
    x = np.linspace(-HYDROGEN_REACH, HYDROGEN_REACH, n)
    z, y, x = np.meshgrid(x, x, x, indexing="ij")
    squares = x**2 + y**2 + z**2
    psi = (3 * z**2 - squares) * np.exp(-np.sqrt(squares) / 3)
    # The maximum is on the axis at r = 6.
    highest = 2 * 6**2 * np.exp(-2.0)
    density: Array = ((psi / highest) ** 2).astype(np.float32)
    return density


def _density(source: str, name: str, particles: Array, sigma: float, n: int) -> Volume:
    """Returns the particles (m, 3) convolved with a Gaussian: a Volume with values 0..255."""
    return on_unit_cube(n, lambda n: _convolved(particles, sigma, n), name, source)


def _convolved(particles: Array, sigma: float, n: int) -> Array:
    nodes = np.linspace(0, 1, n)
    values = np.zeros((n, n, n))
    reach = KERNEL_REACH * sigma
    for particle in particles:
        window, factors = [], []
        # Arrays are indexed [z, y, x].
        for position in particle[::-1]:
            first, last = np.searchsorted(nodes, (position - reach, position + reach))
            window.append(slice(first, last))
            factors.append(np.exp(-0.5 * ((nodes[first:last] - position) / sigma) ** 2))
        z, y, x = factors
        values[tuple(window)] += z[:, None, None] * y[:, None] * x
    scaled: Array = (values * (255.0 / values.max())).astype(np.float32)
    return scaled


def _scattered(candidates: Array, distance: float) -> Array:
    """Returns the points (n, 3) that keep the distance to all earlier ones."""
    points = np.empty_like(candidates)
    count = 0
    for candidate in candidates[((candidates > 0.06) & (candidates < 0.94)).all(axis=1)]:
        squares = ((points[:count] - candidate) ** 2).sum(axis=1)
        if (squares >= distance**2).all():
            points[count] = candidate
            count += 1
    return points[:count]


def _lattice(radius: float, spacing: float) -> Array:
    """Returns the points of a face-centered cubic lattice in a ball around the origin."""
    steps = int(2 * radius / spacing) + 1
    i, j, k = np.mgrid[-steps : steps + 1, -steps : steps + 1, -steps : steps + 1].reshape(3, -1)
    points = 0.5 * spacing * np.stack([i + j, i + k, j + k], axis=1)
    within: Array = points[np.linalg.norm(points, axis=1) < radius]
    return within


def _ball(rng: np.random.Generator, count: int) -> Array:
    """Returns points (count, 3), uniformly distributed in the unit ball."""
    points: Array = _directions(rng, count) * np.cbrt(rng.random((count, 1)))
    return points


def _directions(rng: np.random.Generator, count: int) -> Array:
    return _unit(rng.normal(size=(count, 3)))


def _unit(vectors: Array) -> Array:
    directions: Array = vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-12)
    return directions


def _rotation(rng: np.random.Generator) -> Array:
    """Returns a random orthogonal matrix (3, 3)."""
    matrix: Array = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    return matrix
