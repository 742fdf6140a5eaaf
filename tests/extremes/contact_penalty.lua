-- asked: two like blocks that meet head-on, with a contact from a tenth as stiff as they are to 100 000 times as stiff
-- vary: penalty=0.1,1,100
-- long: penalty=1e5
-- limit: the step goes with the square root; soft contact lets bodies sink into one another
local penalty = param{ "penalty", 1, "of contact, over E" }
local E, L, v = 1*GPa, 20*mm, 1
local stuff = material{ "stuff", density = 1000, elastic = { young = E, poisson = 0 }, contact = { penalty = penalty*E } }
local function block(name, x, u)
  return body{ name, shape = box{ size = { L, L, L }, center = { x, 0 } }, mesh = { size = 5*mm, structured = true }, material = stuff, velocity = { u, 0 } }
end
local left, right = block("left", -L/2, v), block("right", L/2, 0)
run{ time = 200*us, safety = 0.4 }
expect{ "speed of the block that was hit, over that of the one that came", within = { 0.87, 1 }, why = "like bars change their speeds, but for what rings on: (h/L)^(2/3)/3",
        value = function(now) return now.velocity(right).x/v end }
