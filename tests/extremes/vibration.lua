-- asked: a bar that rings freely in its lowest mode, for many steps
-- vary: n=1e4
-- long: n=1e7
-- limit: in single precision rounding adds up
local n = param{ "n", 1e4, "steps" }
local E, L, density, h = 200*GPa, 40*mm, 8000, 5*mm
local c = math.sqrt(E/density)
local steel = material{ "steel", density = density, elastic = { young = E, poisson = 0 } }
local bar = body{ "bar", shape = box{ size = { L, h, h } }, mesh = { size = h, structured = true }, material = steel,
                  velocity = function(x, y, z) return { math.sin(math.pi/2*(x/L + 0.5)), 0, 0 } end }
hold{ bar, at = "left", velocity = { 0, 0, 0 } }
local dt = 0.4*h/c*(dim == 2 and 1 or 0.7)
local start = 0.5*density*L*h*h/2
run{ time = n*dt, dt = dt }
expect{ "energy over that at the start", equals = 1, tolerance = 0.005, why = "nothing takes it; 8 elements along the bar",
        value = function(now) return (now.energy("kinetic") + now.energy("elastic"))/start end }
