-- Course 15: a tunnel.  Rock is under pressure before anybody digs: body{ stress = ... }. At t = 0 the tunnel is there, at once; its wall springs inwards, and
-- the waves that this sends out leave through absorbing boundaries, so that what stays is the state at rest. (A little viscosity takes waves shorter
-- than the cells far away can carry; they would stay about the tunnel.)
-- Theory (Kirsch 1898): r from the middle, beside the tunnel  -yy = (h + v)/2 (1 + (a/r)^2) - (h - v)/2 (1 + 3 (a/r)^4), and above it  -xx  with h and v interchanged;
-- at the wall itself 3 v - h beside it and 3 h - v above it.
-- Question: rock hardly bears tension. For which ratio h/v is the roof (r = a) pulled?  (The curve "crown" is of the first 0.2 m of rock above it; tension is positive.)
-- And why does the wall feel more than at rest, for a moment?
-- Now change: --set h=2 and h=10 (then it is the same everywhere); then --set absorb=0, and look at the curve of "beside".
-- test 2d:
-- test 3d: --set far=3 --set near=0.5
local h    = param{ "h", 5, "pressure from the sides (MPa)", least = 0, most = 50 }*MPa
local v    = param{ "v", 10, "pressure from above (MPa)", least = 0, most = 50 }*MPa
local far  = param{ "far", 2, "element size far from the tunnel (m)", least = 0.5, most = 5 }
local near = param{ "near", 0.2, "element size at the tunnel (m)", least = 0.05, most = 2 }
local absorbing = param{ "absorb", 1, "1: waves leave by the sides of the ground; 0: they come back", least = 0, most = 1 } == 1
local a, W, t = 2, 40, 1

local rock = material{ "rock", density = 2700, elastic = { young = 50*GPa, poisson = 0.25, damping = { share = 0.05 } } }
local ground = body{ "ground", shape = difference{ box{ size = { W, W, t } }, disc{ radius = a, thickness = 2*t } }, material = rock,
  mesh = { size = far, near = { from = { 0, 0 }, radius = 1.5*a, size = near } },
  stress = { xx = -h, yy = -v, zz = -0.25*(h + v) } }
for side, value in pairs{ left = h, right = h, bottom = v, top = v } do
  pressure{ ground, at = side, value = value }
  if absorbing then absorb{ ground, at = side } end
end
for _, side in ipairs{ "front", "back" } do hold{ ground, at = side, velocity = { nil, nil, 0 } } end   -- a slice of a long tunnel

local r = 1.25*a
measure{ "beside", unit = "MPa", function(now) return -now.stress(ground, { r, 0 }).yy/MPa end }
measure{ "above", unit = "MPa", function(now) return -now.stress(ground, { 0, r }).xx/MPa end }
measure{ "crown", unit = "MPa", function(now)
  return now.average("xx", ground, function(x, y) return math.abs(x) < 0.15*a and y > 0 and y < 1.1*a end)/MPa
end }
measure{ "roof", unit = "mm", function(now) return now.displacement(ground, { 0, a }).y/mm end }
plot{ "beside" }
plot{ "roof" }
output{ every = 5*ms, fields = { "principal", "stress" } }
run{ time = 40*ms }

local function kirsch(h, v) return ((h + v)/2*(1 + (a/r)^2) - (h - v)/2*(1 + 3*(a/r)^4))/MPa end
expect{ "beside", of = "last", equals = kirsch(h, v), tolerance = 0.06*kirsch(h, v), why = "Kirsch; cells have one stress each, and the ground ends at 10 radii" }
expect{ "above", of = "last", equals = kirsch(v, h), tolerance = 0.06*kirsch(h, v), why = "Kirsch" }
expect{ "motion that is left, over the work", value = function(now) return now.energy("kinetic")/math.abs(now.energy("external")) end, within = { 0, 1e-4 }, why = "waves have left: it is at rest" }
