"""Runs scenes of Fissure and opens what they wrote, as numpy arrays.

    import fissure
    run = fissure.run("brazilian.lua", dimension=2, settings={"h": 2e-3})     # or fissure.open("brazilian-fissure2d")
    run.history["load"]                    # [rows], in run.units["load"]
    run.frames[-1].fields["principal"]     # [cells] or [vertices], with components [.., 3] or [.., 6]
    run.verdict.grade, run.energies["kinetic"], run.expectations

Everything is in SI units. Needs python3-numpy and python3-h5py; pandas, xarray and pyvista only for the conversions that are named so.
"""
from .programs import Error, check, parameters, program, restart, run
from .results import Cracks, Frame, Frames, Mesh, Run, Verdict, open

__all__ = ["Cracks", "Error", "Frame", "Frames", "Mesh", "Run", "Verdict", "check", "open", "parameters", "program", "restart", "run"]
