-- A waisted stone is glued to two platens of steel, whose cells are three times as large, and torn apart.
-- Question: why does it not break at the glue? Give it straight sides (--set waist=15): where now, and at which load?
-- test 2d:
-- test 3d: --set h=5
local h     = param{ "h", 2, "element size of the stone (mm)", least = 1, most = 5 }
local waist = param{ "waist", 10, "half the width in the middle (mm)", least = 5, most = 15 }
local ft, W, H, t, P, v, R = 3*MPa, 30*mm, 60*mm, 10*mm, 15*mm, 20*mm/s, 40*mm
local stone = material{ "stone", density = 2600, elastic = { young = 50*GPa, poisson = 0.2 },
  fracture = { tension = ft, shear = 3*ft, G1 = 20*J/m2, G2 = 80*J/m2, penalty = 20*50*GPa, insertion = "adaptive" } }
local steel = material{ "steel", density = 7800, elastic = { young = 200*GPa, poisson = 0.3 } }
assume{ two_d = "plane stress", thickness = t }
local function cut(side) return disc{ center = { side*(waist*mm + R), 0 }, radius = R, thickness = 2*t } end
local specimen = body{ "specimen", shape = difference{ box{ size = { W, H, t } }, cut(-1), cut(1) }, material = stone, mesh = { size = h*mm } }
local function platen(name, side)
  return body{ name, shape = box{ center = { 0, side*(H + P)/2 }, size = { 2*W, P, t } }, material = steel, mesh = { size = 3*h*mm } }
end
local upper, lower = platen("upper", 1), platen("lower", -1)
local glue = tie{ "glue", upper, specimen }
tie{ "glue below", lower, specimen }
local grip = hold{ upper, at = "top", velocity = { 0, ramp{ to = v, over = 0.1*ms } } }
hold{ lower, at = "bottom", velocity = { 0, 0 } }

measure{ "carried", unit = "N", function(now) return now.tie_force(glue) end }
measure{ "gripped", unit = "N", function(now) return now.reaction(grip) end }
plot{ "carried", against = "gripped" }
output{ every = 40*us, fields = { "principal", "damage" } }
run{ time = 1.5*ms, mass_damping = 5e3, stop = function(now) return now.carried < 0.3*now.peak("carried") end }
expect{ "strength over ft", value = function(now) return now.peak("carried")/(2*waist*mm*t)/ft end, within = { 0.8, 1.1 },
        why = "1 for a waist that hardly bends the stress" }
expect{ "what the glue carries over what the grip does", value = function(now) return now.peak("carried")/now.peak("gripped") end, within = { 0.95, 1.02 },
        why = "alike, but for the drag on the platen between them" }
