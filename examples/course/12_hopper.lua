-- Course 12: a hopper.  Discs fall through a funnel.
-- Theory: a wide mouth lets grains out at a rate that goes with its width to the power 3/2 (Beverloo 1961), a narrow one is bridged by an arch.
-- Question: at which width, in diameters, does the flow stop?
-- Now change: --set mouth=8, 3 and 2, then mouth=2 with friction=0. Does it still arch?
-- test 2d: --set rows=6 --set time=0.15
-- test 3d: --set rows=1 --set time=0.14 --set h=8
-- verdict 3d: look again: never touched, never touched
local mouth = param{ "mouth", 6, "width over the diameter of a disc", least = 2, most = 10 }
local rows  = param{ "rows", 10, "of 15 discs", least = 1, most = 60 }
local time  = param{ "time", 0.3, "(s)", least = 0.01, most = 10 }
local h     = param{ "h", 5, "element size of the discs (mm)", least = 2, most = 10 }
local mu    = param{ "friction", 0.3, "of discs and walls", least = 0, most = 2 }
local r, E = 5*mm, 1*MPa   -- soft as rubber, so that steps are long
local touch = { penalty = 10*E, friction = mu }
local rubber = material{ "rubber", density = 1000, elastic = { young = E, poisson = 0.3, damping = { share = 0.1 } }, contact = touch }
math.randomseed(1)
local half, gap = 16*r, mouth*r
local discs = {}
for j = 1, rows do for i = 1, 15 do
  local x = (i - 8)*2.06*r + (j % 2 - 0.5)*0.6*r + (math.random() - 0.5)*0.1*mm
  discs[#discs + 1] = body{ "disc " .. #discs + 1, shape = disc{ center = { x, half - gap + (2*j - 1)*1.05*r }, radius = r, thickness = 10*mm }, mesh = { size = h*mm }, material = rubber }
end end
for _, s in ipairs{ -1, 1 } do
  local funnel = body{ s < 0 and "left" or "right", mesh = { size = 20*mm }, material = rubber,
    shape = polygon{ points = { { s*gap, -2*mm }, { s*gap, 0 }, { s*half, half - gap }, { s*half, -2*mm } }, thickness = 10*mm } }
  hold{ funnel, at = function() return true end, velocity = { 0, 0, 0 } }
  wall{ point = { s*half, 0 }, normal = { -s, 0 }, contact = touch }
end
gravity{ 0, -9.81 }

measure{ "through", function(now)   -- discs below the mouth
  local count = 0
  for _, piece in ipairs(now.fragments()) do if piece.center.y < -r then count = count + 1 end end
  return count
end }
plot{ "through" }
output{ every = time/40, measure_every = time/100, fields = { "velocity" } }
run{ time = time }
expect{ "some are through", value = function(now) return now.through end, within = mouth > 2 and { 2, #discs } or { 0, #discs }, why = "three diameters and more do not arch" }
