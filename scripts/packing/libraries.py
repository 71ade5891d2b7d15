# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds the libraries of the core for another system: static, with the versions of Debian 12.

The sources are those of Debian, so that all systems have the same code. They are built once for
each system.
"""

import hashlib
import os
import shutil
from dataclasses import dataclass, field
from pathlib import Path

from .tools import ROOT, PackageError, digest, run

HERE = Path(__file__).parent
SOURCES = ROOT / "build" / "sources"
# Debian packages of headers, which need no build.
_HEADERS = ("boost", "nanoflann.hpp")
# Options that disable geometry of Embree that mesh_bvh.cpp does not use.
_UNUSED = ("CURVE", "SUBDIVISION", "USER", "INSTANCE", "GRID", "POINT")


@dataclass(frozen=True)
class Target:
    """A system and a processor.

    work: Folder of all builds.
    toolchain: Toolchain file of CMake, which finds the libraries in `prefix`.
    options: Options of CMake for this system alone, by the package of the library.
    headers: Further packages of headers in Debian.
    """

    name: str
    work: Path
    toolchain: Path
    options: dict[str, tuple[str, ...]] = field(default_factory=dict)
    headers: tuple[str, ...] = ()

    @property
    def prefix(self):
        return self.work / "libraries"


@dataclass(frozen=True)
class Library:
    """A library to build.

    package: Source package of Debian.
    archive: Archive of the authors' sources, unpacked into `folder`.
    """

    package: str
    archive: str
    sha256: str
    folder: str
    options: tuple[str, ...]
    cmake: str = "."  # folder of CMakeLists.txt in `folder`
    patch: str = ""  # a patch in the folder of this file


# Each library follows those that it needs.
LIBRARIES = (
    Library(
        "onetbb",
        "onetbb_2021.8.0.orig.tar.xz",
        "7e9111b8bb59c8800bf6d0b06afe7b0891937443d2dae1ee1101c8e2ede6a7ef",
        "oneTBB-2021.8.0",
        ("TBB_TEST=OFF", "TBB_STRICT=OFF", "TBBMALLOC_BUILD=OFF"),
    ),
    Library(
        "imath",
        "imath_3.1.6.orig.tar.gz",
        "ea5592230f5ab917bea3ceab266cf38eb4aa4a523078d46eac0f5a89c52304db",
        "Imath-3.1.6",
        ("BUILD_TESTING=OFF",),
    ),
    Library(
        "openexr",
        "openexr_3.1.5.orig.tar.gz",
        "93925805c1fc4f8162b35f0ae109c4a75344e6decae5a240afdfce25f8a433ec",
        "openexr-3.1.5",
        ("BUILD_TESTING=OFF", "OPENEXR_BUILD_TOOLS=OFF", "OPENEXR_INSTALL_EXAMPLES=OFF"),
    ),
    Library(
        "lz4",
        "lz4_1.9.4.orig.tar.gz",
        "0b0e3aa07c8c063ddf40b082bdf7e37a1562bda40a0ff5272957f3e987e0e54b",
        "lz4-1.9.4",
        ("LZ4_BUILD_CLI=OFF", "LZ4_BUILD_LEGACY_LZ4C=OFF", "BUILD_STATIC_LIBS=ON"),
        "build/cmake",
    ),
    # OpenVDB uses only LZ4 of Blosc.
    Library(
        "c-blosc",
        "c-blosc_1.21.3+ds.orig.tar.xz",
        "36a5ca0904135be7b6da02cc93adda2e34fec98286b28172e166f8cad79c8fab",
        "c-blosc-1.21.3",
        (
            *("BUILD_SHARED=OFF", "BUILD_TESTS=OFF", "BUILD_BENCHMARKS=OFF", "BUILD_FUZZERS=OFF"),
            *("DEACTIVATE_SNAPPY=ON", "DEACTIVATE_ZLIB=ON", "DEACTIVATE_ZSTD=ON"),
            "PREFER_EXTERNAL_LZ4=ON",
        ),
    ),
    # Disable delayed loading, which would need a library of Boost.
    Library(
        "openvdb",
        "openvdb_10.0.1.orig.tar.xz",
        "776706ca285a43b53e24c28d8f8b2112aea3dbf94c3c5f399cf6ff43403f5ace",
        "openvdb-10.0.1",
        (
            *("OPENVDB_CORE_SHARED=OFF", "OPENVDB_BUILD_BINARIES=OFF", "USE_CCACHE=OFF"),
            *("OPENVDB_USE_DELAYED_LOADING=OFF", "USE_EXPLICIT_INSTANTIATION=OFF"),
            *("OPENVDB_ENABLE_UNINSTALL=OFF", "OPENVDB_DISABLE_BOOST_IMPLICIT_LINKING=OFF"),
            "OPENVDB_INSTALL_CMAKE_MODULES=OFF",
        ),
    ),
    # Build for one instruction set that every processor has. With several, the linker might take
    # the AVX copy of a shared function. The patch lets GCC build a static library for Windows, and
    # removes the version of macOS that Embree sets.
    Library(
        "embree",
        "embree_3.13.5+dfsg.orig.tar.xz",
        "1b7c5b6144230ad81b92ece884a2017fbbb433bf5416a6fca9257e0109501c63",
        "embree-3.13.5",
        (
            *("EMBREE_STATIC_LIB=ON", "EMBREE_ISPC_SUPPORT=OFF", "EMBREE_TUTORIALS=OFF"),
            *("EMBREE_RAY_MASK=ON", "EMBREE_RAY_PACKETS=OFF"),
            *("EMBREE_MAX_ISA=NONE", "EMBREE_ISA_SSE2=ON"),
            *(f"EMBREE_ISA_{isa}=OFF" for isa in ("SSE42", "AVX", "AVX2", "AVX512", "NEON2X")),
            *(f"EMBREE_GEOMETRY_{kind}=OFF" for kind in _UNUSED),
        ),
        patch="embree.patch",
    ),
)


def build(target):
    """Builds all libraries that are missing in the target's prefix."""
    (target.prefix / "include").mkdir(parents=True, exist_ok=True)
    for name in (*_HEADERS, *target.headers):
        link = target.prefix / "include" / name
        if not link.is_symlink():
            link.symlink_to(Path("/usr/include") / name)
    modules = target.prefix / "lib" / "cmake" / "OpenVDB"
    modules.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(HERE / "FindOpenVDB.cmake", modules / "FindOpenVDB.cmake")
    beside = target.toolchain.parent
    needs = digest(*sorted((*HERE.glob("*.patch"), *beside.glob("*.cmake"), *beside.glob("*.txt"))))
    for library in LIBRARIES:
        # A library depends on all libraries before it.
        options = target.options.get(library.package, ())
        needs = hashlib.sha256(f"{needs} {library} {options}".encode()).hexdigest()
        stamp = target.work / f"{library.package}.stamp"
        if stamp.exists() and stamp.read_text() == needs:
            continue
        print(f"scripts/package: building {library.folder} for {target.name}", flush=True)
        _build(library, target)
        stamp.write_text(needs)


def _build(library, target):
    source = _source(library, target) / library.cmake
    folder = target.work / "build" / library.package
    shutil.rmtree(folder, ignore_errors=True)
    shared = (
        *(f"CMAKE_TOOLCHAIN_FILE={target.toolchain}", "CMAKE_BUILD_TYPE=Release"),
        *(f"CMAKE_INSTALL_PREFIX={target.prefix}", "BUILD_SHARED_LIBS=OFF"),
        *(f"TBB_ROOT={target.prefix}", f"Blosc_ROOT={target.prefix}"),
    )
    of_target = target.options.get(library.package, ())
    options = (f"-D{option}" for option in (*shared, *library.options, *of_target))
    run("cmake", "-G", "Ninja", "-S", source, "-B", folder, *options)
    run("cmake", "--build", folder, "--target", "install", "--parallel", os.cpu_count())
    shutil.rmtree(folder)


def _source(library, target):
    """Returns the unpacked sources; downloads the archive once."""
    archive = SOURCES / library.archive
    SOURCES.mkdir(parents=True, exist_ok=True)
    if not archive.exists():
        run("apt-get", *_apt_options(), "source", "--tar-only", "--download-only", library.package,
            cwd=SOURCES)  # fmt: skip
    if not archive.exists() or digest(archive) != library.sha256:
        raise PackageError(
            f"Debian's source package {library.package} is not {library.archive} with the known "
            f"checksum; look into {SOURCES} and set the new version in {Path(__file__).name}."
        )
    folder = target.work / "sources"
    folder.mkdir(parents=True, exist_ok=True)
    unpacked = folder / library.folder
    shutil.rmtree(unpacked, ignore_errors=True)
    run("tar", "--extract", "--file", archive, "--directory", folder)
    if library.patch:
        run("patch", "--strip=1", "--input", HERE / library.patch, cwd=unpacked)
    return unpacked


def _apt_options():
    """Returns options with which apt-get uses lists of source packages in a separate folder.

    The sources are those of this machine's binary packages, in the same order.
    """
    folder = SOURCES / "apt"
    one, parts = folder / "sources.list", folder / "sources.list.d"
    options = (
        *("-o", f"Dir::State::Lists={folder / 'lists'}", "-o", f"Dir::Etc::SourceList={one}"),
        *("-o", f"Dir::Etc::SourceParts={parts}", "-o", "APT::Sandbox::User=root"),
    )
    if not any((folder / "lists").glob("*Sources*")):
        for made in (parts, folder / "lists" / "partial"):
            made.mkdir(parents=True, exist_ok=True)
        etc = Path("/etc/apt")
        for path in (etc / one.name, *(etc / parts.name).iterdir()):
            if path.suffix in (".list", ".sources") and path.is_file():
                (folder / path.relative_to(etc)).write_text(_of_sources(path.read_text()))
        run("apt-get", *options, "update")
    return options


def _of_sources(text):
    """Converts apt's sources of binary packages to those of source packages, in both formats."""
    lines = []
    for line in text.splitlines():
        if line.startswith("Types:"):
            line = "Types: deb-src"
        elif line.startswith("deb "):
            line = f"deb-src {line[4:]}"
        lines.append(line)
    return "\n".join(lines) + "\n"
