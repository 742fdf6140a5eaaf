-- asked: a block whose upper face is driven towards its lower one and through it
-- vary: height=0.5,0.1,0.01,-0.5
-- outcome height=-0.5: refused: what limits it is crushed
-- limit: matter has no negative volume
local height = param{ "height", 0.5, "at the end, over that at rest" }
local E, L, density = 1*MPa, 20*mm, 1000
local c = math.sqrt(E/density)
local T = 60*L/c
local rubber = material{ "rubber", density = density, elastic = { young = E, poisson = 0.3 } }
local block = body{ "block", shape = box{ size = { L, L, L }, center = { 0, L/2 } }, mesh = { size = 10*mm, structured = true }, material = rubber }
hold{ block, at = "bottom", velocity = { 0, 0, 0 } }
hold{ block, at = "top", velocity = { 0, function(t) return (height - 1)*L/T*(1 - math.cos(2*math.pi*t/T)) end, 0 } }
run{ time = T, mass_damping = 0.5*math.pi*c/L }
expect{ "height at the end", equals = height, tolerance = 0.02, why = "it was driven there",
        value = function(now) return 1 + now.displacement(block, { 0, L }).y/L end }
