-- Course 5: a cantilever, and what a mesh does to it.  A beam held at its left end carries a load at the other.
-- Theory (Timoshenko): deflection = F L^3/(3 E I) + F L/(5/6 G A).
-- Question: triangles sag less than they should. How many over the depth are enough?  Why do quadrilaterals need only two?
-- Now change: --set cells=0 (triangles, tetrahedra) with h = 10, 5, 2.5. The verdict tells you when there are too few: "coarse mesh".
-- test 2d:
-- test 3d:
local h     = param{ "h", 10, "element size (mm)", least = 1, most = 20 }
local cells = param{ "cells", 1, "1: quadrilaterals, hexahedra; 0: triangles, tetrahedra", least = 0, most = 1 }
local L, D, b, E, p = 200*mm, 20*mm, 20*mm, 70*GPa, 0.1*MPa
local alu = material{ "aluminium", density = 2700, elastic = { young = E, poisson = 0 } }
local beam = body{ "beam", shape = box{ size = { L, D, b }, center = { L/2, 0 } }, material = alu,
  mesh = { size = h*mm, structured = true, cells = cells == 1 and "block" or "simplex", integration = cells == 1 and "assumed_strain" or nil } }
hold{ beam, at = "left", velocity = { 0, 0, 0 } }
local load = ramp{ to = -p, over = 3*ms }
traction{ beam, at = "right", value = { 0, load } }
assume{ two_d = "plane stress", thickness = b }

measure{ "sag", unit = "mm", function(now) return -now.displacement(beam, { L, 0 }).y/mm end }
plot{ "sag" }
-- Its lowest frequency is 0.16 sqrt(E/rho) D/L^2 = 410 Hz: damping of 2 omega lets it settle without swinging.
run{ time = 9*ms, mass_damping = 2*2*math.pi*410 }

local F, I, A = p*D*b, b*D^3/12, b*D
local theory = F*L^3/(3*E*I) + F*L/(5/6*E/2*A)
expect{ "sag over theory", value = function(now) return now.sag*mm/theory end, within = cells == 1 and { 0.98, 1.01 } or { 0, 1 }, why = "F L^3/(3 E I), and shear" }
