-- Course 11: a ring that bursts.  Every point of a ring flies outwards at the same speed, until it breaks into pieces.
-- Theory: pieces are small when the ring is stretched fast; what breaks sends waves that unload its neighbours (Mott 1947), and the energy that the
-- stretch of a piece holds must pay for two of its ends (Grady 1982).
-- Question: twice as fast, how many more pieces? Grady says 2^(2/3) = 1.6 times.
-- Now change: --set speed=20, 40, 80, or --set modulus=10 (strengths scatter more). Look at fragments.png, and plot.py --field fragment.
-- test 2d:
-- test 3d: --set h=1.5
-- verdict 3d: look again: process zone
local speed   = param{ "speed", 40, "outwards (m/s)", least = 5, most = 200 }
local h       = param{ "h", 0.7, "element size (mm)", least = 0.2, most = 1.5 }
local modulus = param{ "modulus", 25, "Weibull's, of the strengths", least = 2, most = 1000 }
local R, t, E, ft, G = 25*mm, 2.5*mm, 70*GPa, 100*MPa, 300*J/m2
local stuff = material{ "ceramic", density = 2700, elastic = { young = E, poisson = 0.2 },
  fracture = { tension = ft, shear = 2*ft, G1 = G, G2 = 2*G, penalty = 10*E, softening = "linear", scatter = { modulus = modulus }, insertion = "adaptive" },
  contact = { penalty = E, friction = 0.2 } }
local ring = body{ "ring", shape = difference{ disc{ radius = R, thickness = 1*mm }, disc{ radius = R - t, thickness = 2*mm } }, mesh = { size = h*mm }, material = stuff,
  velocity = function(x, y) local r = math.sqrt(x*x + y*y) return { speed*x/r, speed*y/r, 0 } end }
assume{ two_d = "plane stress", thickness = 1*mm }

measure{ "pieces", function(now) return #now.fragments() end }
measure{ "fastest", unit = "m/s", function(now)
  local most = 0
  for _, piece in ipairs(now.fragments()) do most = math.max(most, math.sqrt(piece.velocity.x^2 + piece.velocity.y^2)) end
  return most
end }
plot{ "pieces" }
output{ every = 5*us, measure_every = 1*us, fields = { "principal", "fragment" } }
run{ time = 40*us }

-- It first tears when stretched by ft/E: at R ft/(E speed) = 0.9 us.
expect{ "pieces", value = function(now) return now.pieces end, within = { 5, 200 }, why = "some, not two and not all elements" }
expect{ "speed of the fastest (m/s)", value = function(now) return now.fastest end, within = { 0.5*speed, 1.1*speed }, why = "pieces keep what they had, but for what broke them and what the stress in them gave back" }
