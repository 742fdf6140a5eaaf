-- A stone between two plates: strength in compression beside Mohr-Coulomb's 2 c cos(phi)/(1 - sin(phi)), and its balance of energy.
-- docs/verification.md has what comes out for friction angles, sizes, seeds and speeds.
-- test 2d: --set h=0.004
-- test 3d: none
local phi      = param{ "phi", 45, "friction angle of the joints (deg)", least = 0, most = 60 }
local h        = param("h", 2*mm, "element size (m)")
local seed     = param("seed", 0, "another number, another mesh")
local speed    = param("speed", 0.2, "of each plate (m/s)")
local friction = param{ "friction", 0, "of the plates", least = 0, most = 2 }
local G1       = param("G1", 50*J/m2, "fracture energy of opening; that of slip is ten times as much (J/m2)")
local demand   = param{ "demand", 0, "1: joints are inserted on demand", least = 0, most = 1 }
local E, c = 50*GPa, phi > 0 and 50*MPa or 96*MPa
local width, height = 25*mm, 50*mm

local rock = material{ "rock", density = 2600, elastic = { young = E, poisson = 0.2 },
  fracture = { tension = 9*MPa, shear = c, friction_angle = phi*deg, G1 = G1, G2 = 10*G1, penalty = 20*E,
               insertion = demand == 1 and "adaptive" or "intrinsic" },
  contact = { penalty = E, friction = 0.7 } }
local stone = body{ "stone", shape = box{ size = { width, height, 10*mm } }, mesh = { size = h, irregular = 0.2, seed = seed },
                    material = rock }
local touch = { penalty = E, friction = friction }
local top = plate{ "top", above(stone), velocity = { 0, -speed }, contact = touch }
local bottom = plate{ "bottom", below(stone), velocity = { 0, speed }, contact = touch }
assume{ two_d = "plane strain", thickness = 10*mm }

measure{ "pressure", unit = "MPa", function(now) return (now.force(top) + now.force(bottom))/2/(width*10*mm)/MPa end }
plot{ "pressure" }
run{ time = 1.2*ms*0.2/speed, mass_damping = 5e3,
     stop = function(now) return now.pressure < 0.5*now.peak("pressure") and now.peak("pressure") > 60 end }
expect{ "balance", value = function(now) return math.abs(now.energy("residual"))/now.energy("external") end, within = { 0, 5e-3 },
        why = "no path of slip and pressure gives work" }
expect{ "peak over Mohr-Coulomb", value = function(now) return now.peak("pressure")*MPa/(2*c*math.cos(phi*deg)/(1 - math.sin(phi*deg))) end,
        within = { 0.9, 1.25 }, why = "few faces lie where the stone would shear: docs/verification.md" }
