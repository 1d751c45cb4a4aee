#!/usr/bin/env bash
# Drives the real window under Xvfb, and keeps a picture of each step: those of docs/viewer.md.
#
#   docs/viewer/pictures.sh [FOLDER]
#
# Needs Xvfb, xdotool and ImageMagick (Debian: xvfb xdotool imagemagick), an adapter (mesa-vulkan-drivers), a built
# `volgraph` (VOLGRAPH, else target/debug/volgraph) and, in VOLGRAPH_DATA, the engine scan. PACE stretches all waits.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
out=${1:-docs/viewer}
volgraph=${VOLGRAPH:-target/debug/volgraph}
pace=${PACE:-1}
for tool in Xvfb xdotool import convert; do
    command -v "$tool" >/dev/null || { echo "$tool is missing: apt-get install xvfb xdotool imagemagick" >&2; exit 1; }
done
mkdir -p "$out"
scratch=$(mktemp -d)
export DISPLAY=:${SCREEN:-93} HOME="$scratch" XDG_RUNTIME_DIR="$scratch" VOLGRAPH_CACHE="$scratch/cache"
Xvfb "$DISPLAY" -screen 0 1280x800x24 >/dev/null 2>&1 &
screen=$!
window=
trap 'kill $window $screen 2>/dev/null || true; rm -rf "$scratch"' EXIT

pause() { sleep "$(awk "BEGIN { print $1 * $pace }")"; }
keep() {
    import -window root "$scratch/shot.png"
    convert "$scratch/shot.png" -colors 255 -define png:compression-level=9 "$out/$1.png"
    echo "$out/$1.png"
}
click() { xdotool mousemove "$1" "$2" click "${3:-1}"; }
press() { xdotool key "$1"; }
open() {
    # Nothing of an earlier window is remembered.
    rm -rf "$scratch/.local"
    "$volgraph" view "$@" &
    window=$!
    pause 9
    xdotool windowfocus "$(xdotool search --name '^volgraph$' | head -n 1)"
}
close() {
    kill "$window"
    wait "$window" 2>/dev/null || true
}
declare -A tab=([transfer]=57 [messages]=152 [graph]=213 [slices]=262 [ray]=305)
panel() { click "${tab[$1]}" 526; pause 2; }

# A technique under edit: volgraph's own, copied where it is found first.
technique="$scratch/live/slot/technique/dvr.wgsl"
mkdir -p "$(dirname "$technique")"
cp shaders/slot/technique/dvr.wgsl "$technique"

open engine --shaders "$scratch/live"
keep opened

xdotool mousemove 380 300 mousedown 1
for step in $(seq 1 12); do
    xdotool mousemove $((380 + 12 * step)) $((300 + 3 * step))
    pause 0.25
done
keep orbiting
xdotool mouseup 1
pause 6
keep still

panel messages
sed -i '0,/return/s//retrun/' "$technique"
pause 4
keep broken
cp shaders/slot/technique/dvr.wgsl "$technique"
sed -i '1s/^/\/\/ As it was, saved again.\n/' "$technique"
pause 6
keep mended

panel transfer
xdotool mousemove 700 688 mousedown 1
for step in $(seq 1 6); do
    xdotool mousemove $((700 - 14 * step)) $((688 - 9 * step))
    pause 0.3
done
xdotool mouseup 1
pause 6
keep transfer

click 480 215
panel ray
pause 6
keep ray
panel slices
keep slices
panel graph
keep graph
press b
pause 1
keep wipe
press c
pause 20
keep error
press F1
pause 1
keep help
close

open clip_planes
keep clipping
