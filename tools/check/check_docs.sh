#!/bin/sh
# Checks the documents: spelling, links, named paths, the book, the documentation of the code.
# Needs `typos` (pip install typos, or cargo install typos-cli), `mdbook` 0.5 and python3.
set -eu
cd "$(dirname "$0")/../.."
typos
python3 tools/check/check_links.py
python3 tools/check/check_paths.py
log=$(mktemp)
mdbook build book 2>"$log" || { cat "$log"; exit 1; }
# mdBook has no switch that makes a warning an error.
if grep -E 'WARN|ERROR' "$log"; then exit 1; fi
rm "$log"
RUSTDOCFLAGS="-D warnings" cargo doc --no-deps --workspace
python3 tools/check/check_doc_links.py
