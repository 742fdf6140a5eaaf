-- A block rests on a prop that is struck away: it falls freely.
-- Question: why has it begun to move before, on a soft prop? (--set soft=100; weight comes at once here, and the prop is a spring.)
-- test 2d:
-- test 3d:
local h = param{ "h", 0.05, "element size (m)", least = 0.01, most = 0.2 }
local soft = param{ "soft", 1, "how many times softer the prop is than the block", least = 1, most = 100 }
local g, struck = 9.81, 20*ms
local stone = material{ "stone", density = 2500, elastic = { young = 1*GPa, poisson = 0.2 }, contact = { penalty = 1*GPa, friction = 0.5 } }
local wood = material{ "wood", density = 600, elastic = { young = 1*GPa/soft, poisson = 0.2 }, contact = { penalty = 1*GPa/soft, friction = 0.5 } }
local prop  = body{ "prop", shape = box{ size = { 0.1, 0.2, 0.2 } }, material = wood, mesh = { size = h } }
local block = body{ "block", shape = box{ size = { 0.4, 0.2, 0.2 }, center = { 0, 0.2 } }, material = stone, mesh = { size = h } }
hold{ prop, at = "bottom", velocity = { 0, 0, 0 } }
gravity{ 0, -g }
excavate{ prop, time = struck }
measure{ "fallen", unit = "mm", function(now) return -now.displacement(block, { 0, 0.2 }).y/mm end }
plot{ "fallen" }
run{ time = 70*ms }

expect{ "speed at the end over that of a free fall", value = function(now) return -now.velocity(block).y/(g*(now.time - struck)) end,
        equals = 1, tolerance = 0.05, why = "nothing holds it any more; it swings on its prop a little before" }
