"""Builds rustdoc and reports links to items that do not exist: python check_doc_links.py

Units in brackets, `[m]`, look like links to rustdoc, so its own lint is off; this is that lint without the units. What
stands bare in brackets is a unit, for links to items are written in backticks.
"""

import json
import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
LINT = "rustdoc::broken_intra_doc_links"


def main():
    environment = os.environ | {"RUSTDOCFLAGS": f"--force-warn {LINT}"}
    command = ["cargo", "doc", "--no-deps", "--workspace", "--document-private-items", "--message-format=json"]
    build = subprocess.run(command, cwd=ROOT, env=environment, stdout=subprocess.PIPE, check=True)
    units, faults = 0, []
    for line in build.stdout.decode().splitlines():
        message = json.loads(line).get("message") or {}
        if (message.get("code") or {}).get("code") != LINT:
            continue
        name = message["message"].partition("`")[2].rpartition("`")[0]
        source = "".join(line["text"] for span in message["spans"] for line in span["text"])
        if f"[{name}]" in source and f"[`{name}" not in source:
            units += 1
        else:
            faults.append(message["rendered"])
    print("\n".join(faults) or f"no broken link in the documentation of the code ({units} units passed over)")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
