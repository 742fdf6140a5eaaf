-- asked: a bar from a nanometre to a kilometre long that rings in its lowest mode
-- vary: L=1e-9,1e-6,1e-3,1,1e3
-- limit: numbers themselves: energies of a bar of a nanometre are 1e-27 J, and none is compared with an absolute one
local L = param{ "L", 1, "length (m)" }
local E, density = 200*GPa, 8000
local c = math.sqrt(E/density)

local steel = material{ "steel", density = density, elastic = { young = E, poisson = 0 } }
local bar = body{ "bar", shape = box{ size = { L, L/8, L/8 } }, mesh = { size = L/8, structured = true }, material = steel,
                  velocity = function(x, y, z) return { math.sin(math.pi/2*(x/L + 0.5)), 0, 0 } end }
hold{ bar, at = "left", velocity = { 0, 0, 0 } }
run{ time = L/(2*c) }
expect{ "share of elastic energy after an eighth of a period", within = { 0.495, 0.505 }, why = "sin(45 deg)^2; 8 elements along the bar",
        value = function(now) return now.energy("elastic")/(now.energy("elastic") + now.energy("kinetic")) end }
