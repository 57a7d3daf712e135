#!/bin/sh
# Every picture in book/src/pictures that is not drawn by hand. `cargo xtask book --pictures` runs it in a folder with data/ in it, with
# both programs on the path and `pictures` set to the folder of the pictures; `cargo xtask book` runs it too and compares what it draws.
set -eu

# scene SCENE PICTURE...: runs a scene and keeps these of its pictures, as SCENE-PICTURE.
scene() {
    name=$1
    shift
    fractal-contact run "data/scenes/$name.toml" --out "out/$name" --fresh
    for picture in "$@"; do
        cp "out/$name/$picture" "$pictures/$name-$picture"
    done
}

scene ball-on-plate curve-approach-deviation.svg
scene rough-sphere curve-stiffness.svg pressure-bem3d-0-004.png pressure-bem3d-0-005.png
scene rough-map pressure-bem3d-0-002.png gap-bem3d-0-002.png distribution-pressure.svg
scene diamond-hardness gap-bem3d-0-000.png
scene anisotropic pressure-bem3d-0-001.png
scene cattaneo-mindlin-loop curve-tangential_force.svg
scene viscoelastic-indentation curve-approach.svg
scene fractal-3d-and-1d curve-stiffness.svg
scene contact-conductance curve-conductance.svg
scene periodic-theories curve-stiffness.svg curve-area.svg
scene rough-friction curve-tangential_force.svg
scene fretting-loop curve-tangential_force.svg traction-bem3d-0-006.png slip-bem3d-0-003.png stick_slip-bem3d-0-003.png
scene rough-creep curve-approach.svg
scene rubber-cycles curve-force.svg
scene sealing-land pressure-bem3d-0-002.png
scene seal fluid_pressure-bem3d-0-002.png flux-bem3d-0-002.png
scene gear-tooth stress_section-bem3d-0-002.png
scene rough-plastic plastic_depth-bem3d-0-002.png
scene plastic-path curve-force.svg
scene sticky-ball curve-force.svg
scene rough-sticky-ball curve-force.svg pressure-bem3d-0-042.png
scene rough-tip curve-force.svg
scene rough-sphere-friction stick_slip-bem3d-0-005.png

fractal-contact info data/measured/uncd-afm.001 --channel 0 --detrend plane --tip-radius "26 nm" --out out/uncd
for picture in spectrum.svg slope.svg; do
    cp "out/uncd/$picture" "$pictures/uncd-$picture"
done

# The upper part of a report, where there is a browser.
if command -v chromium > /dev/null; then
    chromium --headless --no-sandbox --disable-gpu --hide-scrollbars --window-size=1000,1750 \
        --screenshot="$pictures/report.png" "file://$PWD/out/anisotropic/report.html"
fi
