-- A bar of stone is pulled at both ends until it tears: strength and toughness in their simplest test.
-- It is notched, so that it tears in the middle.
local size = param("size", dim == 2 and 2*mm or 5*mm, "of elements (m)")
local speed = param("speed", 0.03, "of each end (m/s)")
local length, height, depth = 60*mm, 16*mm, 8*mm             -- along x, y, z
local E, ft, G1 = 40*GPa, 4*MPa, 20*J/m2                     -- stiffness, tensile strength, energy of a crack per area

local stone = material{ "stone", density = 2600, elastic = { young = E, poisson = 0.2 },
  fracture = { tension = ft, shear = 3*ft, G1 = G1, G2 = 5*G1, penalty = 2*E, insertion = "adaptive" },   -- joints come where the stress reaches the strength
  contact = { penalty = E, friction = 0.5 } }
local function notch_at(y) return notch{ from = { 0, y - 2*mm }, to = { 0, y + 2*mm }, width = 3*mm } end
local bar = body{ "bar", shape = difference{ box{ size = { length, height, depth } }, notch_at(height/2), notch_at(-height/2) },
  mesh = { size = size, seam = { from = { 0, -height/2 }, to = { 0, height/2 } } }, material = stone }
local ligament = (height - 4*mm)*depth                       -- what is left between the notches

-- Both ends are gripped along x; they reach their speed smoothly, or the bar would ring.
local left  = hold{ bar, at = "left",  velocity = { ramp{ to = -speed, over = 0.2*ms } } }
local right = hold{ bar, at = "right", velocity = { ramp{ to =  speed, over = 0.2*ms } } }
assume{ two_d = "plane stress", thickness = depth }

measure{ "pull", unit = "MPa", function(now) return (now.reaction(left, "x") + now.reaction(right, "x"))/2/ligament/MPa end }
measure{ "lengthening", unit = "um", function(now)
  return (now.displacement(bar, { length/2, 0 }).x - now.displacement(bar, { -length/2, 0 }).x)/um
end }
plot{ "pull", against = "lengthening" }
output{ every = 20*us, fields = { "principal", "damage" } }
run{ time = 0.8*ms, mass_damping = 1e4, stop = function(now) return now.peak("pull") > 1 and now.pull < 0.1*now.peak("pull") end }

expect{ "strength over that of the stone", value = function(now) return now.peak("pull")*MPa/ft end, within = { 0.6, 1.1 },
        why = "less than 1: at the notches' tips stress is higher than on average" }
-- Next: --set speed=1. Then other strengths. Then without the seam: where does it tear?
