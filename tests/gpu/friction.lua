-- A block lands on another that stands on a wall, slides on it and bounces.
local time = param("time", 60*us, "simulated time (s)")
local rubber = material{ "polymer",
  density = 1200,
  elastic = { law = "neo_hookean", young = 3*GPa, poisson = 0.3 },
  contact = { penalty = 6*GPa, friction = 0.3 },
}
local lower = body{ "lower", shape = box{ size = { 10*mm, 4*mm, 4*mm }, center = { 0, 2*mm } }, mesh = { size = 1*mm, structured = true }, material = rubber }
local upper = body{ "upper", shape = box{ size = { 4*mm, 4*mm, 4*mm }, center = { -2*mm, 6.05*mm } }, mesh = { size = 0.8*mm, structured = true }, material = rubber,
                    velocity = { 15, -10 } }
wall{ point = { 0, 0 }, normal = { 0, 1 } }
gravity{ 0, -9.81 }
measure{ "height", unit = "m", function(now) return now.displacement(upper, { -2*mm, 6.05*mm }).y end }
measure{ "slid", unit = "m", function(now) return now.displacement(upper, { -2*mm, 6.05*mm }).x end }
measure{ "speed", unit = "m/s", function(now) return now.velocity(lower, { 0, 2*mm }).y end }
run{ time = time, allowed_residual = 1 }
