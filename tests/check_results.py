#!/usr/bin/python3
"""Checks the result files of a run against what their formats ask: VTKHDF by its layout, XDMF by what it points at.

    check_results.py RUN_FOLDER [--paraview]

With --paraview (inside pvpython or pvbatch) each of ParaView's XDMF readers reads every time step. Where the vtk module
knows time in VTKHDF (9.3 or newer), every step of these files is read through it.
"""
import json
import os
import re
import sys
import xml.etree.ElementTree as xml

import h5py
import numpy as np

problems = []


def expect(true, what):
    if not true:
        problems.append(what)


def check_verdict(path):
    """It is "ok", or what the scene says in a line `-- verdict: ...`, or `-- verdict 3d: ...` for one dimension."""
    with open(path, encoding="utf-8") as file:
        record = json.load(file)
    dimension = record["program"].removeprefix("fissure")
    wanted = re.search(rf"^-- verdict(?: {dimension})?: (.*)$", record["scene"]["text"], re.M)
    reasons = sorted(reason["what"] for reason in record["verdict"]["reasons"])
    found = record["verdict"]["grade"] + (": " + ", ".join(reasons) if reasons else "")
    expect(found == (wanted[1] if wanted else "ok"), f"{path}: the verdict is {found}: {record['verdict']['reasons']}")


def check_vtkhdf(path):
    """VTKHDF 2.0, UnstructuredGrid: attributes, sizes, offsets that lead each step to its values. Returns the times."""
    with h5py.File(path, "r") as file:
        root, steps = file["VTKHDF"], file["VTKHDF/Steps"]
        expect(list(root.attrs["Version"]) == [2, 0], f"{path}: Version is {root.attrs['Version']}")
        expect(root.attrs["Type"] == b"UnstructuredGrid", f"{path}: Type is {root.attrs['Type']}")
        count = int(steps.attrs["NSteps"])
        times = steps["Values"][()]
        expect(len(times) == count, f"{path}: {len(times)} times for {count} steps")
        expect((np.diff(times) > 0).all(), f"{path}: times do not grow")
        points, cells, ids = (root["NumberOf" + name][()] for name in ("Points", "Cells", "ConnectivityIds"))
        for name in ("PartOffsets", "NumberOfParts", "PointOffsets", "CellOffsets", "ConnectivityIdOffsets"):
            expect(len(steps[name]) == count, f"{path}: Steps/{name} has {len(steps[name])} rows for {count} steps")
        for step in range(count):
            where = f"{path}: step {step}: "
            part = int(steps["PartOffsets"][step])
            expect(steps["NumberOfParts"][step] == 1, where + "not one part")
            n_points, n_cells, n_ids = points[part], cells[part], ids[part]
            first_point, first_id = steps["PointOffsets"][step], steps["ConnectivityIdOffsets"][step, 0]
            first_cell = steps["CellOffsets"][step, 0]
            expect(first_point + n_points <= len(root["Points"]), where + "points beyond the end")
            expect(first_id + n_ids <= len(root["Connectivity"]), where + "connectivity beyond the end")
            offsets = root["Offsets"][first_cell + part : first_cell + part + n_cells + 1]  # parts have one more
            spans = len(offsets) == n_cells + 1 and offsets[0] == 0 and offsets[-1] == n_ids
            expect(spans, where + "offsets do not span the connectivity")
            types = root["Types"][first_cell : first_cell + n_cells]
            nodes = {3: 2, 5: 3, 9: 4, 10: 4, 12: 8}
            fit = all(nodes.get(int(t)) == d for t, d in zip(types, np.diff(offsets)))
            expect(fit, where + "types do not fit the offsets")
            connectivity = root["Connectivity"][first_id : first_id + n_ids]
            known = n_ids == 0 or (connectivity.min() >= 0 and connectivity.max() < n_points)
            expect(known, where + "a cell names a point that is not there")
            place = root["Points"][first_point : first_point + n_points]
            expect(np.isfinite(place).all(), where + "a point is not finite")
            for kind, rows in (("Point", n_points), ("Cell", n_cells)):
                for name, values in root[kind + "Data"].items():
                    first = steps[f"{kind}DataOffsets/{name}"][step]
                    expect(first + rows <= len(values), where + f"{name} beyond the end")
                    expect(values.dtype == np.float32, where + f"{name} is {values.dtype}")
        return list(times)


def check_xdmf(path):
    """Well-formed, and every dataset that it names exists with the shape that it says. Returns the times."""
    tree, times, folder = xml.parse(path), [], os.path.dirname(path)
    for grid in tree.getroot().find("Domain/Grid"):
        times.append(float(grid.find("Time").get("Value")))
        topology, geometry = grid.find("Topology"), grid.find("Geometry")
        nodes = {"Polyline": 2, "Triangle": 3, "Quadrilateral": 4, "Tetrahedron": 4, "Hexahedron": 8}.get(topology.get("TopologyType"))
        cells = int(topology.get("NumberOfElements"))
        points = shape_of(geometry.find("DataItem"))[0]
        where = f"{path}: t = {times[-1]}: "
        expect(nodes is None or shape_of(topology.find("DataItem")) == [cells * nodes], where + "the topology has another size")
        for item in grid.iter("DataItem"):
            shape = shape_of(item)
            if item.get("ItemType") == "HyperSlab":  # a column of what stands inside it
                start, stride, count = np.array(item[0].text.split(), int).reshape(3, -1)
                whole = shape_of(item[1])
                expect(list(count) == shape and (start + stride * (count - 1) < whole).all(), f"{path}: {item[0].text} of {whole} is not {shape}")
            if item.get("Format") != "HDF":
                continue
            name, _, dataset = item.text.strip().partition(":")
            with h5py.File(os.path.join(folder, name), "r") as file:
                expect(dataset in file, f"{path}: {item.text} does not exist")
                if dataset in file:
                    found = list(file[dataset].shape)
                    expect(found == shape, f"{path}: {item.text} is {found}, not {shape}")
        for attribute in grid.findall("Attribute"):
            rows = {"Node": points, "Cell": cells}[attribute.get("Center")]
            given = shape_of(attribute.find("DataItem"))[0]
            expect(given == rows, where + f"{attribute.get('Name')} has {given} rows, not {rows}")
    return times


def shape_of(item):
    return [int(size) for size in item.get("Dimensions").split()]


def first_leaf(data):
    while data is not None and (data.IsA("vtkCompositeDataSet") or data.IsA("vtkPartitionedDataSet")):
        data = data.GetBlock(0) if hasattr(data, "GetBlock") else data.GetPartition(0)
    return data


def check_with_vtk(path, times):
    """The VTKHDF file through VTK's own reader, where that knows steps (VTK 9.3 or newer)."""
    try:
        import vtk
    except ImportError:
        return "no vtk module"
    if not hasattr(vtk, "vtkHDFReader") or not hasattr(vtk.vtkHDFReader, "GetNumberOfSteps"):
        return f"VTK {vtk.vtkVersion.GetVTKVersion()} knows no steps in VTKHDF"
    reader = vtk.vtkHDFReader()
    reader.SetFileName(path)
    reader.UpdateInformation()
    seen = reader.GetNumberOfSteps()
    expect(seen == len(times), f"{path}: VTK sees {seen} steps of {len(times)}")
    with h5py.File(path, "r") as file:
        root, steps = file["VTKHDF"], file["VTKHDF/Steps"]
        for step, time in enumerate(times):
            reader.UpdateTimeStep(time)
            data = first_leaf(reader.GetOutputDataObject(0))
            part = steps["PartOffsets"][step]
            where = f"{path}: step {step}: VTK "
            cells, points = data.GetNumberOfCells(), data.GetNumberOfPoints()
            expect(cells == root["NumberOfCells"][part], where + f"sees {cells} cells")
            expect(points == root["NumberOfPoints"][part], where + f"sees {points} points")
            for name, values in root["CellData"].items():
                array = data.GetCellData().GetArray(name)
                expect(array is not None, where + f"sees no {name}")
                if array is not None and data.GetNumberOfCells():
                    mine = values[steps["CellDataOffsets/" + name][step]]
                    theirs = np.array(array.GetTuple(0), np.float32)
                    expect(np.array_equal(np.atleast_1d(mine), theirs, equal_nan=True), where + f"reads another {name}")
    return f"read by VTK {vtk.vtkVersion.GetVTKVersion()}"


def check_with_paraview(path, times):
    """Every time step through each of ParaView's XDMF readers."""
    from paraview import servermanager, simple
    for reader in (simple.Xdmf3ReaderT(FileName=[path]), simple.XDMFReader(FileNames=[path])):
        reader.UpdatePipelineInformation()
        seen = list(reader.TimestepValues)
        expect(np.allclose(seen, times, rtol=1e-12), f"{path}: ParaView sees {len(seen)} times of {len(times)}")
        grids = xml.parse(path).getroot().find("Domain/Grid")
        for time, grid in zip(times, grids):
            reader.UpdatePipeline(time)
            data = first_leaf(servermanager.Fetch(reader))
            cells = int(grid.find("Topology").get("NumberOfElements"))
            right = data is not None and data.GetNumberOfCells() == cells
            expect(right, f"{path}: t = {time}: ParaView sees other cells")
            names = {attribute.get("Name") for attribute in grid.findall("Attribute")}
            sets = (data.GetPointData(), data.GetCellData())
            held = {fields.GetArrayName(i) for fields in sets for i in range(fields.GetNumberOfArrays())}
            expect(names <= held, f"{path}: t = {time}: ParaView does not see {', '.join(sorted(names - held))}")
    return f"read by ParaView {simple.GetParaViewVersion()}"


def main():
    folders = [name for name in sys.argv[1:] if not name.startswith("-")]
    if len(folders) != 1 or not os.path.isdir(folders[0]):
        sys.exit(__doc__)
    for part in ("results", "cracks", "rigid"):
        path = os.path.join(folders[0], part)
        if part == "rigid" and not os.path.exists(path + ".xdmf"):  # neither plates nor walls
            continue
        times = check_xdmf(path + ".xdmf")
        inside = check_vtkhdf(path + ".vtkhdf")
        expect(inside == times, f"{path}: {len(inside)} steps in .vtkhdf, {len(times)} in .xdmf")
        words = [check_with_vtk(path + ".vtkhdf", inside)]
        if "--paraview" in sys.argv:
            words.append(check_with_paraview(path + ".xdmf", times))
        print(f"{path}: {len(times)} steps; {'; '.join(words)}")
    check_verdict(os.path.join(folders[0], "run.json"))
    for problem in problems:
        print(problem, file=sys.stderr)
    sys.exit(1 if problems else 0)


if __name__ == "__main__":
    main()
