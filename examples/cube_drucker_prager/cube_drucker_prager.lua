-- A rock cube of 1 m whose strength grows with pressure: INFIDEP paper, sec. 3.4.2. Its table 2 is misprinted (a and beta are the
-- A and B of table 1); here the friction angle is 30 degrees. It is pulled, released and pulled again.
--   associated flow, isotropic:   fissure3d run cube_drucker_prager.lua
--   no dilation, kinematic:       fissure3d run cube_drucker_prager.lua --set dilation=0 --set beta=0
--   flows and cracks (table 3):   fissure3d run cube_drucker_prager.lua --set fracture=1
-- test 2d: --set h=0.25
-- test 3d: --set h=0.5
local v        = param("speed", 0.05, "speed of the pulled face (m/s)")
local h        = param("h", 0.25, "element size (m)")
local theta    = param("friction_angle", 30, "angle of the yield surface (degrees)")
local psi      = param("dilation", 30, "angle of the flow (degrees)")
local beta     = param("beta", 1, "share of hardening that is isotropic")
local plastic  = param{ "plastic", 1, "1: it flows", least = 0, most = 1 }
local fracture = param{ "fracture", 0, "1: it can crack", least = 0, most = 1 }
local strength = param("strength", 42*MPa, "tensile strength of joints (Pa); the paper's 1 MPa cracks long before it flows")
local energy   = param("energy", 50, "fracture energy (J/m2)")
local cycle    = param{ "cycle", 1, "1: released half way and pulled again", least = 0, most = 1 }
local pull     = 10*mm

local E, nu, Y, H = 30*GPa, 0.3, 50*MPa, 50*MPa     -- paper table 2: yield stress 50 MPa, 100 MPa at a plastic strain of 1
local rock = material{ "rock",
  density  = 2700,
  elastic  = { young = E, poisson = nu },
  plastic  = plastic == 1 and { law = "drucker_prager", yield = { { 0, Y }, { 1, Y + H } }, friction_angle = theta*deg, dilation_angle = psi*deg, beta = beta } or nil,
  fracture = fracture == 1 and { tension = strength, shear = 10*strength, G1 = energy, G2 = energy, penalty = 20*E } or nil,
}
local cube = body{ "cube", shape = box{ size = { 1, 1, 1 }, center = { 0.5, 0.5, dim == 3 and 0.5 or nil } }, mesh = { size = h, structured = true },
                   material = rock, velocity = function(x, y, z) return { v*x, 0, 0 } end }
assume{ two_d = "plane stress" }
-- Pulled to 5 mm, back by 1 mm, and on to the end; turns are gentle, so that no wave runs.
local half, back = 0.5*pull/v, 0.1*pull/v
local turn = 0.2*back
local function speed(t)
  if cycle == 0 then return v end
  local function ramp(from) return math.max(0, math.min(1, (t - from)/turn)) end
  return v*(1 - 2*ramp(half) + 2*ramp(half + back))
end
local time = cycle == 1 and pull/v + 2*back or pull/v
hold{ cube, at = "left", velocity = { 0 } }
local right = hold{ cube, at = "right", velocity = { speed } }

measure{ "pull", unit = "m", function(now) return now.displacement(cube, { 1, 0.5, 0.5 }).x end }
measure{ "pull_stress", unit = "Pa", function(now) return now.stress(cube, { 0.5, 0.5, 0.5 }).xx end }
measure{ "plastic_strain", function(now) return now.field("plastic_strain", cube, { 0.5, 0.5, 0.5 }) end }
-- In tension q = s and p = -s/3: s (1 + tan(theta)/3) = cohesion. Along the bar plastic strain grows by ep (1 + tan(psi)/3).
measure{ "closed_form", unit = "Pa", function(now)
  return (Y + H*now.plastic_strain)/(1 + math.tan(theta*deg)/3)
end }
plot{ "pull_stress", against = "pull" }
output{ every = time/20, fields = { "stress", "von_mises", "plastic_strain", "yield_ratio", "damage" } }

run{ time = time, mass_damping = 20, stop = function(now)
  return fracture == 1 and now.peak("pull_stress") > 1*MPa and now.pull_stress < 0.1*now.peak("pull_stress") and now.crack_area() > 0.9
end }

expect{ "energy balance", value = function(now) return math.abs(now.energy("residual"))/now.energy("external") end,
        within = { 0, 0.01 }, why = "every force books its work" }
if plastic == 1 and fracture == 0 then
  expect{ "stress over the closed form", value = function(now) return now.pull_stress/now.closed_form end,
          within = { 0.999, 1.001 }, why = "cohesion/(1 + tan(theta)/3), reached again after release" }
  expect{ "true strain over stress/E + ep (1 + tan(psi)/3)", value = function(now)
            return math.log(1 + now.pull)/(now.pull_stress/E + now.plastic_strain*(1 + math.tan(psi*deg)/3)) end,
          within = { 0.995, 1.005 }, why = "the flow dilates by psi; where waves leave 1e-4 of the stress, elements differ by 1e-4 Y/H in strain" }
end
