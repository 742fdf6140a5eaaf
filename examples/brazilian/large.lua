-- The paper's large Brazilian test (sec. 4.3.2, table 7: numbers of Fukuda et al. 2020), 182 000 tetrahedra at the default size in 3D (the paper: 184 395).
--   fissure3d run large.lua
-- Joints on demand leave the disc its stiffness without the penalty of 1000 E, whose step is far shorter; 5 E, so that they hold less than G at
-- their peak.
-- Table 7 gives slip the fracture energy of opening, 2 J/m2, at ten times the strength: it softens over 0.2 mm, which no mesh of it shows, and the disc
-- crushes under the plates at 0.57 of its strength in 2D (--set G2=2). With (shear/tension)^2 times that, slip softens over the same length as opening.
-- test 2d: --set h=2e-3 --set speed=0.1
-- test 3d: --set h=5e-3 --set thickness=5e-3 --set speed=0.1 --set time=4e-5
local v     = param("speed", 0.05, "speed of each plate (m/s)")
local h     = param("h", 1.065*mm, "element size (m)")
local t     = param("thickness", 25*mm, "thickness of the disc (m)")
local ratio = param("ratio", 5, "penalty of joints over Young's modulus; the paper's is 1000")
local contact = param("contact", 2, "penalty of contact over Young's modulus; the paper's is 10, whose steps are 0.6 as long in 2D")
local demand = param{ "on_demand", 1, "1: joints are inserted on demand; 0: they are there from the start", least = 0, most = 1 }
local G2      = param("G2", 200, "fracture energy of slip (J/m2); the paper's is 2")
local scaling = param("mass_scaling", 1, "how many times too heavy; the paper's is 5")
local calm  = param("calm", 2e4, "mass-proportional damping (1/s)")
local seam  = param{ "seam", 1, "1: the mesh has faces along the loaded diameter", least = 0, most = 1 }
local time  = param("time", 1.5*ms*0.05/v, "longest simulated time (s)")

local E, ft = 12.2*GPa, 1.2*MPa
local rock = material{ "rock",
  density  = 1800,
  elastic  = { young = E, poisson = 0.25 },
  fracture = { tension = ft, shear = 12*MPa, G1 = 2*J/m2, G2 = G2*J/m2, penalty = ratio*E, insertion = demand == 1 and "adaptive" or "intrinsic" },
  contact  = { penalty = contact*E, friction = 0.1 },
}
local disc = body{ "disc", shape = disc{ radius = 25*mm, thickness = t }, material = rock,
  mesh = { size = h, seam = seam == 1 and { from = { 0, -25*mm }, to = { 0, 25*mm } } or nil } }
local top    = plate{ "top",    above(disc), velocity = { 0, -v } }
local bottom = plate{ "bottom", below(disc), velocity = { 0,  v } }
measure{ "load", unit = "N", function(now) return (now.force(top) + now.force(bottom))/2 end }
measure{ "tensile_stress", unit = "Pa", function(now) return 2*now.load/(math.pi*disc.diameter*disc.thickness) end }
measure{ "axial_strain", function(now) return 2*v*now.time/disc.diameter end }
measure{ "crack", unit = "m2", function(now) return now.crack_area() end }
plot{ "tensile_stress", against = "axial_strain" }
output{ every = time/30, fields = { "stress", "principal", "damage" } }
run{ time = time, mass_damping = calm, mass_scaling = scaling, stop = function(now)
  local peak = now.peak("tensile_stress")
  return peak > ft/2 and now.tensile_stress < peak/3 and now.time > 1.2*now.peak_time("tensile_stress")
end }
