-- A disc is split between two plates: what the mesh adds to its strength (docs/studies/mesh.md).
-- test 2d: --set time=5e-5
-- test 3d: none
local h         = param("h", 2*mm, "element size (m)")
local seed      = param("seed", 0, "another number, another mesh")
local seam      = param{ "seam", 0, "1: element faces along the loaded diameter", least = 0, most = 1 }
local irregular = param("irregular", 0, "how far inner nodes are moved at random, share of an edge")
local blocks    = param{ "blocks", 0, "1: quadrilaterals", least = 0, most = 1 }
local classical = param{ "independent", 0, "1: opening and slip each have their full strength", least = 0, most = 1 }
local traction  = param{ "traction", 0, "1: joints begin by the traction on their own faces alone", least = 0, most = 1 }
local G1        = param("G1", 5*J/m2, "fracture energy of opening (J/m2)")
local demand    = param{ "demand", 0, "1: joints are inserted on demand", least = 0, most = 1 }
local time      = param("time", 1.2*ms, "longest simulated time (s)")
local ft, E, R, v = 3*MPa, 50*GPa, 25*mm, 0.1

local rock = material{ "rock", density = 2700, elastic = { young = E, poisson = 0.25 },
  fracture = { tension = ft, shear = 5*ft, friction_angle = 50*deg, G1 = G1, G2 = 10*G1, penalty = 10*E,
               softening = "linear", insertion = demand == 1 and "adaptive" or "intrinsic", mixed = classical == 1 and "independent" or "ellipse",
               criterion = (classical == 1 or traction == 1) and "traction" or "rankine" },
  contact = { penalty = E, friction = 0.1 } }
local disc = body{ "disc", shape = disc{ radius = R, thickness = 25*mm }, material = rock,
  mesh = { size = h, seed = seed, irregular = irregular, cells = blocks == 1 and "block" or "simplex",
           seam = seam == 1 and { from = { 0, -R }, to = { 0, R } } or nil } }
local function slow(sign) return { 0, function(t) return sign*v*math.min(1, t/(0.1*ms)) end } end
local top    = plate{ "top",    above(disc), velocity = slow(-1) }
local bottom = plate{ "bottom", below(disc), velocity = slow(1) }
assume{ two_d = "plane stress" }
measure{ "load", unit = "N", function(now) return (now.force(top) + now.force(bottom))/2 end }
measure{ "opening", unit = "mm", function(now)   -- widening across the loaded diameter
  return (now.displacement(disc, { R, 0 }).x - now.displacement(disc, { -R, 0 }).x)/mm
end }
measure{ "crack", unit = "m2", function(now) return now.crack_area() end }
plot{ "load", against = "opening" }
run{ time = time, mass_damping = 2e4, stop = function(now)
  return now.peak("load") > 2000 and now.load < 0.7*now.peak("load")
end }
