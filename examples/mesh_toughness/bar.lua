-- A strip of concrete is pulled apart: what the mesh adds to strength and to work of fracture (docs/studies/mesh.md).
-- It is short enough that its softening is stable, and held along x only: each section carries the same force. Two
-- notches choose where it breaks; a grid knows boxes only: there the bar is as wide as what notches leave.
-- test 2d: --set stop=0.002
-- test 3d: none
local h         = param("h", 3.5*mm, "element size (m)")
local seed      = param("seed", 0, "another number, another mesh")
local seam      = param{ "seam", 0, "1: element faces straight across the middle", least = 0, most = 1 }
local irregular = param("irregular", 0, "how far inner nodes are moved at random, share of an edge")
local grid      = param{ "grid", 0, "1: a regular grid", least = 0, most = 1 }
local blocks    = param{ "blocks", 0, "1: quadrilaterals", least = 0, most = 1 }
local classical = param{ "independent", 0, "1: opening and slip each have their full strength", least = 0, most = 1 }
local traction  = param{ "traction", 0, "1: joints begin by the traction on their own faces alone", least = 0, most = 1 }
local stop      = param("stop", 0.2, "lengthening at the end (mm)")
local ft, E, G1 = 3.9*MPa, 37*GPa, 80*J/m2
local length, ligament, depth, b, v = 50*mm, 20*mm, 2.5*mm, 50*mm, 0.15

local concrete = material{ "concrete", density = 2346, elastic = { young = E, poisson = 0.2 },
  fracture = { tension = ft, shear = 12*MPa, friction_angle = 35*deg, G1 = G1, G2 = 10*G1, penalty = 20*E,
               softening = { { 0, ft }, { 9.615e-6, ft/4 }, { 1.2564e-4, 0 } }, shear_softening = "linear",
               mixed = classical == 1 and "independent" or "ellipse",
               criterion = (classical == 1 or traction == 1) and "traction" or "rankine" },
  contact = { penalty = E, friction = 0.3 } }
local function notch(side)
  local edge, tip = side*(ligament/2 + depth), side*ligament/2
  return polygon{ points = { { -1*mm, edge + side*mm }, { 1*mm, edge + side*mm }, { 0, tip } }, thickness = 2*b }
end
local whole = box{ size = { length, ligament + 2*depth, b } }
local bar = body{ "bar", material = concrete,
  shape = grid == 1 and box{ size = { length, ligament, b } } or difference{ whole, notch(1), notch(-1) },
  mesh = { size = h, seed = seed, irregular = irregular, structured = grid == 1,
           cells = blocks == 1 and "block" or "simplex",
           seam = seam == 1 and { from = { 0, -ligament/2 }, to = { 0, ligament/2 } } or nil } }
hold{ bar, at = "left", velocity = { 0 } }
local grip = hold{ bar, at = "right", velocity = { function(t) return v*math.min(1, t/(1*ms)) end } }
assume{ two_d = "plane stress", thickness = b }
measure{ "load", unit = "N", function(now) return math.abs(now.reaction(grip, "x")) end }
measure{ "opening", unit = "mm", function(now)
  return (now.displacement(bar, { length/2, 0 }).x - now.displacement(bar, { -length/2, 0 }).x)/mm
end }
measure{ "crack", unit = "m2", function(now) return now.crack_area() end }
plot{ "load", against = "opening" }
run{ time = 0.5*ms + (stop + 0.01)*mm/v, mass_damping = 2e3, stop = function(now) return now.opening > stop end }
