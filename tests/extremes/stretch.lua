-- asked: a block of rubber that is drawn or pressed to many times or to a small part of its length
-- vary: stretch=0.05,0.2,2,6
-- limit: the step, which follows the smallest altitude
local stretch = param{ "stretch", 2, "length over that at rest" }
local E, L, density = 1*MPa, 20*mm, 1000
local c = math.sqrt(E/density)
local T = 60*L/c*math.max(1, stretch)
local rubber = material{ "rubber", density = density, elastic = { young = E, poisson = 0 } }
local block = body{ "block", shape = box{ size = { L, L, L }, center = { 0, L/2 } }, mesh = { size = 10*mm, structured = true }, material = rubber }
hold{ block, at = "bottom", velocity = { nil, 0 } }
hold{ block, at = "top", velocity = { nil, function(t) return (stretch - 1)*L/T*(1 - math.cos(2*math.pi*t/T)) end } }
assume{ contact = false }
run{ time = T, mass_damping = 0.5*math.pi*c/L }
expect{ "stress over that of the law", equals = 1, tolerance = 0.02, why = "mu (s - 1/s) for nu = 0",
        value = function(now) return now.stress(block, { 0, L/2 }).yy/(E/2*(stretch - 1/stretch)) end }
