-- A steel bar hits a rigid wall at 287 m/s: the Taylor test, INFIDEP paper, sec. 4.4. Three materials:
--   flows:             fissure3d run taylor.lua
--   cracks:            fissure3d run taylor.lua --set plastic=0 --set fracture=1
--   flows and cracks:  fissure3d run taylor.lua --set fracture=1
-- In 2D this is the same round bar, turned about its axis; with --set round=0 a plate in plane strain, another experiment.
-- test 2d: --set h=0.8e-3 --set time=2e-5
-- test 3d: --set h=1.2e-3 --set time=2e-5
local v        = param("speed", 287, "speed of the bar (m/s)")
local h        = param("h", 0.4*mm, "element size (m)")
local plastic  = param{ "plastic", 1, "1: it flows", least = 0, most = 1 }
local fracture = param{ "fracture", 0, "1: it can crack", least = 0, most = 1 }
local heat     = param{ "heat", 0, "1: plastic work warms and softens it", least = 0, most = 1 }
-- An average over nodes leaves nothing that keeps a single crushed element from turning inside out: beside cracks each has its own.
local blocks   = param{ "blocks", 0, "1: quadrilaterals or hexahedra, B-bar; 0: triangles or tetrahedra", least = 0, most = 1 }
local averaged = param{ "averaged", (fracture == 1 or blocks == 1) and 0 or 1, "1: pressure averaged over nodes; 0: each element's own, which locks", least = 0, most = 1 }
local strength = param("strength", 2*GPa, "tensile strength of joints (Pa); the paper's 1.6 GPa shatters the foot's first layer of elements")
local shear    = param("shear", 4, "shear strength of joints over their tensile strength")
local energy   = param("energy", 5e4, "fracture energy (J/m2)")
local penalty  = param("penalty", 10, "joint penalty over Young's modulus")
local seed     = param("seed", 0, "another number, another mesh of the same size")
local time     = param("time", 80*us, "simulated time (s)")
local round    = param{ "round", 1, "2D: 1: axisymmetric, a round bar; 0: a plate", least = 0, most = 1 }

local E = 206.9*GPa
local steel = material{ "42CrMo4",
  density  = 7830,
  elastic  = { law = plastic == 0 and "neo_hookean" or nil, young = E, poisson = 0.29 },   -- it resists being pressed to nothing
  plastic  = plastic == 1 and { law = "johnson_cook", A = 806*MPa, B = 614*MPa, C = 0.0089, n = 0.168, rate0 = 1,   -- paper table 1
                                m = heat == 1 and 1.1 or 0, melting = 1813,
                                heat = heat == 1 and { capacity = 460, share = 0.9, start = 293 } or nil,
                                pressure = averaged == 1 and "averaged" or "element" } or nil,
  fracture = fracture == 1 and { tension = strength, shear = shear*strength, G1 = energy, G2 = energy, penalty = penalty*E } or nil,
}
local bar = body{ "bar", shape = rod{ radius = 3.2*mm, length = 32.4*mm },
                  mesh = { size = h, seed = seed, cells = blocks == 1 and "block" or "simplex", integration = blocks == 1 and "b_bar" or nil },
                  material = steel, velocity = { 0, -v } }
wall{ point = { 0, 0 }, normal = { 0, 1 } }
assume{ two_d = round == 1 and "axisymmetric" or "plane strain" }

measure{ "length", unit = "m", function(now) return now.size(bar).y end }
measure{ "foot_radius", unit = "m", function(now) return now.size(bar).x/2 end }
measure{ "plastic_strain", function(now) return now.largest("plastic_strain") end }
measure{ "kinetic", unit = "J", function(now) return now.energy("kinetic") end }
measure{ "cracks", unit = "m2", function(now) return now.crack_area() end }
plot{ "length", against = "time" }
plot{ "foot_radius", against = "time" }
output{ every = time/20, measure_every = time/200,
        fields = { "von_mises", "pressure", "plastic_strain", "plastic_rate", "temperature", "yield_ratio", "damage", "velocity" } }
-- A bar that shatters crushes single cells between its pieces and the wall: they leave, and the ledger tells what they held.
run{ time = time, crushed = fracture == 1 and "remove" or "stop" }

expect{ "energy balance over the kinetic energy at the start", value = function(now)
          return math.abs(now.energy("residual"))/now.peak("kinetic") end,
        within = { 0, 0.01 }, why = "every force books its work" }
if (dim == 3 or round == 1) and plastic == 1 and fracture == 0 and heat == 0 and (averaged == 1 or blocks == 1) and h <= 0.4*mm and time >= 80*us then
  expect{ "final length, mm", value = function(now) return now.length/mm end, within = { 26.509*0.99, 26.509*1.01 },
          why = "axisymmetric B-bar quads 20 x 200, one-sided wall, no friction: 26.509 mm" }
  expect{ "foot radius, mm", value = function(now) return now.foot_radius/mm end, within = { 5.196*0.97, 5.196*1.03 },
          why = "the same: 5.196 mm" }
end
