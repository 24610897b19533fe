#!/bin/sh
# Measures the nylon of the book's page "One fabric" again, draws the run of its flag in the folder RUN, and
# compares both with what the page shows: check_one_fabric.sh MUSLIN RUN
# With --renew after them, writes what the page shows instead. Needs Python 3.11 with NumPy.
set -eu
muslin=$(realpath "$1")
run=$(realpath "$2")
renew=${3-}
cd "$(dirname "$0")/../.."
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
root=$PWD
shown=book/src/one-fabric
fabric=nylon-heat-bondable

# As the page has its commands, whose paths stand in what they say.
cd "$out"
"$muslin" fabric show $fabric >fabric.txt
for yarns in warp weft; do
    "$muslin" lab tensile $fabric --along $yarns >tensile-$yarns.txt
    "$muslin" lab bend $fabric --along $yarns >bend-$yarns.txt
done
"$muslin" lab shear $fabric >shear.txt
cp out/lab-tensile-$fabric-weft/plot.svg tensile.svg
cp out/lab-shear-$fabric-warp/plot.svg shear.svg
cp out/lab-bend-$fabric-weft/plot.svg bend.svg
rm -r out
cd "$root"

if [ "$renew" = --renew ]; then
    mkdir -p $shown
    cp "$out"/* $shown/
    python3 tools/animate.py "$run" $shown/flag.png
    exit
fi
differs=0
for file in "$out"/*; do
    cmp "$file" "$shown/$(basename "$file")" || differs=1
done
python3 tools/animate.py "$run" $shown/flag.png --check || differs=1
if [ "$differs" = 1 ]; then
    echo "the book does not show what muslin computes; if the new results are right: $0 $muslin RUN --renew"
    exit 1
fi
