-- A bar that rings in its lowest mode: after a quarter of a period, L/c, its end has moved by 2 L v/(pi c), whatever the numbers of the scheme.
-- scripts/study asks it what precision, step and mesh cost (docs/studies/price.md).
-- test 2d:
-- test 3d: --set h=5
local h = param{ "h", 2.5, "element size (mm)", least = 0.1, most = 10 }
local L, E, density = 40*mm, 200*GPa, 8000
local c = math.sqrt(E/density)

local steel = material{ "steel", density = density, elastic = { young = E, poisson = 0 } }
local bar = body{ "bar", shape = box{ size = { L, 5*mm, 5*mm } }, mesh = { size = h*mm, structured = true }, material = steel,
                  velocity = function(x, y, z) return { math.sin(math.pi/2*(x/L + 0.5)), 0, 0 } end }
hold{ bar, at = "left", velocity = { 0, 0, 0 } }

measure{ "end", unit = "um", function(now) return now.displacement(bar, { L/2, 0, 0 }).x/um end }
run{ time = L/c }
expect{ "way of the end", value = function(now) return now["end"]/(2*L/(math.pi*c)/um) end, within = { 0.97, 1.03 }, why = "2 L v/(pi c); h = 5 mm is 2 % off" }
