-- A block is pressed from above between two plates that a servo keeps at one pressure, as in a triaxial cell.
-- Question: from which gain on does the servo swing? (--set gain=8)
-- test 2d:
-- test 3d: --set h=0.04
local h = param{ "h", 0.02, "element size (m)", least = 0.005, most = 0.05 }
local gain = param{ "gain", 1, "of the servo (um/s per N)", least = 0.1, most = 100 }
local young, poisson, side, height, lateral = 10*GPa, 0.2, 0.1, 0.2, 2*MPa
local stone = material{ "stone", density = 2500, elastic = { young = young, poisson = poisson }, contact = { penalty = 20*GPa } }
assume{ two_d = "plane stress" }
local block = body{ "block", shape = box{ size = { side, height, side } }, material = stone,
                    mesh = { size = h, cells = "block", integration = "assumed_strain" } }
local wanted = lateral*height*side
local left, right
local function push(of, way)
  return function(now) return { way*gain*1e-6*(wanted - now.force(of(), "x")), 0 } end
end
left  = plate{ "left", left_of(block), servo = { every = 5*us, velocity = push(function() return left end, 1) } }
right = plate{ "right", right_of(block), servo = { every = 5*us, velocity = push(function() return right end, -1) } }
local top = plate{ "top", above(block), velocity = { 0, ramp{ to = -0.02, over = 2*ms } } }
plate{ "bottom", below(block) }
measure{ "lateral", unit = "MPa", function(now) return now.force(right, "x")/(height*side)/MPa end }
measure{ "axial", unit = "MPa", function(now) return now.force(top, "y")/side^2/MPa end }
measure{ "strain", function(now)
  return (now.displacement(block, { 0, -height/2 }).y - now.displacement(block, { 0, height/2 }).y)/height
end }
plot{ "axial", against = "strain" }
plot{ "lateral" }
run{ time = 10*ms, mass_damping = 3000 }

expect{ "lateral pressure at the end (MPa)", value = function(now) return now.lateral end, equals = lateral/MPa, tolerance = 0.08,
        why = "the servo's; it lags: each side bulges at 1 mm/s, which takes 1 kN of 40 at a gain of 1 um/s per N" }
expect{ "stress over E strain + nu lateral", value = function(now) return now.axial*MPa/(young*now.strain + poisson*now.lateral*MPa) end,
        equals = 1, tolerance = 0.03, why = "Hooke's law with one side free; the edges press less than the middle" }
