-- asked: a bar that is pulled, with joints from a tenth as stiff as its cells to 100 000 times as stiff
-- vary: penalty=0.1,1,100
-- long: penalty=1e5
-- outcome penalty=0.1: look again: joints too soft
-- outcome penalty=1: look again: joints too soft
-- limit: the step, which goes with its square root
local penalty = param{ "penalty", 100, "of joints, over E" }
local E, L, h, density = 10*GPa, 40*mm, 5*mm, 2000
local c = math.sqrt(E/density)*math.min(1, math.sqrt(penalty))
local T = 40*L/c

local stuff = material{ "stuff", density = density, elastic = { young = E, poisson = 0 },
  fracture = { tension = 100*MPa, shear = 100*MPa, G1 = 1e7, G2 = 1e7, penalty = penalty*E } }
local bar = body{ "bar", shape = box{ size = { h, L, h }, center = { 0, L/2 } }, mesh = { size = h, structured = true }, material = stuff }
hold{ bar, at = "bottom", velocity = { nil, 0 } }
hold{ bar, at = "top", velocity = { nil, function(t) return 0.001*L/T*(1 - math.cos(2*math.pi*t/T)) end } }
run{ time = T, mass_damping = 0.5*math.pi*c/L }
expect{ "stress over E/(1 + E/penalty) times strain", within = { 0.95, 1.15 }, why = "the outer halves of the last cells have no joints: up to 1/7 more",
        value = function(now) return now.stress(bar, { 0, L/2 }).yy*L/(E/(1 + 1/penalty)*now.displacement(bar, { 0, L }).y) end }
