-- asked: a bar that is pulled, of a material that swells sideways to one that all but keeps its volume
-- vary: nu=-0.9,0,0.45,0.499,0.4999,0.5
-- outcome nu=0.5: refused: elastic.poisson = 0.5 is not allowed
-- limit: the step; waves of pressure are 41 times as fast as those of a bar at 0.4999. Simplices lock in bending long before
local nu = param{ "nu", 0.3, "Poisson's ratio" }
local E, L, density = 10*MPa, 40*mm, 1000
local c = math.sqrt(E/density)
local T = 30*L/c

local stuff = material{ "stuff", density = density, elastic = { young = E, poisson = nu, law = nu < 0 and "munjiza" or "neo_hookean" } }
local bar = body{ "bar", shape = box{ size = { 10*mm, L, 10*mm }, center = { 0, L/2 } }, mesh = { size = 5*mm, structured = true }, material = stuff }
hold{ bar, at = "bottom", velocity = { nil, 0 } }
hold{ bar, at = "top", velocity = { nil, function(t) return 0.005*L/T*(1 - math.cos(2*math.pi*t/T)) end } }
assume{ two_d = "plane stress" }
run{ time = T, mass_damping = 0.5*math.pi*c/L }
expect{ "stress over E times strain", equals = 1, tolerance = 0.02, why = "Hooke; strain is 0.5 %",
        value = function(now) return now.stress(bar, { 0, L/2 }).yy*L/(E*now.displacement(bar, { 0, L }).y) end }
