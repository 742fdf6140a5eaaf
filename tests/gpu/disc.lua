-- The Brazilian disc of tables 5 and 6 of the INFIDEP paper, from a prepared mesh: disc_24k.msh and so on, made by scripts/gpu_bundle.
local size = param("size", 24, "thousands of cells: 24, 184 or 619 tets, 41 triangles")
local E = 50*GPa
local rock = material{ "rock",   -- numbers of table 4
  density  = 2700,
  elastic  = { young = E, poisson = 0.25, damping = { share = 0.1 } },
  fracture = { tension = 3*MPa, shear = 31.5*GPa, G1 = 5*J/m2, G2 = 5*J/m2, penalty = 0.8*E },
  contact  = { penalty = 40*GPa, friction = 0.1 },
}
body{ "disc", shape = mesh_file{ string.format("disc_%dk.msh", size) }, mesh = { size = 1*mm }, material = rock }
for _, side in ipairs{ 1, -1 } do
  plate{ box = box{ size = { 50*mm, 10*mm, 50*mm }, center = { 0, 30*mm*side } }, velocity = { 0, -2*side } }
end
run{ time = 1*ms }
