-- A disc crushed between two plates splits along its diameter: the Brazilian test, with the numbers of table 4 of the
-- INFIDEP paper (sec. 4.3; Munjiza et al. 2011). At 2 m/s this is an impact, no strength test: try --set speed=0.05.
local v       = param("speed", 2, "speed of each plate (m/s)")
local h       = param("h", 3*mm, "element size (m)")
local ratio   = param("ratio", 0.8, "penalty of joints and contact over Young's modulus; the paper's 40 GPa is 0.8")
local joints  = param{ "joints", 1, "1: the disc can break; 0: it stays elastic", least = 0, most = 1 }
local seed    = param("seed", 0, "another number, another mesh of the same size")
local time    = param("time", 2*ms, "simulated time (s)")

local E = 50*GPa
-- The paper prints the shear strength as 3.15e10 MPa; 3.15e10 Pa is as good as never, too.
local fracture = { tension = 3*MPa, shear = 31.5*GPa, G1 = 5*J/m2, G2 = 5*J/m2, penalty = ratio*E }

local rock = material{ "rock",
  density  = 2700,
  elastic  = { young = E, poisson = 0.25, damping = "critical" },
  fracture = joints == 1 and fracture or nil,   -- a part that is left out leaves its model out
  contact  = { penalty = ratio*E, friction = 0.1 },
}
local disc = body{ "disc", shape = disc{ radius = 25*mm, thickness = 25*mm },
                   mesh = { size = h, seed = seed }, material = rock }
local top    = plate{ "top",    above(disc), velocity = { 0, -v } }
local bottom = plate{ "bottom", below(disc), velocity = { 0,  v } }

measure{ "load", unit = "N", function(now) return (now.force(top) + now.force(bottom))/2 end }
measure{ "tensile_stress", unit = "Pa", function(now) return 2*now.load/(math.pi*disc.diameter*disc.thickness) end }
measure{ "crack", unit = "m2", function(now) return now.crack_area() end }
plot{ "tensile_stress", against = "time" }
output{ every = time/100, fields = { "stress", "damage", "velocity" } }

run{ time = time, stop = function(now)
  local peak = now.peak("tensile_stress")
  return peak > 1*MPa and now.tensile_stress < 0.1*peak
end }
