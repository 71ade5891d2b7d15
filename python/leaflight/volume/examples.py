# SPDX-License-Identifier: GPL-3.0-or-later
"""Six examples for a first try. They are computed, so nothing is downloaded or licensed.

bake = leaflight.bake(leaflight.examples.load("neuron"))
"""

from collections.abc import Callable
from dataclasses import dataclass

from .particles import hydrogen, lapr, neuron, nucleons
from .setting_error import SettingError
from .volume import Volume, bump_box

# Number of nodes along each axis.
NODES = 96


@dataclass(frozen=True)
class Example:
    """An example: its label, a sentence about it, and the function that computes it by its size."""

    label: str
    text: str
    make: Callable[[int], Volume]


EXAMPLES = {
    "hydrogen": Example(
        "Hydrogen Atom", "The electron in the state 3d: two lobes and a ring", hydrogen
    ),
    "neuron": Example("Neuron", "A cell with branching dendrites", neuron),
    "protons": Example(
        "Nuclei", "Protons in the crust of a neutron star", lambda n: nucleons(n)[0]
    ),
    "particle": Example("Particle", "A dirt particle of dented outline", lambda n: lapr(n)[0]),
    "water": Example("Splash", "Water that a laser pulse throws up", lambda n: lapr(n)[1]),
    "bump_box": Example("Bump Box", "The reference volume of the thesis", bump_box),
}


def load(name: str, nodes: int = NODES) -> Volume:
    """Returns the Volume of an example by its key in EXAMPLES. Raises LeaflightError.

    nodes: Number of nodes along each axis.
    """
    if name not in EXAMPLES:
        raise SettingError(
            f'There is no example "{name}": choose one of {", ".join(EXAMPLES)}.', "name"
        )
    return EXAMPLES[name].make(nodes)
