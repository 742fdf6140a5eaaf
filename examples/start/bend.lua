-- A notched beam on two rollers is bent by a third: a crack grows from the notch.
local size = param("size", dim == 2 and 4*mm or 6*mm, "of elements beside the notch (m)")
local speed = param("speed", 0.06, "of the upper roller (m/s)")
local length, height, depth, span, cut = 175*mm, 50*mm, dim == 2 and 50*mm or 15*mm, 125*mm, 25*mm
local E, ft, G1 = 37*GPa, 4*MPa, 40*J/m2                     -- stiffness, tensile strength, energy of a crack per area

-- Joints are inserted where the stress reaches the strength; until then the beam is whole, and steps are long.
local concrete = material{ "concrete", density = 2350, elastic = { young = E, poisson = 0.2 },
  fracture = { tension = ft, shear = 3*ft, friction_angle = 35*deg, G1 = G1, G2 = 10*G1, penalty = 2*E, insertion = "adaptive" },
  contact = { penalty = E, friction = 0.3 } }
local slot = notch{ from = { 0, -1*mm }, to = { 0, cut }, width = 4*mm }
local beam = body{ "beam", shape = difference{ box{ size = { length, height, depth }, center = { 0, height/2 } }, slot }, material = concrete,
  mesh = { size = 1.3*size, near = { from = { 0, cut }, to = { 0, height }, radius = 6*mm, size = size }, seam = { from = { 0, cut }, to = { 0, height } } } }

-- Plates are rigid boxes: here three that stand for rollers.
local function roller(x, y) return box{ size = { 6*mm, 6*mm, 1.2*depth }, center = { x, y } } end
local smooth = { penalty = E, friction = 0 }
plate{ "left",  box = roller(-span/2, -3*mm), velocity = { 0, 0 }, contact = smooth }
plate{ "right", box = roller( span/2, -3*mm), velocity = { 0, 0 }, contact = smooth }
local press = plate{ "press", box = roller(0, height + 3*mm), velocity = { 0, ramp{ to = -speed, over = 0.5*ms } }, contact = smooth }
assume{ two_d = "plane stress", thickness = depth }

measure{ "load", unit = "N", function(now) return now.force(press) end }
measure{ "mouth", unit = "um", function(now)                 -- how far the notch has opened
  return (now.displacement(beam, { 3*mm, 0 }).x - now.displacement(beam, { -3*mm, 0 }).x)/um
end }
plot{ "load", against = "mouth" }
output{ every = 0.1*ms, fields = { "principal", "damage" } }
run{ time = 5*ms, mass_damping = 2e3, stop = function(now) return now.mouth > 100 end }

expect{ "strength over that of the concrete", value = function(now) return now.peak("load")*span/4/(depth*(height - cut)^2/6)/ft end, within = { 1, 3 },
        why = "1 if it broke where stress is highest first, 3 if all that is left of the height bore its strength at once" }
-- Next: G1 times four, then ft times two: which moves the peak, which the tail? Then --set speed=0.03.
-- In 3D the mesh is coarse, and the verdict says so: --set size=4e-3 is finer, and takes minutes.
