#!/bin/sh
# Recomputes the paper with the program MUSLIN, and compares what the book includes, which has no times: check_paper.sh MUSLIN
# With --renew after it, copies what was computed over it instead.
set -eu
muslin=$1
cd "$(dirname "$0")/../.."
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
"$muslin" reproduce "$out/paper"
figures=$(grep -o 'paper/figure-[a-z0-9-]*\.[a-z]*' "$out/paper/paper-figures.md" | sort -u)
if [ "${2-}" = --renew ]; then
    rm -rf book/src/paper
    mkdir book/src/paper
    cp "$out/paper/paper-figures.md" book/src/
    for figure in $figures; do cp "$out/$figure" "book/src/$figure"; done
    exit
fi
differs=0
for file in paper-figures.md $figures; do
    case $file in paper/*) computed=$out/$file ;; *) computed=$out/paper/$file ;; esac
    cmp "$computed" "book/src/$file" || differs=1
done
for file in book/src/paper/*; do
    if ! echo "$figures" | grep -qx "paper/$(basename "$file")"; then
        echo "$file is no figure of the paper any more"
        differs=1
    fi
done
if [ "$differs" = 1 ]; then
    echo "the book does not show what \`muslin reproduce\` computes; if the new figures are right: $0 $muslin --renew"
    exit 1
fi
