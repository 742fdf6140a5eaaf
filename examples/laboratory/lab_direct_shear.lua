-- Two halves of a sandstone block slide along a weak plane under 5 MPa.
-- test 2d:
-- test 3d: none
local lab = require "lab"   -- docs/laboratory.md
local test = lab.direct_shear{ material = "sandstone", normal = 5*MPa }
