-- A beam on round supports is bent by a round nose; none of the three deforms.
-- Question: how much stiffer is the beam where it rubs on its supports? (--set friction=0.5)
-- test 2d:
-- test 3d: --set h=0.02
local h = param{ "h", 5*mm, "element size of the beam (m)", least = 2*mm, most = 20*mm }
local friction = param{ "friction", 0, "between beam and supports", least = 0, most = 1 }
local span, depth, width, length, radius = 200*mm, 40*mm, 40*mm, 240*mm, 10*mm
local speed, young, poisson = 10*mm/s, 10*GPa, 0.2
local stone = material{ "stone", density = 2500, elastic = { young = young, poisson = poisson }, contact = { penalty = 10*GPa, friction = friction } }
local steel = material{ "steel", density = 7800, elastic = { young = 200*GPa, poisson = 0.3 } }
assume{ two_d = "plane stress" }
local beam = body{ "beam", shape = box{ size = { length, depth, width } }, material = stone,
                   mesh = { size = h, cells = "block", integration = "assumed_strain" } }
local function roller(name, x, y)
  return body{ name, shape = disc{ radius = radius, thickness = width, center = { x, y } }, material = steel, rigid = true, mesh = { size = 6*mm } }
end
local left  = roller("left", -span/2, -depth/2 - radius)
local right = roller("right", span/2, -depth/2 - radius)
local nose  = roller("nose", 0, depth/2 + radius)
for _, support in ipairs{ left, right } do hold{ support, at = "all", velocity = { 0, 0, 0 } } end
local drive = hold{ nose, at = "all", velocity = { 0, ramp{ to = -speed, over = 3*ms }, 0 } }
measure{ "load", unit = "N", function(now) return now.contact_force(beam, left, "y") + now.contact_force(beam, right, "y") end }
measure{ "deflection", unit = "mm", function(now)
  local ends = (now.displacement(beam, { -span/2, 0 }).y + now.displacement(beam, { span/2, 0 }).y)/2
  return (ends - now.displacement(beam, { 0, 0 }).y)/mm
end }
plot{ "load", against = "deflection" }
run{ time = 10*ms, mass_damping = 2000 }

local inertia, shear, area = width*depth^3/12, young/(2*(1 + poisson)), width*depth
expect{ "deflection over that of a beam under the same load", value = function(now)
  local load = now.load
  local beam_theory = load*span^3/(48*young*inertia) + load*span/(4*shear*area*5/6)
  return now.deflection*mm/beam_theory
end, equals = 1, tolerance = 0.06, why = "Euler's bending and Timoshenko's shear; the nose and the supports press in by some" }
