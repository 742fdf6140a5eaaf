-- asked: a ball of steel shot through a brittle plate of one element's thickness
-- vary: speed=500,2000
-- long: speed=100
-- outcome single 2d speed=100: look again: single precision
-- outcome single 3d speed=100: look again: single precision
-- outcome speed=500: look again: contact too soft
-- outcome speed=2000: look again: contact too soft
-- limit: contact looks as far ahead as bodies move in a step, so nothing is passed unseen
local speed = param{ "speed", 500, "of the ball (m/s)" }
local steel = material{ "steel", density = 7800, elastic = { young = 200*GPa, poisson = 0.3 }, contact = { penalty = 200*GPa } }
local glass = material{ "glass", density = 2500, elastic = { young = 70*GPa, poisson = 0.2 }, contact = { penalty = 70*GPa },
  fracture = { tension = 50*MPa, shear = 100*MPa, G1 = 1000*J/m2, G2 = 4000*J/m2, penalty = 1400*GPa } }
local ball = body{ "ball", shape = ball{ radius = 4*mm, center = { 0, 4.6*mm } }, mesh = { size = 3*mm }, material = steel, velocity = { 0, -speed } }
local plate = body{ "plate", shape = box{ size = { 16*mm, 1*mm, 16*mm } }, mesh = { size = 2*mm }, material = glass }
run{ time = 4*mm/speed }
expect{ "speed of the ball over that before", within = { 0.3, 0.999 }, why = "it must be slowed",
        value = function(now) return -now.velocity(ball).y/speed end }
expect{ "joints that broke", within = { 1, 1e6 }, why = "the plate breaks", value = function(now) return now.broken_joints() end }
