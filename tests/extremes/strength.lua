-- asked: a bar that is torn apart at its waist, with joints that hold next to nothing and joints that never break
-- vary: f=1e-6,1,1e6
-- limit: none found
local f = param{ "f", 1, "strength (MPa); fracture energies go with its square" }
local E, L, a, G = 10*GPa, 40*mm, 5*mm, 10*f^2
local stuff = material{ "stuff", density = 2000, elastic = { young = E, poisson = 0 },
  fracture = { tension = f*MPa, shear = 3*f*MPa, G1 = G, G2 = 10*G, penalty = 20*E } }
local bar = body{ "bar", shape = box{ size = { L, a, a } }, mesh = { size = 5*mm, structured = true }, material = stuff }
joints{ "waist", bar, from = { 0, -a }, to = { 0, a }, strength = 0.5 }
local T, breaks = 2*ms, f < 1000
local pull = breaks and 4e-4*L*f or 1e-4*L
hold{ bar, at = "left", velocity = { 0 } }
hold{ bar, at = "right", velocity = { function(t) return pull/T*(1 - math.cos(2*math.pi*t/T)) end } }
run{ time = T, mass_damping = 5e4 }
measure{ "pull", unit = "Pa", function(now) return now.stress(bar, { L/4, 0 }).xx end }
expect{ "largest stress over what the waist bears, or over E times strain", equals = 1, tolerance = 0.05, why = "Rankine, Hooke",
        value = function(now) return breaks and now.peak("pull")/(0.5*f*MPa) or now.pull*1.05*L/(E*pull) end }
expect{ "energy of cracks over G times the area of the waist", within = { breaks and 0.99 or 0, breaks and 1.01 or 0 }, why = "one crack, or none",
        value = function(now) return now.crack_energy()/(0.25*G*a^2) end }
