-- Course 7: a tension test made of pressure.  A disc between two plates splits from top to bottom.
-- Theory (Hertz 1883): pressed by F, the middle of a disc is pulled across by 2 F/(pi D t) and pressed by three times that.
-- Question: is the strength that the test tells, 2 F/(pi D t) at the peak, that of the rock?
-- Now change: --set G1=5 and 1. Tough rock looks stronger (docs/studies/mesh.md, process zone). Then five seeds: how large is the scatter of a mesh?
-- test 2d:
-- test 3d: --set t=3
local h    = param{ "h", 2, "element size (mm)", least = 0.5, most = 5 }
local G1   = param{ "G1", 2, "fracture energy of opening (J/m2)", least = 0.5, most = 50 }
local seed = param("seed", 0, "another number, another mesh")
local thick = param{ "t", 25, "thickness (mm)", least = 1, most = 100 }
local ft, E, R, t, v = 3*MPa, 50*GPa, 25*mm, thick*mm, 0.1

local rock = material{ "rock", density = 2700, elastic = { young = E, poisson = 0.25 },
  fracture = { tension = ft, shear = 5*ft, friction_angle = 50*deg, G1 = G1, G2 = 10*G1, penalty = 10*E, softening = "linear", insertion = "adaptive" },
  contact = { penalty = E, friction = 0.1 } }
local disc = body{ "disc", shape = disc{ radius = R, thickness = t }, mesh = { size = h*mm, seed = seed }, material = rock }
local down, up = ramp{ to = -v, over = 0.1*ms }, ramp{ to = v, over = 0.1*ms }
local top, bottom = plate{ "top", above(disc), velocity = { 0, down } }, plate{ "bottom", below(disc), velocity = { 0, up } }
assume{ two_d = "plane stress" }

measure{ "strength", unit = "MPa", function(now) return (now.force(top) + now.force(bottom))/(math.pi*2*R*t)/MPa end }
measure{ "widening", unit = "um", function(now) return (now.displacement(disc, { R, 0 }).x - now.displacement(disc, { -R, 0 }).x)/um end }
plot{ "strength", against = "widening" }
output{ every = 50*us, fields = { "principal", "damage" } }
run{ time = 1*ms, mass_damping = 2e4, stop = function(now) return now.peak("strength") > 2 and now.strength < 0.6*now.peak("strength") end }
expect{ "strength over ft", value = function(now) return now.peak("strength")*MPa/ft end, within = { 0.95, 1.2 }, why = "1 for a brittle rock and a fine mesh" }
