-- A round rod in torsion: its foot is held, its head is turned slowly by a degree (docs/theory/loads.md, Motion about an axis).
-- Question: how many cells across does it need, and of which kind?
-- test 2d: none
-- test 3d: --set h=2
local h      = param("h", 1, "element size (mm)")
local blocks = param{ "blocks", 0, "1: hexahedra, fully integrated; 0: tetrahedra", least = 0, most = 1 }
local R, L, E, nu, angle, T = 5*mm, 40*mm, 50*GPa, 0.25, 1*deg, 0.5*ms
local stone = material{ "stone", density = 2700, elastic = { young = E, poisson = nu } }
local rod = body{ "rod", shape = rod{ radius = R, length = L }, material = stone,
                  mesh = { size = h*mm, cells = blocks == 1 and "block" or "simplex", integration = blocks == 1 and "full" or nil } }
hold{ rod, at = "bottom", velocity = { 0, 0, 0 } }
local head = hold{ rod, at = "top", around = { axis = { 0, 1, 0 }, turning = ramp{ to = 2*angle/T, over = T } } }
run{ time = T, mass_damping = 1e4 }

-- Saint-Venant's torque G J angle/L, with J = pi R^4/2 (Timoshenko & Goodier, Theory of Elasticity), and half of that times the angle.
local closed = E/(2*(1 + nu))*math.pi*R^4/2*angle/L
measure{ "moment", unit = "N m", function(now) return now.torque(head) end }
measure{ "stored", unit = "J", function(now) return now.energy("elastic") end }
expect{ "energy over the closed form's", value = function(now) return now.stored/(closed*angle/2) end, within = { 0.9, 1.2 },
        why = "Saint-Venant; too much with few tetrahedra across" }
expect{ "torque over what the energy asks for", value = function(now) return now.moment*angle/(2*now.stored) end,
        equals = 1, tolerance = 0.01, why = "an elastic rod: twice the energy over the angle" }
finish{ function(now) print(string.format("elastic energy over the closed form: %.3f", now.stored/(closed*angle/2))) end }
