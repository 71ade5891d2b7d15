# SPDX-License-Identifier: GPL-3.0-or-later
"""The compiled module: what it was made for, which libraries it takes, what it shows to others."""

import zipfile
from pathlib import Path

import code_signature
import lief
import pytest
from packing.macos import python

SYSTEM = ["/usr/lib/libSystem.B.dylib", "/usr/lib/libz.1.dylib"]
# Library ordinal of a symbol that is looked up in every library of the process.
ANY_LIBRARY = -2


@pytest.fixture(scope="module")
def module(wheel, tmp_path_factory):
    """Unpacks the module and returns its path."""
    with zipfile.ZipFile(wheel.path) as archive:
        return Path(archive.extract(wheel.module, tmp_path_factory.mktemp("module")))


@pytest.fixture(scope="module")
def binary(module):
    processors = lief.MachO.parse(str(module))  # has to outlive the one that is a part of it
    yield processors.at(0)


def test_it_is_for_one_processor_and_macos_11(wheel, module, binary):
    assert lief.MachO.parse(str(module)).size == 1
    kind = {"arm64": lief.MachO.Header.CPU_TYPE.ARM64, "x86_64": lief.MachO.Header.CPU_TYPE.X86_64}
    assert binary.header.cpu_type == kind[wheel.processor]
    assert binary.header.file_type == lief.MachO.Header.FILE_TYPE.BUNDLE
    assert binary.build_version.platform == lief.MachO.BuildVersion.PLATFORMS.MACOS
    assert list(binary.build_version.minos)[:2] == [11, 0]


def test_it_takes_libraries_of_the_system_alone(binary):
    """Else another program's library of the same name would serve it."""
    assert sorted(library.name for library in binary.libraries) == SYSTEM
    assert not binary.has_rpath


def test_it_exports_its_entry_alone(binary):
    assert [symbol.name for symbol in binary.exported_symbols] == ["_PyInit__core"]


def test_it_shares_no_function_of_cpp_with_other_libraries(binary):
    """macOS takes one definition of a weak symbol for the whole process, such as Blender's."""
    flags = lief.MachO.Header.FLAGS
    assert not binary.header.has(flags.WEAK_DEFINES)
    assert not binary.header.has(flags.BINDS_TO_WEAK)
    assert binary.header.has(flags.TWOLEVEL)


def test_python_has_every_symbol_that_no_library_of_the_system_has(wheel, binary):
    """Checks that all symbols without a library are those of Python.

    On macOS they are found when the module is loaded, so the linker accepts any. It knows only the
    symbols of macOS 11; symbols of later versions would be among them.
    """
    path = python.folder(wheel.python) / f"libpython{wheel.python}.dylib"
    processors = lief.MachO.parse(str(path))
    exported = {symbol.name for symbol in processors.at(0).exported_symbols}
    bound = {b.symbol.name: b.library_ordinal for b in binary.bindings if b.has_symbol}
    assert all(ordinal > 0 or ordinal == ANY_LIBRARY for ordinal in bound.values())
    free = {name for name, ordinal in bound.items() if ordinal == ANY_LIBRARY}
    assert "_PyModule_Create2" in free or "_PyModuleDef_Init" in free
    assert free <= exported
    # Each symbol that the module does not define is bound.
    assert {symbol.name for symbol in binary.imported_symbols} == set(bound)


def test_the_signature_is_that_of_these_bytes(module, binary):
    """Apple's processors end a program that loads another file."""
    data = module.read_bytes()
    assert binary.has_code_signature
    signature = code_signature.read(data, binary.code_signature.data_offset)
    assert signature.ad_hoc
    assert signature.signed_bytes == binary.code_signature.data_offset
    assert signature.wrong == []
    # And the check finds another byte.
    changed = bytearray(data)
    changed[len(data) // 2] ^= 1
    assert len(code_signature.read(changed, binary.code_signature.data_offset).wrong) == 1
