# SPDX-License-Identifier: GPL-3.0-or-later
"""Plausible bugs, introduced one at a time into a copy of the core, and the tests that catch them.

    validation/run mutations [NAME ...]

Builds each mutant in build/mutations and runs the core's tests there until the first that fails.
The test that caught it last comes first, then the short suite, then what `--all` adds.
Prints a row of a table for each; exits with 1 if one survives.
"""

import argparse
import os
import re
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
WORK = ROOT / "build" / "mutations"


@dataclass(frozen=True)
class Mutation:
    """A bug: `right`, which stands once in a file below core/, becomes `wrong`.

    test: the one that caught it last.
    """

    name: str
    file: str
    right: str
    wrong: str
    test: str


MUTATIONS = (
    Mutation(
        "missing cosine of shading",
        "src/transport/light_sampler.cpp",
        "static_cast<Real>(cosine / (projected_hemisphere<D> * picked.probability))",
        "static_cast<Real>(1 / (projected_hemisphere<D> * picked.probability))",
        "Flatland.DirectLightOfASegmentHasTheClosedForm",
    ),
    Mutation(
        "wrong pdf: a light's area counted twice",
        "src/lights/area_light.cpp",
        "static_cast<Real>(cosine * area() / spread<D>(distance))",
        "static_cast<Real>(cosine * 2 * area() / spread<D>(distance))",
        "Flatland.DirectLightOfASegmentHasTheClosedForm",
    ),
    Mutation(
        "swapped sides of the isosurface",
        "src/trace/scene_tracer.cpp",
        "const double side = back ? 1 : -1;",
        "const double side = back ? -1 : 1;",
        "FixedSamples.DependOnTheSeed",
    ),
    Mutation(
        "missing 1 / kappa of the clipped sphere (thesis Eq. 4.10)",
        "thesis/density_region.cpp",
        "return (below(high) - below(low)) / kappa;",
        "return below(high) - below(low);",
        "NumericsUnits.DimLightChangesNothing",
    ),
    Mutation(
        "texels off by a half",
        "src/field/texel_lattice.h",
        "static_cast<int>(position[a] + 0.5), 0, resolution[a] - 1);",
        "static_cast<int>(position[a]), 0, resolution[a] - 1);",
        "NumericsVolumes.PhotonsInAnyTransform",
    ),
    Mutation(
        "gradients transformed as directions are",
        "src/transport/isosurface_cache.cpp",
        "mean.value += share * frame_to_index.pull_back_gradient(gradient).length();",
        "mean.value += share * frame_to_index.vector(gradient).length();",
        "NumericsVolumes.PhotonsInAnyTransform",
    ),
    Mutation(
        "Russian roulette without its weight",
        "src/transport/photon_tracer.cpp",
        "random.uniform() < survival ? flux_height / survival : Rgb(0)",
        "random.uniform() < survival ? flux_height : Rgb(0)",
        "Flatland.EstimatorsAgreeWithThePathTracer",
    ),
    Mutation(
        "missing n^2 of radiance that is refracted",
        "src/transport/specular.cpp",
        "static_cast<Real>(1 / spread<D>(point.ior))",
        "static_cast<Real>(1)",
        "Reciprocity.OfGlass",
    ),
    Mutation(
        "glass seen from inside as from outside",
        "src/trace/scene_tracer.cpp",
        "s.ior = back ? 1 / scene_volume.ior : scene_volume.ior;",
        "s.ior = scene_volume.ior;",
        "Specular.GlassIsDenserFromOutsideThanFromInside",
    ),
    Mutation(
        "a tie counts as below",
        "src/trace/isosurface_ray.cpp",
        "if (state_ == State::unknown) state_ = state_of(p[0] >= 0);",
        "if (state_ == State::unknown) state_ = state_of(p[0] > 0);",
        "NumericsRays.TiesFollowTheRuleOnEdges",
    ),
    Mutation(
        "missing factor of shading normals",
        "src/transport/photon_tracer.cpp",
        "return shading > 0 && geometric > 0 ? shading / geometric : 0;",
        "return shading > 0 && geometric > 0 ? 1 : 0;",
        "Reciprocity.OfPhotonsAndPaths",
    ),
    Mutation(
        "direct light of photons counted beside that of shadow rays",
        "src/transport/isosurface_cache.cpp",
        "if (photon.arrival == Arrival::direct && side.contents == SideContents::indirect) return;",
        "",
        "Flatland.EstimatorsAgreeWithThePathTracer",
    ),
    Mutation(
        "albedo applied twice at the end of a gather ray",
        "src/transport/surface_cache.cpp",
        "albedo += point.albedo;",
        "albedo += point.albedo * point.albedo;",
        "Flatland.EstimatorsAgreeWithThePathTracer",
    ),
    Mutation(
        "interpolation with the weights of the other corner",
        "src/field/texel_lattice.cpp",
        "double low = 1 - local[0], high = local[0];",
        "double low = local[0], high = 1 - local[0];",
        "DirectLightOfIsosurfaces.HasThemInThePlane",
    ),
    Mutation(
        "an isosurface shadows itself",
        "src/bake/direct/visibility_sweep.cpp",
        "if (q - delay_ >= first) pass(q - delay_);",
        "if (q >= first) pass(q);",
        "DirectLightOfIsosurfaces.HasThoseOfMeshes",
    ),
    Mutation(
        "shadows beside lines that are not halved",
        "src/bake/direct/visibility_sweep.cpp",
        "fan.step /= 2;\n    fan.cover(",
        "fan.cover(",
        "DirectLightOfIsosurfaces.HasThemInThePlane",
    ),
    Mutation(
        "a way that goes on beyond its end",
        "src/trace/greatest_value.cpp",
        "if (!(out < end)) return;",
        "if (!(t <= end)) return;",
        "GreatestValue.LeavesOutCellsWithoutData",
    ),
    Mutation(
        "walls without shadows of isosurfaces",
        "src/bake/walls/mesh_direct_light.cpp",
        "if (ray.greatest < isovalue || passes) lit += light;",
        "if (ray.greatest < isovalue || std::isfinite(ray.greatest) || passes) lit += light;",
        "MeshDirectLight.KnowsShadowsOfAllVolumes",
    ),
)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help="parts of names (all)")
    names = parser.parse_args().names
    chosen = [m for m in MUTATIONS if not names or any(name in m.name for name in names)]
    copy_tree()
    print("| bug | in | caught by |\n|---|---|---|")
    survived = [m.name for m in chosen if not caught(m)]
    if survived:
        sys.exit(f"no test caught: {', '.join(survived)}.")


def copy_tree():
    """Copies the tracked files with their uncommitted changes; keeps built files."""
    listed = subprocess.run(
        ["git", "ls-files", "-z"], cwd=ROOT, check=True, capture_output=True, text=True
    )
    for name in filter(None, listed.stdout.split("\0")):
        source, target = ROOT / name, WORK / name
        target.parent.mkdir(parents=True, exist_ok=True)
        if source.is_symlink():
            if not target.is_symlink():
                target.symlink_to(os.readlink(source))
        elif not target.exists() or source.read_bytes() != target.read_bytes():
            shutil.copyfile(source, target)
    tools = WORK / "build" / "venv"
    if not tools.exists():
        tools.parent.mkdir(exist_ok=True)
        tools.symlink_to(ROOT / "build" / "venv")
    subprocess.run(["cmake", "--preset", "tests"], cwd=WORK, check=True, capture_output=True)


def caught(mutation):
    """Builds with the bug and returns true if a test fails; the named test runs first."""
    path = WORK / "core" / mutation.file
    text = path.read_text()
    if text.count(mutation.right) != 1:
        sys.exit(f"{mutation.file} does not hold {mutation.right!r} once.")
    path.write_text(text.replace(mutation.right, mutation.wrong))
    try:
        build = ["cmake", "--build", "--preset", "tests"]
        built = subprocess.run(build, cwd=WORK, capture_output=True, text=True)
        if built.returncode != 0:
            sys.exit(f"{mutation.name}: this does not build:\n{built.stdout}")
        test = first_failure("short", f"^{re.escape(mutation.test)}$")
        test = test or first_failure("short") or first_failure("slow")
    finally:
        path.write_text(text)
    print(f"| {mutation.name} | `{mutation.file}` | {test or '**nothing**'} |", flush=True)
    return test is not None


def first_failure(preset, names="."):
    """Returns the first failing test of a ctest preset with a matching name; None if all pass."""
    # A bug may make a test run forever.
    command = ["ctest", "--preset", preset, "-R", names, "--stop-on-failure", "--timeout", "600"]
    run = subprocess.run(command, cwd=WORK, capture_output=True, text=True)
    failed = re.findall(r"^\s+\d+ - (\S+) \((.+)\)$", run.stdout, re.MULTILINE)
    if run.returncode and not failed:
        sys.exit(f"ctest itself failed:\n{run.stdout}{run.stderr}")
    names = [f"`{name}`{' (--all)' if preset == 'slow' else ''}" for name, _ in failed]
    return names[0] if names else None
