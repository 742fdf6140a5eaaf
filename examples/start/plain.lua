-- The least that makes a scene: a block of stone falls on a floor and bounces.
-- Numbers are in SI units: 40*mm is 0.040. A word that is misspelt is named, with the line and the nearest right one.

-- What it is made of. Without `fracture` it cannot break; a scene for a crack: `new brazilian`.
local stone = material{ "stone", density = 2700, elastic = { young = 50*GPa, poisson = 0.25 } }

-- What there is: a shape, cut into elements. y points up; z is the thickness, which a 2D program knows for forces and masses.
local block = body{ "block", shape = box{ size = { 40*mm, 20*mm, 20*mm } }, mesh = { size = 5*mm }, material = stone, velocity = { 0, -1 } }
local floor = plate{ "floor", below(block), velocity = { 0, 0 } }

-- What is written down: numbers over time, and frames for pictures.
measure{ "push", unit = "N", function(now) return now.force(floor) end }
measure{ "height", unit = "um", function(now) return now.displacement(block, { 0, 0 }).y/um end }
plot{ "push" }
output{ every = 5*us, fields = { "velocity", "von_mises" } }

-- How long. The time step is found by itself.
run{ time = 50*us }

-- What must come out, and why; it is said at the end whether it did.
expect{ "speed after the bounce (m/s)", value = function(now) return now.velocity(block).y end, within = { 0.5, 1 },
        why = "what it had, but for what shakes in it" }

-- Next: a velocity of -5. Then a second body, a ball{ radius = 5*mm, center = { 0, 30*mm } } above it.
