-- A steel cube of 1 m is pulled by 0.2 m: INFIDEP paper, sec. 3.3.1 (flow) and 3.3.2 (flow and fracture). Three materials:
--   flows:             fissure3d run cube_johnson_cook.lua
--   cracks:            fissure3d run cube_johnson_cook.lua --set plastic=0 --set fracture=1
--   flows and cracks:  fissure3d run cube_johnson_cook.lua --set fracture=1 --set clamped=1
-- A plane stress model is the same bar: its width and thickness are free.
-- test 2d: --set h=0.25 --set speed=1
-- test 3d: --set h=0.5 --set speed=1
local v        = param("speed", 0.5, "speed of the pulled face (m/s); the paper's is 0.05, both are slower than the reference rate")
local h        = param("h", 0.25, "element size (m)")
local plastic  = param{ "plastic", 1, "1: it flows", least = 0, most = 1 }
local fracture = param{ "fracture", 0, "1: it can crack", least = 0, most = 1 }
local clamped  = param{ "clamped", 0, "1: both pulled faces are held sideways, as in the paper; 0: free, a bar in tension", least = 0, most = 1 }
local held     = param{ "held", 0, "1: all sides are held, no width is lost", least = 0, most = 1 }
local strength = param("strength", 1.6*GPa, "tensile strength of joints (Pa), paper sec. 3.3.2")
local energy   = param("energy", 1e4, "fracture energy (J/m2); the paper's 1 J/m2 breaks joints of this size at once")
local penalty  = param("penalty", 20, "joint penalty over Young's modulus")
local pull     = param("pull", 0.2, "how far it is pulled (m)")

local E, nu, A, B, n = 206.9*GPa, 0.29, 806*MPa, 614*MPa, 0.168   -- 42CrMo4, paper table 1
local steel = material{ "42CrMo4",
  density  = 7830,
  elastic  = { young = E, poisson = nu, damping = fracture == 1 and { share = 0.1 } or nil },
  plastic  = plastic == 1 and { law = "johnson_cook", A = A, B = B, C = 0.0089, n = n, rate0 = 1 } or nil,
  fracture = fracture == 1 and { tension = strength, shear = strength, G1 = energy, G2 = energy, penalty = penalty*E } or nil,
}
-- It moves from the start as it will be pulled: no wave runs through it.
local cube = body{ "cube", shape = box{ size = { 1, 1, 1 }, center = { 0.5, 0.5, dim == 3 and 0.5 or nil } }, mesh = { size = h, structured = true },
                   material = steel, velocity = function(x, y, z) return { v*x, 0, 0 } end }
assume{ two_d = (clamped == 0 and held == 0) and "plane stress" or "plane strain" }
hold{ cube, at = "left",  velocity = { 0, clamped == 1 and 0 or nil, clamped == 1 and 0 or nil } }
local right = hold{ cube, at = "right", velocity = { v, clamped == 1 and 0 or nil, clamped == 1 and 0 or nil } }
if held == 1 then
  for _, side in ipairs{ "bottom", "top" } do hold{ cube, at = side, velocity = { nil, 0, nil } } end
  for _, side in ipairs{ "back", "front" } do hold{ cube, at = side, velocity = { nil, nil, 0 } } end
end

-- Closed form of the bar with free sides: ln(1 + u) = ep + s/E, s = A + B ep^n (Cauchy stress over true strain).
local function bar(u)
  local low, high = 0, math.log(1 + u)
  if E*high < A then return E*high end
  for _ = 1, 60 do
    local ep = 0.5*(low + high)
    if ep + (A + B*ep^n)/E > math.log(1 + u) then high = ep else low = ep end
  end
  return A + B*low^n
end

measure{ "pull", unit = "m", function(now) return v*now.time end }
measure{ "von_mises", unit = "Pa", function(now) return now.field("von_mises", cube, { 0.5, 0.5, 0.5 }) end }
measure{ "closed_form", unit = "Pa", function(now) return bar(v*now.time) end }
measure{ "plastic_strain", function(now) return now.field("plastic_strain", cube, { 0.5, 0.5, 0.5 }) end }
measure{ "pull_force", unit = "N", function(now) return now.reaction(right, "x") end }
plot{ "von_mises", against = "pull" }
plot{ "closed_form", against = "pull" }
output{ every = pull/v/20, fields = { "von_mises", "plastic_strain", "plastic_rate", "yield_ratio", "damage", "velocity" } }

run{ time = pull/v, mass_damping = fracture == 1 and 20*v or 0, stop = function(now)
  return fracture == 1 and now.peak("pull_force") > 1e8 and now.pull_force < 0.1*now.peak("pull_force")
end }

expect{ "energy balance", value = function(now) return math.abs(now.energy("residual"))/now.energy("external") end,
        within = { 0, 0.01 }, why = "every force books its work" }
if plastic == 1 and fracture == 0 and clamped == 0 and held == 0 then
  expect{ "von Mises stress over the closed form", value = function(now) return now.von_mises/now.closed_form end,
          within = { 0.999, 1.001 }, why = "A + B ep^n with ep = ln(1 + u) - stress/E; 1264.67 MPa at 0.2 m" }
end
