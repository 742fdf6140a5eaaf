-- Course 1: a wave in a bar.  A push of 20 us at the left end runs along a steel bar at c = sqrt(E/rho).
-- Theory: particles in the wave move at v = stress/(rho c). At a free end the wave comes back as a pull, and the end itself moves twice as fast.
-- Question: when does the right end begin to move, and how fast?
-- Now change: poisson = 0.3. Does the wave arrive later, earlier, or smeared? Then hold the right end: what does it feel?
-- test 2d:
-- test 3d: --set h=5
local h = param{ "h", 2, "element size (mm)", least = 0.5, most = 10 }
local L, side, E, density, p = 400*mm, 10*mm, 200*GPa, 8000, 10*MPa
local c = math.sqrt(E/density)

local steel = material{ "steel", density = density, elastic = { young = E, poisson = 0 } }
local bar = body{ "bar", shape = box{ size = { L, side, side }, center = { L/2, 0 } }, mesh = { size = h*mm, structured = true }, material = steel }
-- The push swells and fades as a half sine: sharp fronts make a mesh ring.
pressure{ bar, at = "left", value = function(t) return t < 20*us and p*math.sin(math.pi*t/(20*us)) or 0 end }

measure{ "middle", unit = "m/s", function(now) return now.velocity(bar, { L/2, 0 }).x end }
measure{ "end", unit = "m/s", function(now) return now.velocity(bar, { L, 0 }).x end }
plot{ "end" }
run{ time = 100*us }

local at = 10*us   -- the push is largest then
expect{ "speed in the middle", value = function(now) return now.peak("middle") end, within = { 0.98*p/(density*c), 1.02*p/(density*c) }, why = "p/(rho c) = 0.25 m/s" }
expect{ "speed of the free end", value = function(now) return now.peak("end") end, within = { 1.96*p/(density*c), 2.04*p/(density*c) }, why = "twice that" }
expect{ "wave speed", value = function(now) return L/(now.peak_time("end") - at) end, within = { 0.98*c, 1.02*c }, why = "sqrt(E/rho) = 5000 m/s" }
