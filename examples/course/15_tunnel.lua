-- Course 15: a tunnel.  Rock is under pressure before anybody digs: body{ stress = ... }. At t = 0 the tunnel is there, at once; its wall springs inwards, and
-- the waves that this sends out leave through absorbing boundaries, so that what stays is the state at rest. (A little viscosity takes waves shorter
-- than the cells far away can carry; they would stay about the tunnel.)
-- Theory (Kirsch 1898): r from the middle, beside the tunnel  -yy = (h + v)/2 (1 + (a/r)^2) - (h - v)/2 (1 + 3 (a/r)^4), and above it  -xx  with h and v changed;
-- at the wall itself 3 v - h beside it and 3 h - v above it.
-- Question: rock hardly bears tension. For which ratio h/v does the roof (r = a) begin to crack?  And why does the wall feel more than this, for a moment?
-- Now change: --set h=2 and h=10; then leave the absorb{} lines out, and look at the curve of "beside".
-- test 2d:
-- test 3d: --set far=3 --set near=0.5
local h    = param{ "h", 5, "pressure from the sides (MPa)", least = 0, most = 50 }*MPa
local v    = param{ "v", 10, "pressure from above (MPa)", least = 0, most = 50 }*MPa
local far  = param{ "far", 2, "element size far from the tunnel (m)", least = 0.5, most = 5 }
local near = param{ "near", 0.2, "element size at the tunnel (m)", least = 0.05, most = 2 }
local a, W, t = 2, 40, 1

local rock = material{ "rock", density = 2700, elastic = { young = 50*GPa, poisson = 0.25, damping = { share = 0.05 } } }
local ground = body{ "ground", shape = difference{ box{ size = { W, W, t } }, disc{ radius = a, thickness = 2*t } }, material = rock,
  mesh = { size = far, near = { from = { 0, 0 }, radius = 1.5*a, size = near } },
  stress = { xx = -h, yy = -v, zz = -0.25*(h + v) } }
for _, side in ipairs{ "left", "right" } do pressure{ ground, at = side, value = h } absorb{ ground, at = side } end
for _, side in ipairs{ "bottom", "top" } do pressure{ ground, at = side, value = v } absorb{ ground, at = side } end
for _, side in ipairs{ "front", "back" } do hold{ ground, at = side, velocity = { nil, nil, 0 } } end   -- a slice of a long tunnel

local r = 1.25*a
measure{ "beside", unit = "MPa", function(now) return -now.stress(ground, { r, 0 }).yy/MPa end }
measure{ "above", unit = "MPa", function(now) return -now.stress(ground, { 0, r }).xx/MPa end }
measure{ "roof", unit = "mm", function(now) return now.displacement(ground, { 0, a }).y/mm end }
plot{ "beside" }
plot{ "roof" }
output{ every = 5*ms, fields = { "principal", "stress" } }
run{ time = 40*ms }

local function kirsch(h, v) return ((h + v)/2*(1 + (a/r)^2) - (h - v)/2*(1 + 3*(a/r)^4))/MPa end
expect{ "beside", of = "last", equals = kirsch(h, v), tolerance = 0.06*kirsch(h, v), why = "Kirsch; cells have one stress each, and the ground ends at 10 radii" }
expect{ "above", of = "last", equals = kirsch(v, h), tolerance = 0.06*kirsch(h, v), why = "Kirsch" }
expect{ "energy that left over what the wall gave", value = function(now) return now.energy("kinetic")/math.abs(now.energy("external")) end, within = { 0, 0.01 }, why = "waves have left: it is at rest" }
