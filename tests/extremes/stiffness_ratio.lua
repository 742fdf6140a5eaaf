-- asked: a stiff block pressed on a soft one that is lighter, too: densities differ by the power two thirds of the number, ten thousand times at 1e6
-- vary: ratio=1,1e4
-- long: ratio=1e6
-- outcome single ratio=1e6: do not trust: single precision
-- limit: time; the heavy block swings slowly on the soft one, and the step is that of the stiff one
local ratio = param{ "ratio", 1e6, "Young's modulus of the stiff block over that of the soft one" }
local E, L, density = 1*MPa, 20*mm, 1000
local c, heavy = math.sqrt(E/density), ratio^(1/3)
local T = 60*L/c*(heavy + 1)

local function stuff(name, k)
  return material{ name, density = density*k^(2/3), elastic = { young = E*k, poisson = 0 }, contact = { penalty = 10*E } }
end
local function block(name, y, what)
  return body{ name, shape = box{ size = { L, L, L }, center = { 0, y } }, mesh = { size = 10*mm, structured = true }, material = what }
end
local soft, stiff = block("soft", L/2, stuff("foam", 1)), block("stiff", 3*L/2, stuff("metal", ratio))
local below = hold{ soft, at = "bottom", velocity = { 0, 0, 0 } }
local above = hold{ stiff, at = "top", velocity = { 0, function(t) return -0.01*L/T*(1 - math.cos(2*math.pi*t/T)) end, 0 } }
run{ time = T, mass_damping = 2*c/L/heavy }
expect{ "push on the stiff block over that under the soft one", equals = 1, tolerance = 0.02, why = "they rest",
        value = function(now) return now.reaction(above)/now.reaction(below) end }
expect{ "stress over E times strain in the soft one", equals = 1, tolerance = 0.02, why = "Hooke; strain is 1 %",
        value = function(now) return now.stress(soft, { 0, L/2 }).yy*L/(E*now.displacement(soft, { 0, L }).y) end }
