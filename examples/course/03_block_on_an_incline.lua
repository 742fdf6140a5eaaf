-- Course 3: a block on an incline.  It stays while tan(angle) is below the coefficient of friction, and slides beyond.
-- Theory (Coulomb): a = g (sin(angle) - mu cos(angle)), 0 where that is negative.
-- Question: mu = 0.5. Does it slide at 20 degrees, at 30?
-- The block has some damping: it is set down at once, and without that it bounces, and creeps a little with each bounce.
-- Now change: --set angle=26 and 27 (tan is 0.488 and 0.510).  Then make the block light, or its base long: does it matter?
-- test 2d:
-- test 3d:
local angle = param{ "angle", 35, "of the incline (deg)", least = 0, most = 80 }
local mu    = param{ "mu", 0.5, "coefficient of friction", least = 0, most = 2 }
local E, g = 100*MPa, 9.81

local rubber = material{ "block", density = 1000, elastic = { young = E, poisson = 0.2, damping = { share = 0.2 } }, contact = { penalty = 10*E, friction = mu } }
local block = body{ "block", shape = box{ size = { 100*mm, 50*mm, 50*mm }, center = { 0, 25*mm } }, mesh = { size = 25*mm, structured = true }, material = rubber }
wall{ "incline", point = { 0, 0 }, normal = { 0, 1 }, contact = { penalty = 10*E, friction = mu } }
gravity{ g*math.sin(angle*deg), -g*math.cos(angle*deg) }   -- the incline lies still; the weight is turned

measure{ "speed", unit = "m/s", function(now) return now.velocity(block).x end }
plot{ "speed" }
local time = 0.1
run{ time = time }

local a = math.max(0, g*(math.sin(angle*deg) - mu*math.cos(angle*deg)))
expect{ "speed", value = function(now) return now.speed end, within = { a*time - 0.01, a*time + 0.01 }, why = "g (sin - mu cos) t, or nothing" }
