"""Checks that every path which the documents name exists: python check_paths.py

Paths stand in backticks. One with a slash is relative to the repository; a bare name such as `grid.rs` must be the name of
some file or folder. Names of what a run writes are known. ARCHITECTURE.md must have at most 150 lines.
"""

import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
DOCUMENTS = ["ARCHITECTURE.md", "README.md", "STYLE.md", "CONTRIBUTING.md"]
MOST_LINES = 150

# What `muslin run` writes, and names with a place holder.
OUTPUTS = {"scene.toml", "summary.json", "series.csv", "trajectory.npz", "cloth.glb", "poster.png", "view.html"}
PLACEHOLDERS = re.compile(r"[A-Z]{3,}|^out/")
TOKEN = re.compile(r"`([^`\s]+)`")
FILE_NAME = re.compile(r"^[\w.-]+\.(rs|toml|md|json|py|mjs|sh|html|txt)$|^[\w.-]+/$")


def main():
    listing = subprocess.run(["git", "ls-files", "-co", "--exclude-standard"], cwd=ROOT, capture_output=True, check=True)
    files = {Path(line) for line in listing.stdout.decode().splitlines() if (ROOT / line).exists()}
    names = {part for file in files for part in file.parts}
    faults = []
    for document in DOCUMENTS:
        # Blocks of code are not prose; the commands in them are run by CI.
        text = re.sub(r"^( *)```.*?^\1```", "", (ROOT / document).read_text(encoding="utf-8"), flags=re.M | re.S)
        if document == "ARCHITECTURE.md" and MOST_LINES < (lines := len(text.splitlines())):
            faults.append(f"{document} has {lines} lines, but must have at most {MOST_LINES}")
        for token in dict.fromkeys(TOKEN.findall(text)):
            if token in OUTPUTS or (PLACEHOLDERS.search(token) and token not in DOCUMENTS):
                continue
            if "/" in token.rstrip("/") and re.match(r"^[\w./-]+$", token):
                found = (ROOT / token).exists()
            elif FILE_NAME.match(token):
                found = token.rstrip("/") in names
            else:
                continue
            if not found:
                faults.append(f"{document} names `{token}`, which does not exist")
    print("\n".join(faults) or f"{len(DOCUMENTS)} documents: every path exists")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
