-- A split beam of PMMA is pulled apart: the energy that a crack needs.
-- test 2d:
-- test 3d: --set body.mesh.size=*2
local lab = require "lab"   -- docs/laboratory.md
local test = lab.dcb{ material = "PMMA" }
