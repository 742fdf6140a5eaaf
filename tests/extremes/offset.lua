-- asked: two bars that meet head-on, a long way off the origin
-- vary: x0=0,1e3,1e6
-- limit: coordinates, which are measured from the scene's own middle; in a scene's numbers a metre at 1e6 m has 1e-10 m
local x0 = param{ "x0", 0, "of the scene (m)" }
local E, L, v = 1*GPa, 40*mm, 1
local stuff = material{ "stuff", density = 1000, elastic = { young = E, poisson = 0 }, contact = { penalty = E } }
local function bar(name, x, u)
  return body{ name, shape = box{ size = { L, 5*mm, 5*mm }, center = { x0 + x, x0 } }, mesh = { size = 5*mm, structured = true }, material = stuff, velocity = { u, 0 } }
end
local left, right = bar("left", -L/2, v), bar("right", L/2, 0)
run{ time = 150*us }
expect{ "speed of the bar that was hit, over that of the one that came", within = { 0.92, 1 }, why = "like bars change their speeds, but for what rings on: (h/L)^(2/3)/3",
        value = function(now) return now.velocity(right).x/v end }
