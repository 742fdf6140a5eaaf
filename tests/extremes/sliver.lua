-- asked: a block that is pulled, with a face of the mesh that leaves one of its corners at a small angle (degrees)
-- vary: angle=10,1,0.1
-- limit: the step, which goes with the smallest altitude
local angle = param{ "angle", 1, "between the face and the block's lower side (degrees)" }
local E, L, density = 10*GPa, 20*mm, 2000
local c = math.sqrt(E/density)
local T = 30*L/c

local stuff = material{ "stuff", density = density, elastic = { young = E, poisson = 0.25 } }
local block = body{ "block", shape = box{ size = { L, L, 5*mm }, center = { L/2, L/2 } }, material = stuff,
                    mesh = { size = 5*mm, seam = { from = { 0, 0 }, to = { L, L*math.tan(angle*deg) } } } }
hold{ block, at = "bottom", velocity = { nil, 0 } }
hold{ block, at = "top", velocity = { nil, function(t) return 0.001*L/T*(1 - math.cos(2*math.pi*t/T)) end } }
assume{ two_d = "plane stress" }
run{ time = T, mass_damping = 0.5*math.pi*c/L }
expect{ "stress over E times strain, in the middle", equals = 1, tolerance = 0.02, why = "Hooke",
        value = function(now) return now.stress(block, { L/2, L/2 }).yy*L/(E*now.displacement(block, { L/2, L }).y) end }
expect{ "the same in the sliver", equals = 1, tolerance = 0.02, why = "strain is the same everywhere",
        value = function(now) return now.stress(block, { 0.9*L, 0.3*L*math.tan(angle*deg) }).yy*L/(E*now.displacement(block, { L/2, L }).y) end }
