-- A block is torn: joints soften, break, and their faces meet again. blocks = 1: of quadrilaterals or hexahedra.
local blocks = param{ "blocks", 0, "1: blocks; 0: simplices", least = 0, most = 1 }
local pull   = param("pull", 8, "speed of the pulled face (m/s); small: it stays whole")
local time   = param("time", 20*us, "simulated time (s)")
local E = 30*GPa
local rock = material{ "rock",
  density  = 2500,
  elastic  = { young = E, poisson = 0.2, damping = { share = 0.05 } },
  fracture = { tension = 3*MPa, shear = 6*MPa, friction_angle = 30*deg, G1 = 20*J/m2, G2 = 40*J/m2, penalty = 2*E },
  contact  = { penalty = E, friction = 0.4 },
}
local block = body{ "block", shape = box{ size = { 12*mm, 6*mm, 6*mm } }, mesh = { size = 2*mm, structured = blocks == 0, cells = blocks == 1 and "block" or nil },
                    material = rock }
hold{ block, at = "left", velocity = { 0, 0, 0 } }
hold{ block, at = "right", velocity = { function(t) return t < 12*us and pull or -pull end, 0.2*pull, 0 } }
measure{ "moved", unit = "m", function(now) return now.displacement(block, { 1*mm, 1*mm }).x end }
measure{ "aside", unit = "m", function(now) return now.displacement(block, { 1*mm, -1*mm }).y end }
measure{ "speed", unit = "m/s", function(now) return now.velocity(block, { 1*mm, 1*mm }).x end }
measure{ "cracks", unit = "m2", function(now) return now.crack_area() end }
run{ time = time, allowed_residual = 1 }
