-- A bar that rings in its lowest mode: after an eighth of a period, L/(2 c), half of its energy is elastic, whatever the numbers of the scheme.
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

measure{ "share", function(now) return now.energy("elastic")/(now.energy("elastic") + now.energy("kinetic")) end }
study{ "share", vary = { "h=10,5,2.5", "precision=double,single" }, of = "last", reference = 0.5, tolerance = 0.1 }
run{ time = L/(2*c) }
expect{ "share of elastic energy", value = function(now) return now.share end, within = { 0.495, 0.505 }, why = "sin(45 deg)^2; the frequency is 0.2 % off at h = 5 mm" }
