-- A notched beam of concrete over three points, as in docs/which_law.md: what the mesh adds (docs/studies/mesh.md).
-- test 2d:
-- test 3d: none
local h         = param("h", 5*mm, "element size (m)")
local seed      = param("seed", 0, "another number, another mesh")
local seam      = param{ "seam", 0, "1: element faces above the notch", least = 0, most = 1 }
local irregular = param("irregular", 0, "how far inner nodes are moved at random, share of an edge")
local blocks    = param{ "blocks", 0, "1: quadrilaterals", least = 0, most = 1 }
local classical = param{ "independent", 0, "1: opening and slip each have their full strength", least = 0, most = 1 }
local traction  = param{ "traction", 0, "1: joints begin by the traction on their own faces alone", least = 0, most = 1 }
local stop      = param("stop", 0.2, "mouth opening at the end (mm)")
local ft, E, G1 = 3.9*MPa, 37*GPa, 80*J/m2
local depth, b, a, span, v = 50*mm, 50*mm, 25*mm, 125*mm, 0.06

local concrete = material{ "concrete", density = 2346, elastic = { young = E, poisson = 0.2 },
  fracture = { tension = ft, shear = 12*MPa, friction_angle = 35*deg, G1 = G1, G2 = 10*G1, penalty = 20*E,
               softening = { { 0, ft }, { 9.615e-6, ft/4 }, { 1.2564e-4, 0 } }, shear_softening = "linear",
               mixed = classical == 1 and "independent" or "ellipse",
               criterion = (classical == 1 or traction == 1) and "traction" or "rankine" },
  contact = { penalty = E, friction = 0.3 } }
local notch = polygon{ points = { { -1*mm, -1*mm }, { 1*mm, -1*mm }, { 0, a } }, thickness = 2*b }
local beam = body{ "beam", shape = difference{ box{ size = { 175*mm, depth, b }, center = { 0, depth/2 } }, notch },
  material = concrete,
  mesh = { size = h, seed = seed, irregular = irregular, cells = blocks == 1 and "block" or "simplex",
           seam = seam == 1 and { from = { 0, a }, to = { 0, depth } } or nil } }
local function roller(x, y) return box{ size = { 6*mm, 6*mm, 2*b }, center = { x, y } } end
local smooth = { penalty = E, friction = 0 }
plate{ "left",  box = roller(-span/2, -3*mm), contact = smooth }
plate{ "right", box = roller( span/2, -3*mm), contact = smooth }
local top = plate{ "top", box = roller(0, depth + 3*mm), contact = smooth,
                   velocity = { 0, function(t) return -v*math.min(1, t/(1*ms)) end } }
assume{ two_d = "plane stress", thickness = b }
measure{ "load", unit = "N", function(now) return now.force(top) end }
measure{ "opening", unit = "mm", function(now)   -- of the mouth of the notch
  return (now.displacement(beam, { 1*mm, 0 }).x - now.displacement(beam, { -1*mm, 0 }).x)/mm
end }
measure{ "crack", unit = "m2", function(now) return now.crack_area() end }
plot{ "load", against = "opening" }
run{ time = 10*ms, mass_damping = 2e3, stop = function(now) return now.opening > stop end }
