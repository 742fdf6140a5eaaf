-- Course 9: a notched beam is bent.  Its strength and its toughness are read from one curve.
-- Theory (Hillerborg 1985, RILEM): the work of the press until it is through, over the area of the ligament, is the fracture energy G1.
-- Question: how much of the curve lies behind the peak? Why does the test need a stiff press?
-- Now change: G1 times four, then ft times two: which moves the peak, which the tail?
-- test 2d: --set h=4
-- test 3d: --set h=5 --set b=8 --set v=0.1
-- verdict 3d: look again: loaded too fast
local h  = param{ "h", 2.5, "element size at the crack (mm)", least = 1, most = 8 }
local G1 = param{ "G1", 20, "fracture energy (J/m2)", least = 5, most = 200 }
local ft = param{ "ft", 4, "tensile strength (MPa)", least = 1, most = 10 }
local width = param{ "b", 50, "width (mm)", least = 2, most = 200 }
local v  = param{ "v", 0.04, "speed of the press (m/s)", least = 0.005, most = 0.4 }
local E, D, b, a, span = 37*GPa, 50*mm, width*mm, 25*mm, 125*mm
local concrete = material{ "concrete", density = 2346, elastic = { young = E, poisson = 0.2 },
  fracture = { tension = ft*MPa, shear = 3*ft*MPa, friction_angle = 35*deg, G1 = G1, G2 = 10*G1, penalty = 20*E, softening = "linear", insertion = "adaptive" },
  contact = { penalty = E, friction = 0.3 } }
local notch = polygon{ points = { { -1*mm, -1*mm }, { 1*mm, -1*mm }, { 0, a } }, thickness = 2*b }
local beam = body{ "beam", shape = difference{ box{ size = { 175*mm, D, b }, center = { 0, D/2 } }, notch }, material = concrete,
                   mesh = { size = 6*mm, near = { from = { 0, a }, to = { 0, D }, radius = 8*mm, size = h*mm }, seam = { from = { 0, a }, to = { 0, D } } } }
local function roller(x, y) return box{ size = { 6*mm, 6*mm, 2*b }, center = { x, y } } end
local smooth = { penalty = E, friction = 0 }
plate{ "left",  box = roller(-span/2, -3*mm), contact = smooth }
plate{ "right", box = roller( span/2, -3*mm), contact = smooth }
local top = plate{ "top", box = roller(0, D + 3*mm), velocity = { 0, ramp{ to = -v, over = 1*ms } }, contact = smooth }
assume{ two_d = "plane stress", thickness = b }

measure{ "load", unit = "N", function(now) return now.force(top) end }
measure{ "mouth", unit = "mm", function(now) return (now.displacement(beam, { 1*mm, 0 }).x - now.displacement(beam, { -1*mm, 0 }).x)/mm end }
plot{ "load", against = "mouth" }
output{ every = 0.04*mm/v, measure_every = 0.4*um/v, fields = { "principal", "damage" } }
run{ time = 1.6*mm/v, mass_damping = 2e3, stop = function(now) return now.mouth*mm > 10*2*G1/(ft*MPa) end }   -- ten times what opens a joint for good
expect{ "work of fracture over G1 times the ligament", value = function(now) return now.energy("fracture")/(G1*b*(D - a)) end, within = { 0.65, 1 },
        why = "1 when it is through; what is left under the press is pressed and holds on" }
