# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests the compiled module: its system and processor, the libraries that it loads, and the symbols
that it exports.
"""

import zipfile
from pathlib import Path

import code_signature
import lief
import pytest
from packing.macos import python

SYSTEM = ["/usr/lib/libSystem.B.dylib", "/usr/lib/libz.1.dylib"]
# Library ordinal of symbols that are searched in every library of the process.
ANY_LIBRARY = -2


@pytest.fixture(scope="module")
def module(wheel, tmp_path_factory):
    """Unpacks the module and returns its path."""
    with zipfile.ZipFile(wheel.path) as archive:
        return Path(archive.extract(wheel.module, tmp_path_factory.mktemp("module")))


@pytest.fixture(scope="module")
def binary(module):
    processors = lief.MachO.parse(str(module))  # must outlive its part
    yield processors.at(0)


def test_it_is_for_one_processor_and_macos_11(wheel, module, binary):
    assert lief.MachO.parse(str(module)).size == 1
    kind = {"arm64": lief.MachO.Header.CPU_TYPE.ARM64, "x86_64": lief.MachO.Header.CPU_TYPE.X86_64}
    assert binary.header.cpu_type == kind[wheel.processor]
    assert binary.header.file_type == lief.MachO.Header.FILE_TYPE.BUNDLE
    assert binary.build_version.platform == lief.MachO.BuildVersion.PLATFORMS.MACOS
    assert list(binary.build_version.minos)[:2] == [11, 0]


def test_it_takes_libraries_of_the_system_alone(binary):
    """Checks that it needs no other library, because another program's library of the same name
    could replace it.
    """
    assert sorted(library.name for library in binary.libraries) == SYSTEM
    assert not binary.has_rpath


def test_it_exports_its_entry_alone(binary):
    assert [symbol.name for symbol in binary.exported_symbols] == ["_PyInit__core"]


def test_it_shares_no_function_of_cpp_with_other_libraries(binary):
    """Checks its C++ symbols, because macOS uses one definition of a weak symbol for the whole
    process, such as Blender's.
    """
    flags = lief.MachO.Header.FLAGS
    assert not binary.header.has(flags.WEAK_DEFINES)
    assert not binary.header.has(flags.BINDS_TO_WEAK)
    assert binary.header.has(flags.TWOLEVEL)


def test_python_has_every_symbol_that_no_library_of_the_system_has(wheel, binary):
    """Checks that all symbols without a library are those of Python, which are found at load time.

    The linker accepts any such symbol. It knows only macOS 11, so symbols of later versions would
    be among them.
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
    """Checks the signature, without which Apple's processors end the program."""
    data = module.read_bytes()
    assert binary.has_code_signature
    signature = code_signature.read(data, binary.code_signature.data_offset)
    assert signature.ad_hoc
    assert signature.signed_bytes == binary.code_signature.data_offset
    assert signature.wrong == []
    # The check must detect a changed byte.
    changed = bytearray(data)
    changed[len(data) // 2] ^= 1
    assert len(code_signature.read(changed, binary.code_signature.data_offset).wrong) == 1
