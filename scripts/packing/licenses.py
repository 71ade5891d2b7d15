# SPDX-License-Identifier: GPL-3.0-or-later
"""The license texts and the copyright holders of everything in a set of wheels."""

import re
import zipfile

# Files of a wheel's metadata that are license texts.
_TEXT = re.compile(
    r"(?:.*/)?(?P<info>[^/]+)-[^-/]+\.dist-info/(?:licenses/|license_files/)?"
    r"(?P<name>(?:licen[cs]es?|copying|copyright|notice)[^/]*(?:/.+)?|(?<=licenses/).+)",
    re.IGNORECASE,
)
_NOTICE = re.compile(
    r"(?:copyright|©)(?::|\s|\(c\)|©)*(?P<first>(?:19|20)\d\d)"
    r"(?:[\s,]*(?:-|–|,|and)\s*(?P<last>(?:19|20)\d\d|present))*[,.;]?\s+(?:by\s+)?"
    r"(?P<holder>[^\n\r]+)",
    re.IGNORECASE,
)
# Holders of the texts of licenses, or of Debian's packaging.
_OTHERS = re.compile(r"Free Software Foundation|@debian\.org")


def license_texts(wheels):
    """Returns {path: content} of the license texts of wheels, in folders by package."""
    texts = {}
    for path in wheels:
        with zipfile.ZipFile(path) as archive:
            for name in sorted(archive.namelist()):
                if found := _TEXT.fullmatch(name):
                    texts[f"{found['info']}/{found['name']}"] = archive.read(name)
    return texts


def copyrights(texts):
    """Returns lines "YEARS HOLDER (PACKAGE)", the first notice of each license text."""
    lines = {}
    for path, content in texts.items():
        for notice in _NOTICE.finditer(content.decode(errors="replace")):
            if _OTHERS.search(notice["holder"]):
                continue
            holder = re.split(r"\s*[<;(]|, a division|\s+[-.]?\s*All rights", notice["holder"])[0]
            holder = holder.strip(" .,").replace('"', "'")
            if holder:
                last = notice["last"] if (notice["last"] or "").isdigit() else None
                years = "-".join(filter(None, (notice["first"], last)))
                lines.setdefault(f"{years} {holder}", path.removesuffix(".txt"))
                break
    return [f"{line} ({package})" for line, package in lines.items()]
