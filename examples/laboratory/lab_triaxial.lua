-- The same block under 10 MPa from all sides.
-- test 2d: --set body.mesh.size=*2
-- test 3d: none
local lab = require "lab"   -- docs/laboratory.md
local test = lab.triaxial{ material = "granite", confine = 10*MPa }
