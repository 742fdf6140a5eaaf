-- A notched beam of mortar is bent until it is through.
-- test 2d:
-- test 3d: none
local lab = require "lab"   -- docs/laboratory.md
local test = lab.three_point_bend{ material = "mortar" }
