#!/usr/bin/python3
"""Pictures of a run: curves.png, energy.png, cracks.png, fragments.png where it broke, and animation.gif, written into the run's folder.

    plot.py RUN_FOLDER [--field NAME] [--only curves,energy,cracks,fragments,animation] [--frames N]

Needs Debian's python3-numpy, python3-matplotlib, python3-h5py and python3-pil; reads a run that is still going on, too.
"""
import argparse
import os
import sys

import matplotlib
matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.animation import PillowWriter
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import LinearSegmentedColormap, ListedColormap, Normalize
from matplotlib.lines import Line2D

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), "python"))
import fissure
from fissure.results import HEXAHEDRON, QUADRILATERAL, TETRAHEDRON, TRIANGLE

# Okabe and Ito (2008): eight colours that colour-blind readers tell apart.
COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#F0E442", "#000000"]
MODE_MAP = LinearSegmentedColormap.from_list("mode", ["#0057D9", "#7B2FBE", "#E01B24"])      # opening blue, slip red
WHOLE_MAP = plt.get_cmap("viridis")                                                         # bodies without cracks
FIELD_MAP = LinearSegmentedColormap.from_list("field", ["#FAFAF8", "#D9D9D4", "#A3A39C"])  # pale: cracks stand out
# Which colour a piece has means nothing.
PIECE_MAP = ListedColormap(["#A6CEE3", "#FDBF6F", "#B2DF8A", "#FB9A99", "#CAB2D6", "#FFFFB3", "#8DD3C7", "#FCCDE5", "#D9D9D9", "#BEBADA", "#CCEBC5"])
RIGID, RIGID_EDGE = "#D8DEE6", "#5B6B7C"                                                    # plates, walls, held vertices
MODE_TITLE = "crack mode: share of slip in the work"
FIELD_TITLES = {"principal": "largest principal stress", "von_mises": "von Mises stress", "damage": "damage",
                "velocity": "speed", "displacement": "displacement", "pressure": "pressure", "plastic_strain": "plastic strain",
                "plastic_rate": "plastic strain rate", "temperature": "temperature", "yield_ratio": "share of the yield stress"}
LEDGER = ["kinetic", "elastic", "hourglass", "plastic", "joint", "fracture", "viscous", "mass_damping", "contact", "friction", "gravity", "removed", "excavated", "spring", "spring_lost"]
# A term has its colour in every picture, whichever others are shown beside it.
ENERGY_COLOURS = dict(zip(LEDGER, COLOURS[:7] + ["#8C8C8C", "#7A5195", "#A6611A", "#80CDC1", "#444444", "#BFA58A", "#E7298A", "#F4A6CD"]))

plt.rcParams.update({
    "font.family": "DejaVu Sans", "font.size": 9, "axes.titlesize": 10, "axes.labelsize": 9, "legend.fontsize": 8,
    "axes.spines.top": False, "axes.spines.right": False, "axes.linewidth": 0.8, "axes.grid": True,
    "grid.color": "#E6E6E6", "grid.linewidth": 0.6, "lines.linewidth": 1.4, "legend.frameon": False, "savefig.dpi": 200,
    "axes.prop_cycle": plt.cycler(color=COLOURS), "axes.axisbelow": True})


def fail(text):
    sys.exit(f"plot.py: {text}")


def prefixed(values, unit):
    """Factor and unit with an SI prefix, so that the largest value reads as 1 to 1000."""
    largest = np.nanmax(np.abs(values), initial=0) if len(values) else 0
    if unit not in ("Pa", "N", "J", "m", "s", "W", "m/s") or not np.isfinite(largest) or largest == 0:
        return 1, unit
    power = int(np.clip(3 * np.floor(np.log10(largest * 1.0001) / 3), -12, 12))
    return 10.0 ** -power, {-12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G", 12: "T"}[power] + unit


def label(name, unit):
    text = name.replace("_", " ")
    return f"{text} [{unit}]" if unit else text


# ------------------------------------------------------------------------------------------------------ what a run left

FACES = {TRIANGLE: ([0, 1], [1, 2], [2, 0]), QUADRILATERAL: ([0, 1], [1, 2], [2, 3], [3, 0]),      # outward
         TETRAHEDRON: ([0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]),
         HEXAHEDRON: ([0, 4, 7, 3], [1, 2, 6, 5], [0, 1, 5, 4], [3, 7, 6, 2], [0, 3, 2, 1], [4, 5, 6, 7])}
TETRAHEDRA = {TETRAHEDRON: ([0, 1, 2, 3],),
              HEXAHEDRON: ([0, 1, 2, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 7, 4, 6], [0, 4, 5, 6], [0, 5, 1, 6])}

BOX_EDGES = ([0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7])


class Frame(fissure.Frame):
    """A frame, and the colours of pieces."""

    def cell_values(self, name):
        if name != "fragment":
            return super().cell_values(name)
        # in the order of their first cells, so that neighbours mostly differ
        _, first, piece = np.unique(self.fields[name], return_index=True, return_inverse=True)
        return (np.argsort(np.argsort(first))[piece.reshape(-1)] * 5 % PIECE_MAP.N).astype(float)


class Run(fissure.Run):
    """A run, and the geometry of its pictures."""
    frame_type = Frame

    def __init__(self, folder):
        super().__init__(folder)
        if self.frames:
            self.boundary, self.boundary_cell, self.interfaces = self.find_boundary()

    def find_boundary(self):
        """Faces that one cell has alone, and those between cells of other bodies, or materials, where a field says so. Places are compared: in
        the first frame, split vertices still coincide."""
        frame = self.frames[0]
        points, told = frame.points, [frame.fields[name] for name in ("body", "material") if frame.where.get(name) == "cell"]
        grain = max(np.ptp(points, axis=0).max(), 1e-300) * 1e-7
        _, place = np.unique(np.round(points / grain).astype(np.int64), axis=0, return_inverse=True)
        place = place.reshape(-1)
        faces, owner, keys = [], [], []
        for kind, (cells, numbers) in self.mesh.kinds.items():
            for corners in FACES[kind]:
                missing = 2 ** (self.dimension - 1) - len(corners)                # a triangle is stored as a square that is half flat
                faces.append(cells[:, corners + corners[-1:] * missing])
                keys.append(np.pad(np.sort(place[cells[:, corners]], axis=1), ((0, 0), (0, missing)), constant_values=-1))
                owner.append(numbers)
        faces, owner = np.concatenate(faces), np.concatenate(owner)
        _, first, which, count = np.unique(np.concatenate(keys), axis=0, return_index=True, return_inverse=True, return_counts=True)
        which = which.reshape(-1)
        alone = count[which] == 1
        other = owner[first[which]]                                        # the first cell at the face: for one of both sides the other
        between = np.any([of[owner] != of[other] for of in told], axis=0) if told else np.zeros(len(owner), bool)
        if self.dimension == 2:
            return faces[alone], owner[alone], faces[between]
        outside, real = self.halves(faces[alone])
        return outside, np.tile(owner[alone], 2)[real], self.halves(faces[between])[0]

    @staticmethod
    def halves(faces):
        """Triangles of faces with four corners, and which halves they are: not the flat ones."""
        both = np.concatenate([faces[:, :3], faces[:, [0, 2, 3]]])
        real = both[:, 1] != both[:, 2]
        return both[real], real

    def polygons(self):
        """2D cells by number, as four corners: a triangle's last one twice."""
        corners = np.empty((len(self.mesh.types), 4), int)
        for cells, numbers in self.mesh.kinds.values():
            corners[numbers] = cells[:, [0, 1, 2, cells.shape[1] - 1]]
        return corners

    def tetrahedra(self):
        """3D cells as tetrahedra, and the cell of each."""
        parts, owner = [], []
        for kind, (cells, numbers) in self.mesh.kinds.items():
            for corners in TETRAHEDRA[kind]:
                parts.append(cells[:, corners])
                owner.append(numbers)
        return np.concatenate(parts), np.concatenate(owner)

    def face_triangles(self):
        """The faces of 3D cells, each cut into triangles: what a slice shows of them are the cells' edges."""
        return np.concatenate([cells[:, [corners[0], corners[k], corners[k + 1]]] for kind, (cells, _) in self.mesh.kinds.items()
                               for corners in FACES[kind] for k in range(1, len(corners) - 1)])


def choose_field(run, asked):
    fields = run.frames[-1].fields
    if asked:
        if asked not in fields:
            fail(f'{run.folder}: has no field "{asked}" (there are {", ".join(sorted(fields)) or "none"})')
        return asked
    flowed = run.frames[-1].cell_values("plastic_strain") if "plastic_strain" in fields else np.zeros(1)
    if np.nanmax(flowed, initial=0) > 0:
        return "plastic_strain"
    preferred = ("principal", "von_mises", "stress", "damage", "velocity", "displacement")
    return next((name for name in preferred if name in fields), None)


# -------------------------------------------------------------------------------------------------------------- curves

def draw_curves(axes, runs, name, against, unit=None):
    """One measure of one run or several, in units that fit them all."""
    x_factor, x_unit = prefixed(np.concatenate([run.history[against] for run in runs]), runs[0].units[against])
    y_factor, y_unit = prefixed(np.concatenate([run.history[name] for run in runs]), unit or runs[0].units[name])
    for run in runs:
        axes.plot(run.history[against] * x_factor, run.history[name] * y_factor)
    axes.set_xlabel(label(against, x_unit))
    axes.set_ylabel(label(name, y_unit))
    axes.margins(x=0.01)
    return x_factor, y_factor


def panels_for(count):
    """A figure with so many panels for curves."""
    wide = 1 if count == 1 else 2
    tall = -(-count // wide)
    figure, axes = plt.subplots(tall, wide, figsize=(4.4 * wide + 0.6, 3.0 * tall), squeeze=False, layout="constrained")
    for panel in axes.flat[count:]:
        panel.set_visible(False)
    return figure, axes.flat[:count]


def wanted_curves(run):
    plots = [(p["name"], p.get("against", "time"), p.get("unit")) for p in run.record.get("plots", [])]
    plots = [p for p in plots if p[0] in run.history and p[1] in run.history]
    return plots or [(name, "time", None) for name in run.history if name != "time" and not name.startswith("energy ")]


def plot_curves(run):
    plots = wanted_curves(run)
    if not plots:
        return None
    figure, panels = panels_for(len(plots))
    for panel, plot in zip(panels, plots):
        draw_curves(panel, [run], *plot)
        y = run.history[plot[0]]
        if np.isfinite(y).any():
            peak = int(np.nanargmax(np.abs(y)))
            line = panel.lines[0]
            panel.plot(line.get_xdata()[peak], line.get_ydata()[peak], "o", ms=4, color=COLOURS[1])
            unit = panel.get_ylabel().partition("[")[2].rstrip("]")
            panel.set_title(f"peak {line.get_ydata()[peak]:.4g} {unit}", loc="right", fontsize=8, color="#555555")
    return save(figure, run, "curves.png")


def plot_energy(run):
    terms = {name[7:]: values for name, values in run.history.items() if name.startswith("energy ")}
    if not terms:
        return None
    time = run.history["time"]
    t_factor, t_unit = prefixed(time, "s")
    largest = max(np.nanmax(np.abs(v), initial=0) for v in terms.values())
    factor, unit = prefixed(np.array([largest]), "J")
    order = [name for name in LEDGER if name in terms]
    order += [name for name in terms if name not in LEDGER + ["external", "residual"]]
    shown = [name for name in order if np.nanmax(np.abs(terms[name]), initial=0) > 1e-4 * largest]
    stacked = all(np.nanmin(terms[name], initial=0) >= -1e-3 * largest for name in shown)

    figure, (top, low) = plt.subplots(2, 1, figsize=(6.6, 5.2), sharex=True, height_ratios=[3.2, 1],
                                      layout="constrained")
    if stacked and shown:
        top.stackplot(time * t_factor, [np.maximum(terms[n], 0) * factor for n in shown],
                      labels=[n.replace("_", " ") for n in shown],
                      colors=[ENERGY_COLOURS.get(n, "#003F5C") for n in shown], alpha=0.85, linewidth=0)
    else:
        for n in shown:
            top.plot(time * t_factor, terms[n] * factor, label=n.replace("_", " "), color=ENERGY_COLOURS.get(n, "#003F5C"))
    if "external" in terms:
        start = sum(terms[n][0] for n in shown) if len(time) and stacked else 0
        name = "work done from outside" if abs(start) < 1e-6 * largest else "at the start + work done from outside"
        top.plot(time * t_factor, (terms["external"] + start) * factor, "k--", lw=1.2, label=name)
    top.set_ylabel(f"energy [{unit}]")
    handles, names = top.get_legend_handles_labels()
    order = -1 if stacked else 1                                           # a stack grows upward
    top.legend(handles[::order], names[::order], loc="center left", bbox_to_anchor=(1.0, 0.5))
    top.margins(x=0.01)
    if "residual" in terms and largest > 0:
        low.plot(time * t_factor, 100 * terms["residual"] / largest, color="#444444", lw=1)
    low.axhline(0, color="#999999", lw=0.6)
    low.set_ylabel("residual\n[% of largest]")
    low.set_xlabel(label("time", t_unit))
    figure.align_ylabels()
    return save(figure, run, "energy.png")


# ------------------------------------------------------------------------------------------------------- crack pattern

def project(points, azimuth=-55, elevation=24):
    """Orthographic view with y upward: coordinates on the paper, and depth towards the reader."""
    a, e = np.radians(azimuth), np.radians(elevation)
    right = np.array([np.cos(a), 0, np.sin(a)])
    toward = np.array([-np.sin(a) * np.cos(e), np.sin(e), np.cos(a) * np.cos(e)])
    up = np.cross(toward, right)
    return points @ np.stack([right, up], 1), points @ toward, toward


def slice_tets(points, cells, height):
    """The plane z = height through tetrahedra: polygons of 3 or 4 points (x, y), and the cell of each."""
    corners = points[cells]
    above = corners[:, :, 2] > height
    polygons, owner = [], []
    for lone_above in (True, False):                                       # one corner on its own side: a triangle
        for a in range(4):
            others = [b for b in range(4) if b != a]
            found = np.flatnonzero((above[:, a] == lone_above) & (above[:, others] != lone_above).all(axis=1))
            cut = np.stack([cross(corners[found, a], corners[found, b], height) for b in others], 1)
            polygons.append(np.concatenate([cut, cut[:, 2:]], 1))
            owner.append(found)
    for a, b, c, d in ((0, 1, 2, 3), (0, 2, 1, 3), (0, 3, 1, 2)):          # two and two: a quadrilateral
        paired = (above[:, a] == above[:, b]) & (above[:, c] == above[:, d]) & (above[:, a] != above[:, c])
        found = np.flatnonzero(paired)
        around = ((a, c), (a, d), (b, d), (b, c))
        polygons.append(np.stack([cross(corners[found, p], corners[found, q], height) for p, q in around], 1))
        owner.append(found)
    return np.concatenate(polygons), np.concatenate(owner)


def cross(p, q, height):
    share = (height - p[:, 2]) / (q[:, 2] - p[:, 2])
    return (p + share[:, None] * (q - p))[:, :2]


def slice_triangles(triangles, height):
    """The plane z = height through triangles: segments, and the triangle of each."""
    above = triangles[:, :, 2] > height
    segments, owner = [], []
    for a in range(3):
        b, c = (a + 1) % 3, (a + 2) % 3
        found = np.flatnonzero((above[:, a] != above[:, b]) & (above[:, a] != above[:, c]))
        segments.append(np.stack([cross(triangles[found, a], triangles[found, q], height) for q in (b, c)], 1))
        owner.append(found)
    return np.concatenate(segments), np.concatenate(owner)


class Panels:
    """The crack pattern of one run: drawn once, then moved from frame to frame."""

    def __init__(self, run, field, figure, axes, last):
        self.run, self.field, self.axes = run, field, axes
        self.length, self.length_unit = prefixed(np.ptp(last.points, axis=0), "m")
        back, front = last.points[:, 2].min(), last.points[:, 2].max()
        self.middle = 0.5 * (back + front) + 0.003 * (front - back)         # beside the middle, where grids have nodes
        self.norm = self.field_range(last)
        self.map = PIECE_MAP if field == "fragment" else FIELD_MAP if len(last.cracks.points) else WHOLE_MAP
        flat = axes[-1]
        dense = len(run.mesh.types) > (8000 if run.dimension == 2 else 60000)
        outlined = run.dimension == 2 and not dense                          # a slice's polygons are parts of cells
        self.body = PolyCollection([], cmap=self.map, norm=self.norm, edgecolors="#C9C9C4" if outlined else "face",
                                   linewidths=0.25, antialiased=outlined)
        self.edges = LineCollection([], colors="#C9C9C4", linewidths=0 if dense else 0.25)
        self.outline = LineCollection([], colors="#555555", linewidths=0.6)
        self.cracks = LineCollection([], cmap=MODE_MAP, norm=Normalize(0, 1), capstyle="round", zorder=3)
        self.rigid = PolyCollection([], facecolors=RIGID, edgecolors=RIGID_EDGE, linewidths=1, zorder=0)  # plates, and walls as lines
        for artist in (self.rigid, self.body, self.edges, self.outline, self.cracks):
            flat.add_collection(artist)
        self.held, = flat.plot([], [], linestyle="none", marker="^", ms=3, color=RIGID_EDGE, zorder=4)
        if run.dimension == 3:
            self.skin = PolyCollection([], edgecolors="none", antialiased=False)
            self.ghost = PolyCollection([], facecolors="#EDEDEA", edgecolors="#EDEDEA", linewidths=0.5)
            self.faces = PolyCollection([], cmap=MODE_MAP, norm=Normalize(0, 1), edgecolors="face", linewidths=0.15,
                                        zorder=3)
            self.rigid_edges = LineCollection([], colors=RIGID_EDGE, linewidths=0.8, zorder=0)
            axes[0].add_collection(self.rigid_edges)
            axes[0].add_collection(self.skin)
            axes[0].set_title("surface")
            if len(axes) == 3:
                axes[1].add_collection(self.ghost)
                axes[1].add_collection(self.faces)
                axes[1].set_title("crack faces")
            flat.set_title(f"slice z = {round(self.middle * self.length, 1):g} {self.length_unit}".replace("-0 ", "0 "))
        self.limits(last)
        for panel in axes:
            panel.set_aspect("equal")
            panel.grid(False)
            if panel is flat:
                panel.set_xlabel(label("x", self.length_unit))
                panel.set_ylabel(label("y", self.length_unit))
            else:
                panel.set_axis_off()

    def field_range(self, last):
        if not self.field:
            return Normalize(0, 1)
        if self.field == "damage":
            return Normalize(0, 1)
        if self.field == "fragment":
            return Normalize(-0.5, PIECE_MAP.N - 0.5)
        some = np.unique(np.linspace(0, len(self.run.frames) - 1, 6).astype(int))
        samples = np.concatenate([self.run.frames[i].cell_values(self.field) for i in some])
        samples = samples[np.isfinite(samples)]
        if self.field == "plastic_strain":
            return Normalize(0, np.percentile(samples, 99.5) or 1)
        low, high = (np.percentile(samples, (2, 98)) if len(samples) else (0, 1))
        return Normalize(low, high if high > low else low + 1)

    def limits(self, last):
        first = self.run.frames[0]
        for panel in self.axes:
            view = (lambda points: points[:, :2]) if panel is self.axes[-1] else (lambda points: project(points)[0])
            start, end = (self.length * view(frame.points) for frame in (first, last))
            rare = 1 if len(last.cracks.points) else 0                            # splinters may fly out of the picture
            low = np.minimum(start.min(axis=0), np.percentile(end, rare, axis=0))
            high = np.maximum(start.max(axis=0), np.percentile(end, 100 - rare, axis=0))
            pad = (0.08 if len(last.rigid) else 0.04) * (high - low).max()
            panel.set_xlim(low[0] - pad, high[0] + pad)
            panel.set_ylim(low[1] - pad, high[1] + pad * (3.5 if panel is self.axes[-1] else 1))  # room for the legend

    def show(self, frame):
        run, scale = self.run, self.length
        values = frame.cell_values(self.field) if self.field else np.zeros(len(run.mesh.types))
        if run.dimension == 2:
            polygons, owner = frame.points[run.polygons()][:, :, :2], slice(None)
            segments, crack = frame.cracks.points[:, :, :2], slice(None)
            self.outline.set_segments(frame.points[np.concatenate([run.boundary, run.interfaces])][:, :, :2] * scale)
        else:
            parts, cell = run.tetrahedra()
            polygons, owner = slice_tets(frame.points, parts, self.middle)
            owner = cell[owner]
            segments, crack = slice_triangles(frame.cracks.points, self.middle)
            if self.edges.get_linewidth()[0] > 0:
                self.edges.set_segments(slice_triangles(frame.points[run.face_triangles()], self.middle)[0] * scale)
            outer, _ = slice_triangles(frame.points[np.concatenate([run.boundary, run.interfaces])], self.middle)
            self.outline.set_segments(outer * scale)
            self.show_3d(frame, values)
        rigid = frame.rigid[:, :4, :2]
        held = frame.points[run.mesh.held]
        if run.dimension == 3:
            rigid = rigid[(frame.rigid[:, :, 2].min(axis=1) <= self.middle) & (frame.rigid[:, :, 2].max(axis=1) >= self.middle)]
            near = 0.1 * max(np.ptp(frame.points[:, 2]), 1e-300)
            held = held[np.abs(held[:, 2] - self.middle) < near]
        self.rigid.set_verts(rigid * scale)
        self.held.set_data(*(held[:, :2].T * scale))
        self.body.set_verts(polygons * scale)
        self.body.set_array(values[owner])
        self.cracks.set_segments(segments * scale)
        self.cracks.set_array(frame.cracks.mode[crack])
        broken = frame.cracks.damage[crack] >= 1
        longest = max(np.ptp(self.axes[-1].get_xlim()), np.ptp(self.axes[-1].get_ylim()))
        usual = np.median(np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1)) * scale if len(segments) else longest
        width = np.clip(100 * usual / longest, 0.7, 1.8)                  # or lines on a fine mesh run together
        self.cracks.set_linewidths(np.where(broken, width, 0.45 * width))

    def show_3d(self, frame, values):
        run, scale = self.run, self.length
        seen, depth, toward = project(frame.points)
        corners = frame.points[run.boundary]
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]
        facing = normal @ toward > 0
        faces, cell, normal = run.boundary[facing], run.boundary_cell[facing], normal[facing]
        light = np.array([-0.35, 0.75, 0.55]) / np.linalg.norm([-0.35, 0.75, 0.55])
        shade = 0.62 + 0.38 * np.clip(normal @ light, 0, 1)
        colours = self.map(self.norm(values[cell]))
        colours[:, :3] *= shade[:, None]
        cracks, crack_depth, _ = project(frame.cracks.points.reshape(-1, 3))
        cracks, crack_depth = cracks.reshape(-1, 3, 2), crack_depth.reshape(-1, 3).mean(axis=1)
        skin_depth = depth[faces].mean(axis=1)
        order = np.argsort(np.concatenate([skin_depth, crack_depth]))         # the far ones first
        edges = np.concatenate([frame.rigid[:, edge] for edge in BOX_EDGES]) if len(frame.rigid) else np.empty((0, 2, 3))
        self.rigid_edges.set_segments(project(edges.reshape(-1, 3))[0].reshape(-1, 2, 2) * scale)
        self.skin.set_verts(np.concatenate([seen[faces], cracks])[order] * scale)
        self.skin.set_facecolor(np.concatenate([colours, MODE_MAP(frame.cracks.mode)])[order])
        self.ghost.set_verts(seen[faces] * scale)
        order = np.argsort(crack_depth)
        self.faces.set_verts(cracks[order] * scale)
        self.faces.set_array(frame.cracks.mode[order])


def crack_figure(run, field, with_curve=None):
    last = run.frames[-1]
    size = np.maximum(np.ptp(last.points, axis=0), 1e-300)
    aspect = float(np.clip(size[1] / size[0], 0.25, 3.0))
    cracked = len(last.cracks.points) > 0
    count = 1 if run.dimension == 2 else 3 if cracked else 2
    width = {1: 5.2, 2: 8, 3: 11.5}[count]
    panel = (width - 1.0) / count
    height = float(np.clip(panel * aspect, 2.0, 7.0))
    rows = [height, 1.5] if with_curve else [height]
    figure = plt.figure(figsize=(width, sum(rows) + 1.3), layout="constrained")
    grid = figure.add_gridspec(len(rows), count, height_ratios=rows)
    axes = [figure.add_subplot(grid[0, i]) for i in range(count)]
    panels = Panels(run, field, figure, axes, last)
    beside = {"orientation": "horizontal", "shrink": 0.9, "aspect": 36 if count == 1 else 44, "pad": 0.03}
    if cracked:
        bar = figure.colorbar(ScalarMappable(Normalize(0, 1), MODE_MAP), ax=axes[: max(1, count - 1)], ticks=[0, 0.5, 1],
                              **beside)
        bar.ax.set_xticklabels(["opening (I)", "mixed", "slip (II)" if count == 1 else "slip (II, III)"])
        bar.set_label(MODE_TITLE)
    if field and field != "fragment":
        factor, unit = prefixed(np.array([panels.norm.vmin, panels.norm.vmax]), last.units[field])
        shown = ScalarMappable(Normalize(panels.norm.vmin * factor, panels.norm.vmax * factor), panels.map)
        beside["aspect"] = 22 if count == 3 else 36
        bar = figure.colorbar(shown, ax=axes[-1:] if cracked else axes, extend="neither" if field == "damage" else "both", **beside)
        bar.set_label(label(FIELD_TITLES.get(field, "largest principal stress" if field == "stress" else field), unit))
    widths = {"broken": 1.8, "softening": 0.8}
    keys = [Line2D([], [], color="#555555", lw=width, label=name) for name, width in widths.items()]
    if cracked:
        axes[-1].legend(handles=keys, loc="upper right", ncols=2, handlelength=1.4, borderaxespad=0.1)
    curve = figure.add_subplot(grid[1, :]) if with_curve else None
    return figure, panels, curve


def show_time(figure, frame):
    factor, unit = prefixed(np.array([frame.time]), "s")
    figure.suptitle(f"t = {frame.time * factor:.4g} {unit}", fontsize=10, x=0.02, ha="left")


def plot_fragments(run):
    """Share of the mass in pieces below a mass, as sieves tell it; None where nothing broke."""
    masses = np.sort(run.record.get("fragments", {}).get("masses [kg]", []))
    if len(masses) < 2:
        return None
    figure, axes = plt.subplots(figsize=(5.2, 3.6), layout="constrained")
    axes.step(masses, np.cumsum(masses) / masses.sum(), where="post")
    axes.plot(masses, np.cumsum(masses) / masses.sum(), "o", ms=3, color=COLOURS[0])
    axes.set(xscale="log", xlabel="mass of a piece [kg]", ylabel="share of the mass in pieces no heavier", ylim=(0, 1.02),
             title=f"{run.record['fragments']['count']} pieces")
    return save(figure, run, "fragments.png")


def plot_cracks(run, field):
    figure, panels, _ = crack_figure(run, field)
    frame = run.frames[-1]
    panels.show(frame)
    show_time(figure, frame)
    return save(figure, run, "cracks.png")


def plot_animation(run, field, most):
    if len(run.frames) < 2:
        return None
    curves = wanted_curves(run) if run.history else []
    curve = next((c for c in curves if c[1] == "time"), None)
    figure, panels, below = crack_figure(run, field, with_curve=curve)
    if curve:
        x_factor, y_factor = draw_curves(below, [run], *curve)
        dot, = below.plot([], [], "o", color=COLOURS[1], ms=5)
    writer = PillowWriter(fps=12)
    with writer.saving(figure, run.path("animation.gif.part.gif"), dpi=90 if run.dimension == 2 else 75):
        for number in np.unique(np.linspace(0, len(run.frames) - 1, most).astype(int)):
            frame = run.frames[number]
            panels.show(frame)
            show_time(figure, frame)
            if curve:
                value = np.interp(frame.time, run.history["time"], run.history[curve[0]])
                dot.set_data([frame.time * x_factor], [value * y_factor])
            writer.grab_frame()
            if number == 0:
                figure.set_layout_engine("none")                           # the panels stay where they are
        for _ in range(12):
            writer.grab_frame()
    plt.close(figure)
    os.replace(run.path("animation.gif.part.gif"), run.path("animation.gif"))
    return run.path("animation.gif")


def save(figure, run, name):
    verdict = run.record.get("verdict", {})
    if verdict.get("grade", "ok") != "ok":                                 # docs/verdict.md
        words = ", ".join(dict.fromkeys(reason["what"] for reason in verdict["reasons"]))
        if figure.get_layout_engine():
            figure.get_layout_engine().set(rect=(0, 0.03, 1, 0.97))        # room below for the words
        figure.text(0.01, 0.005, f"{verdict['grade']}: {words}", fontsize=7, va="bottom", color="#B3261E" if verdict["grade"] == "do not trust" else "#8A5A00")
    figure.savefig(run.path(name))
    plt.close(figure)
    return run.path(name)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folder", help="the folder of a run")
    parser.add_argument("--field", help="what the body is coloured by (default: the largest principal stress)")
    parser.add_argument("--only", default="curves,energy,cracks,fragments,animation", help="which pictures, separated by commas")
    parser.add_argument("--frames", type=int, default=60, help="most frames of the animation")
    asked = parser.parse_args()
    run = Run(asked.folder)
    only = asked.only.split(",")
    unknown = set(only) - {"curves", "energy", "cracks", "fragments", "animation"}
    if unknown:
        fail(f'unknown picture "{sorted(unknown)[0]}" (there are curves, energy, cracks, fragments, animation)')
    field = choose_field(run, asked.field) if run.frames else None
    pictures = [plot_curves(run) if "curves" in only and run.history else None,
                plot_energy(run) if "energy" in only and run.history else None,
                plot_cracks(run, field) if "cracks" in only and run.frames else None,
                plot_fragments(run) if "fragments" in only else None,
                plot_animation(run, field, max(2, asked.frames)) if "animation" in only and run.frames else None]
    for picture in filter(None, pictures):
        print(picture)


if __name__ == "__main__":
    try:
        main()
    except (OSError, KeyError, ValueError) as error:
        fail(str(error))
