-- A metal rod hits a wall and its foot flows out: how strong a metal is when it is fast (Taylor's test).
local size = param("size", dim == 2 and 0.5*mm or 1.2*mm, "of elements (m)")
local speed = param("speed", 200, "of the rod (m/s)")
local radius, length = 3.2*mm, 32*mm

local metal = material{ "metal", density = 8930, elastic = { young = 117*GPa, poisson = 0.35 },
  plastic = { yield = 400*MPa, hardening = 100*MPa },        -- J2; `johnson_cook` knows rates and heat
  contact = { penalty = 117*GPa, friction = 0 } }
local rod = body{ "rod", shape = rod{ radius = radius, length = length }, material = metal, velocity = { 0, -speed },
  mesh = { size = size, cells = "block", integration = "b_bar" } }
wall{ point = { 0, 0 }, normal = { 0, 1 } }
assume{ two_d = "axisymmetric" }                             -- in 2D x is the radius, and the rod is round, not a slab

measure{ "length", unit = "mm", function(now) return now.size(rod).y/mm end }
measure{ "foot", unit = "mm", function(now) return now.size(rod).x/2/mm end }
plot{ "length" }
output{ every = 4*us, fields = { "plastic_strain", "von_mises" } }
run{ time = 40*us }

expect{ "plastic work over the rod's energy", value = function(now) return now.energy("plastic")/(0.5*metal.density*math.pi*radius^2*length*speed^2) end,
        within = { 0.5, 1 }, why = "what does not fly back and does not move any more" }
-- Next: --set speed=300. Then hardening = 0. Then `two_d = "plane strain"`: why is a slab another experiment than a rod?
