#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares the copper of Gerber files with that of the board, by two readers of others.
Usage: gerber_test.py TRISKIN WRITE_STRIP NODE_MODULES [DESIGN]
KiCad plots the copper layers of the boards of a design; gerbv draws them, tracespace (npm) lists their shapes, and this
file draws what the board's own text says. On each layer the area by tracespace must be that of the board within 0.5 %,
and that by gerbv within 2 %, because gerbv rounds widths to whole pixels, here 0.005 mm of 0.1 and 0.15 mm.
Exit status: 0 they are, 1 they are not, 77 one of the readers is missing."""
import pathlib
import shutil
import subprocess
import sys
import tempfile

import boards_test
from gerber_areas import TOLERANCE_GERBV, TOLERANCE_TRACESPACE, area_by_board, area_by_gerbv, area_by_tracespace

pcbnew = boards_test.import_of_debian("pcbnew")
LAYERS = ("F.Cu", "In1.Cu", "In2.Cu", "B.Cu")


def plot(path, folder):
    """Plots the copper layers; returns a file for each."""
    board = pcbnew.LoadBoard(str(path))
    control = pcbnew.PLOT_CONTROLLER(board)
    options = control.GetPlotOptions()
    options.SetOutputDirectory(str(folder))
    options.SetUseGerberProtelExtensions(False)
    options.SetCreateGerberJobFile(False)
    options.SetPlotFrameRef(False)
    for layer in LAYERS:
        control.SetLayer(board.GetLayerID(layer))
        control.OpenPlotfile(layer.replace(".", "_"), pcbnew.PLOT_FORMAT_GERBER, layer)
        control.PlotLayer()
    control.ClosePlot()
    return {layer: folder / f"{path.stem}-{layer.replace('.', '_')}.gbr" for layer in LAYERS}


def main():
    program, write_strip, modules, *designs = sys.argv[1:]
    if not shutil.which("gerbv") or not (pathlib.Path(modules) / "@tracespace/plotter").exists():
        print("left out: gerbv or @tracespace/plotter is not installed")
        sys.exit(77)
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        if not designs:
            designs = [str(folder / "strip.json")]
            subprocess.run([write_strip, designs[0], "2"], check=True)
        subprocess.run([program, "fabricate", designs[0], "-o", str(folder / "out"), "--only", "kicad"], check=True,
                       capture_output=True)
        wrong = 0
        for path in sorted((folder / "out/kicad").glob("*.kicad_pcb")):
            for layer, file in plot(path, folder).items():
                area, gerbv, tracespace = (area_by_board(path, layer), area_by_gerbv(file),
                                           area_by_tracespace(modules, file))
                wrong += abs(tracespace - area) > TOLERANCE_TRACESPACE * area
                wrong += abs(gerbv - area) > TOLERANCE_GERBV * area
                print(f"{path.stem} {layer}: board {area:.2f}, gerbv {gerbv:.2f}, tracespace {tracespace:.2f} mm²")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
