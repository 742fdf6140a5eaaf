-- A column of rock is crushed between two plates: strength in compression, from cohesion and friction.
local size = param("size", dim == 2 and 3*mm or 7*mm, "of elements (m)")
local speed = param("speed", dim == 2 and 0.3 or 0.6, "of each plate (m/s)")
local width, height, depth = 25*mm, 50*mm, dim == 2 and 25*mm or 12*mm
local E, c, phi = 50*GPa, 30*MPa, 35*deg                     -- stiffness, cohesion, friction angle

local rock = material{ "rock", density = 2600, elastic = { young = E, poisson = 0.2 },
  fracture = { tension = 9*MPa, shear = c, friction_angle = phi, G1 = 50*J/m2, G2 = 500*J/m2, penalty = 20*E, insertion = "adaptive",
               scatter = { modulus = 15 } },                 -- strengths of joints differ, as those of grains do
  contact = { penalty = E, friction = math.tan(phi) } }
local stone = body{ "stone", shape = box{ size = { width, height, depth } }, mesh = { size = size, irregular = 0.2 }, material = rock }

local smooth = { penalty = E, friction = 0 }                 -- greased plates: the stone may widen at its ends
local top    = plate{ "top",    above(stone), velocity = { 0, ramp{ to = -speed, over = 50*us } }, contact = smooth }
local bottom = plate{ "bottom", below(stone), velocity = { 0, ramp{ to =  speed, over = 50*us } }, contact = smooth }
assume{ two_d = "plane strain", thickness = depth }

measure{ "push", unit = "MPa", function(now) return (now.force(top) + now.force(bottom))/2/(width*depth)/MPa end }
measure{ "shortening", unit = "um", function(now)
  return (now.displacement(bottom).y - now.displacement(top).y)/um
end }
plot{ "push", against = "shortening" }
output{ every = 20*us, fields = { "principal", "damage", "fragment" } }
run{ time = 0.6*ms, mass_damping = 5e3, stop = function(now) return now.peak("push") > 30 and now.push < 0.5*now.peak("push") end }

local theory = 2*c*math.cos(phi)/(1 - math.sin(phi))         -- Mohr-Coulomb
expect{ "strength over Mohr-Coulomb's", value = function(now) return now.peak("push")*MPa/theory end, within = { 0.75, 1.3 },
        why = "faces lie where the mesh has them, and weak ones begin" }
-- Next: phi = 20*deg. Then friction = 0.5 of the plates: what stays under them? Then scatter with seed = 1, 2, 3.
