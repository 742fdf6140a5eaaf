-- asked: a disc whose pieces fly apart, until they are many diameters from one another
-- vary: r=1,30
-- long: r=1000
-- outcome single r=1: look again: single precision
-- outcome single r=30: do not trust: single precision
-- outcome single r=1000: do not trust: balance of energy, single precision
-- limit: displacements in single precision, which have seven digits
local r = param{ "r", 10, "how far they fly (diameters)" }
local E, d, density = 1*GPa, 10*mm, 1000
local v = 0.1*math.sqrt(E/density)
local glass = material{ "glass", density = density, elastic = { young = E, poisson = 0.2, damping = { share = 0.2 } },
  fracture = { tension = 0.1*MPa, shear = 0.3*MPa, G1 = 0.1, G2 = 0.4, penalty = 20*E } }
local disc = body{ "disc", shape = disc{ radius = d/2, thickness = 4*mm }, mesh = { size = 5*mm }, material = glass,
                   velocity = function(x, y, z) return { v*x/(d/2), v*y/(d/2), 0 } end }
run{ time = r*d/v }
expect{ "size at the end over that of free flight of the outline", within = { 0.5, 1.1 }, why = "pieces fly with the speed of their middle",
        value = function(now) return now.size(disc).x/(d*(1 + 2*r)) end }
expect{ "joints that broke", within = { 5, 1e6 }, why = "it is torn apart", value = function(now) return now.broken_joints() end }
