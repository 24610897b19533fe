"""Checks the links in all Markdown files that point into the repository, anchors too: python check_links.py"""

import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
LINK = re.compile(r"\[[^\]\[]*\]\(\s*<?([^)\s>]+)>?[^)]*\)")
CODE = re.compile(r"^( *)```.*?^\1```|`[^`\n]*`", re.M | re.S)


def prose(path):
    """The text of a file without code, in which brackets are no links."""
    return CODE.sub("", path.read_text(encoding="utf-8"))


def anchors(path):
    """The anchors that GitHub and mdBook make of a file's headings."""
    text = re.sub(r"^( *)```.*?^\1```", "", path.read_text(encoding="utf-8"), flags=re.M | re.S)
    found = set()
    for heading in re.findall(r"^#+ +(.*?) *$", text, re.M):
        name = re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")
        number = 0
        while (anchor := f"{name}-{number}" if number else name) in found:
            number += 1
        found.add(anchor)
    return found


def fault(document, target):
    if re.match(r"[a-z]+:", target):
        return None
    name, _, anchor = target.partition("#")
    path = (document.parent / name).resolve() if name else document
    if not path.exists():
        return f"{document.relative_to(ROOT)}: `{target}` does not exist"
    if anchor and path.suffix == ".md" and anchor not in anchors(path):
        return f"{document.relative_to(ROOT)}: `{target}` has no such heading"
    return None


def main():
    listing = subprocess.run(["git", "ls-files", "-co", "--exclude-standard", "*.md"], cwd=ROOT, capture_output=True, check=True)
    documents = [ROOT / line for line in listing.stdout.decode().splitlines() if (ROOT / line).exists()]
    links = [(document, target) for document in documents for target in LINK.findall(prose(document))]
    faults = [found for found in (fault(*link) for link in links) if found]
    print("\n".join(faults) or f"{len(documents)} Markdown files, {len(links)} links: none is broken")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
