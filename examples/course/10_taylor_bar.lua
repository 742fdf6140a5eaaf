-- Course 10: a metal rod hits a wall (G. I. Taylor 1948).  Its foot flows out like a mushroom; its length tells how strong the metal is when it is fast.
-- Theory (Taylor, for a metal that does not harden): v^2/2 rho of the part that still flies has been spent on yield; ln(length/L) is about -rho v^2/(2 yield).
-- Question: what becomes of the energy? Look at energy.png: nearly all is `plastic` by the end.
-- Now change: hardening = 0 in place of 100 MPa. Then v = 300. Then `two_d = "plane strain"`: why is a slab another experiment than a rod?
-- test 2d:
-- test 3d: --set h=1.2 --set time=30
local h    = param{ "h", 0.5, "element size (mm)", least = 0.2, most = 2 }
local v    = param{ "v", 227, "of the rod (m/s)", least = 20, most = 400 }
local time = param{ "time", 80, "(us)", least = 1, most = 200 }
local L, R = 32.4*mm, 3.2*mm
local soft = material{ "soft metal", density = 8930, elastic = { young = 117*GPa, poisson = 0.35 },
  plastic = { law = "j2", yield = 400*MPa, hardening = 100*MPa }, contact = { penalty = 117*GPa, friction = 0 } }
local rod = body{ "rod", shape = rod{ radius = R, length = L }, material = soft, velocity = { 0, -v },
  mesh = { size = h*mm, cells = "block", integration = "b_bar" } }
wall{ point = { 0, 0 }, normal = { 0, 1 } }
assume{ two_d = "axisymmetric" }

measure{ "length", unit = "mm", function(now) return now.size(rod).y/mm end }
measure{ "foot", unit = "mm", function(now) return now.size(rod).x/2/mm end }   -- its radius
plot{ "length" }
output{ every = time/20*us, fields = { "plastic_strain" } }
run{ time = time*us }
local rest = time >= 80
expect{ "length (mm)", value = function(now) return now.length end, within = rest and { 21.2, 21.7 } or { 20, 32.4 }, why = "another axisymmetric code: 21.45" }
expect{ "radius of the foot (mm)", value = function(now) return now.foot end, within = rest and { 6.9, 7.6 } or { 3.2, 8 }, why = "the same: 7.30" }
expect{ "plastic work over the rod's energy", value = function(now) return now.energy("plastic")/(0.5*8930*math.pi*R^2*L*v^2) end,
        within = rest and { 0.9, 1 } or { 0.3, 1 }, why = "what does not fly back" }
