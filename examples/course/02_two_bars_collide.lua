-- Course 2: two bars collide.  A bar flies into another of its kind that lies still.
-- Theory: both ends move at v/2 while a wave of pressure rho c v/2 runs through both; it comes back as a pull from the free ends after 2 L/c, and they part.
-- All waves have left the first bar by then: it lies still, and the second flies on at v.
-- Question: how long do they touch, and how hard?
-- Now change: L2 = 2*L, a second bar twice as long. Who keeps what?  Then contact = { penalty = E/10 }: how much longer do they touch?
-- test 2d:
-- test 3d: --set h=2.5
local h = param{ "h", 1, "element size (mm)", least = 0.25, most = 5 }
local L, side, E, density, v = 50*mm, 5*mm, 70*GPa, 2700, 10
local L2 = L   -- of the second bar
local c = math.sqrt(E/density)

local alu = material{ "aluminium", density = density, elastic = { young = E, poisson = 0 }, contact = { penalty = 2*E, friction = 0 } }
local function bar(name, x, length, speed)
  return body{ name, shape = box{ size = { length, side, side }, center = { x, 0 } }, mesh = { size = h*mm, structured = true }, material = alu,
               velocity = { speed, 0, 0 } }
end
local first, second = bar("first", -L/2 - 0.05*mm, L, v), bar("second", L2/2, L2, 0)

measure{ "first", unit = "m/s", function(now) return now.velocity(first).x end }
measure{ "second", unit = "m/s", function(now) return now.velocity(second).x end }
-- Together they hold a half of the energy as pressure when both are in the wave.
measure{ "stored", unit = "J", function(now) return now.energy("elastic") + now.energy("contact") end }
plot{ "first" }
plot{ "second" }
run{ time = 40*us }

expect{ "speed of the second", value = function(now) return now.second end, within = { 0.95*v, 1.001*v }, why = "v but for what still rings in both" }
expect{ "speed of the first", value = function(now) return now.first end, within = { -0.001*v, 0.05*v }, why = "it stops" }
expect{ "momentum", value = function(now) return (L*now.first + L2*now.second)/(L*v) end, within = { 1 - 1e-9, 1 + 1e-9 }, why = "both push each other alike" }
expect{ "most stored, share", value = function(now) return now.peak("stored")/(now.energy("kinetic") + now.energy("elastic")) end,
        within = { 0.45, 0.52 }, why = "half: all moves at v/2" }
