-- A ring flies apart: every point moves outwards at the same speed, until it breaks into pieces.
local size = param("size", dim == 2 and 0.7*mm or 1.2*mm, "of elements (m)")
local speed = param("speed", 40, "outwards (m/s)")
local inner, outer, thickness = 22.5*mm, 25*mm, 1.2*mm
local E, ft, G1 = 70*GPa, 100*MPa, 500*J/m2                  -- stiffness, tensile strength, energy of a crack per area

local ceramic = material{ "ceramic", density = 2700, elastic = { young = E, poisson = 0.2 },
  fracture = { tension = ft, shear = 2*ft, G1 = G1, G2 = 2*G1, penalty = 5*E, insertion = "adaptive",
               scatter = { modulus = 25 } },                 -- without it every place is as weak as any other
  contact = { penalty = E, friction = 0.2 } }
local ring = body{ "ring", shape = ring{ inner = inner, outer = outer, thickness = thickness }, mesh = { size = size }, material = ceramic,
  velocity = function(x, y)                                  -- a function of place
    local r = math.sqrt(x^2 + y^2)
    return { speed*x/r, speed*y/r, 0 }
  end }
assume{ two_d = "plane stress", thickness = thickness }

measure{ "pieces", function(now) return #now.fragments() end }
measure{ "heaviest", unit = "g", function(now) return now.fragments()[1].mass/g end }
plot{ "pieces" }
output{ every = 0.5*us, measure_every = 0.1*us, fields = { "principal", "fragment" } }
run{ time = 6*us }

expect{ "pieces", value = function(now) return now.pieces end, within = { 4, 100 }, why = "some: not two, and not every element" }
-- Next: --set speed=20 and 80: pieces go with the speed to the power 2/3 (Grady). Then modulus = 5.
