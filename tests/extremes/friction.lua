-- asked: a block on a slope that gravity pulls with half of what it presses it on with
-- vary: mu=0,0.25,10
-- limit: blocks that are soft or not damped flutter and slide too far (docs/verification.md, D4)
local mu = param{ "mu", 0.25, "friction coefficient" }
local g, T = 1000, 5*ms
local stuff = material{ "stuff", density = 1000, elastic = { young = 1*GPa, poisson = 0.2, damping = { share = 0.2 } }, contact = { penalty = 1*GPa, friction = mu } }
local block = body{ "block", shape = box{ size = { 40*mm, 10*mm, 20*mm }, center = { 0, 5*mm } }, mesh = { size = 5*mm, structured = true }, material = stuff }
wall{ "slope", point = { 0, 0 }, normal = { 0, 1 } }
gravity{ 0.5*g, -g }
run{ time = T }
expect{ "way over that without friction", equals = math.max(0, 1 - 2*mu), tolerance = 0.02, why = "Coulomb",
        value = function(now) return now.displacement(block, { 0, 5*mm }).x/(0.25*g*T^2) end }
