-- asked: a block that spins freely, for many turns
-- vary: n=10
-- long: n=1e4
-- limit: in single precision rounding adds up
local n = param{ "n", 10, "turns" }
local E, L, density = 1*GPa, 20*mm, 1000
local w = 0.1*math.sqrt(E/density)/L
local stuff = material{ "stuff", density = density, elastic = { young = E, poisson = 0.3 } }
local block = body{ "block", shape = box{ size = { L, L, L } }, mesh = { size = L/2, structured = true }, material = stuff,
                    velocity = function(x, y, z) return { -w*y, w*x, 0 } end }
local start = 1.5*density*L^5*w^2/12  -- 1.5: lumped masses of two cells a side
run{ time = n*2*math.pi/w, safety = 0.2 }
expect{ "energy of motion over that at the start", equals = 1, tolerance = 0.01, why = "no force acts; (w L/c)^2 of it stretches the block",
        value = function(now) return now.energy("kinetic")/start end }
expect{ "diagonal over that at rest", equals = 1, tolerance = 0.01, why = "no force acts; it is stretched by (w L/c)^2",
        value = function(now)
          local a, b = now.displacement(block, { -L/2, -L/2 }), now.displacement(block, { L/2, L/2 })
          return math.sqrt((L + b.x - a.x)^2 + (L + b.y - a.y)^2)/(L*math.sqrt(2))
        end }
