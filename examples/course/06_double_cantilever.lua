-- Course 6: a crack that is pulled open.  Two arms of a split beam are moved apart; the crack between them grows along a weak plane.
-- Theory (Griffith 1921): it grows when the energy that the bending of the arms sets free, 12 F^2 a^2/(E b^2 H^3), is G1. The arms also turn where the crack
-- ends, as beams on an elastic bed: Kanninen (1973) has a + 0.64 H for a.
-- Question: how much of the work of the grips has gone into the crack, how much is still in the arms?
-- Now change: G1 times four. The force at the end doubles. Then half the speed: how much was inertia?
-- test 2d:
-- test 3d: --set b=2.5
local h  = param{ "h", 2.5, "element size (mm), one that divides 5", least = 0.5, most = 2.5 }
local G1 = param{ "G1", 200, "of the plane (J/m2)", least = 20, most = 2000 }
local width = param{ "b", 10, "width (mm)", least = 0.5, most = 50 }
local L, H, b, a, E, v = 100*mm, 10*mm, width*mm, 40*mm, 70*GPa, 0.1
local s = 0.05   -- strength of the plane over that of the metal beside it; energies go with its square
local alu = material{ "aluminium", density = 2700, elastic = { young = E, poisson = 0 }, contact = { penalty = E, friction = 0 },
  fracture = { tension = 40*MPa/s, shear = 80*MPa/s, G1 = G1/s^2, G2 = 4*G1/s^2, penalty = 20*E, softening = "linear", insertion = "adaptive" } }
local beam = body{ "beam", shape = box{ size = { L, 2*H, b }, center = { L/2, 0 } }, material = alu, mesh = { size = h*mm, structured = true, cells = "block", integration = "assumed_strain" } }
joints{ "glue", beam, at = function(x, y) return x > a and math.abs(y) < 1e-6 end, strength = s }
joints{ "cut", beam, at = function(x, y) return x < a and math.abs(y) < 1e-6 end, strength = 0 }
local up, down = ramp{ to = v, over = 1*ms }, ramp{ to = -v, over = 1*ms }
local function tip(x) return x < 1e-6 end
local grip = hold{ beam, at = function(x, y) return tip(x) and math.abs(y - H/2) < 1e-6 end, velocity = { 0, up } }
hold{ beam, at = function(x, y) return tip(x) and math.abs(y + H/2) < 1e-6 end, velocity = { 0, down } }
assume{ two_d = "plane stress", thickness = b }

measure{ "pull", unit = "N", function(now) return now.reaction(grip, "y") end }
measure{ "opening", unit = "mm", function(now) return (now.displacement(beam, { 0, H/2 }).y - now.displacement(beam, { 0, -H/2 }).y)/mm end }
measure{ "crack", unit = "mm", function(now) return now.crack_area()/b/mm end }
-- Faces soften some way ahead of where they are broken: the length counts by the work that was spent on it.
measure{ "G", unit = "J/m2", function(now)
  local reach = a + now.energy("fracture")/(G1*b) + 0.64*H
  return 12*now.pull^2*reach^2/(E*b^2*H^3)
end }
plot{ "G", against = "crack" }
plot{ "pull", against = "opening" }
run{ time = 8*ms, mass_damping = 2e3, stop = function(now) return now.crack > 60 end }

expect{ "G at the end over G1", value = function(now) return now.mean("G", 1*ms)/G1 end, within = { 0.85, 1.15 }, why = "1 on average, here over a millisecond: the arms rattle" }
expect{ "work of fracture over G1 times area", value = function(now) return now.crack_energy()/(G1*b*(now.crack*mm - a)) end, within = { 0.95, 1.05 }, why = "what broke took G1" }
