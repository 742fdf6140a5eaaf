-- A steel cube is pulled: what its flow law says.
-- test 2d:
-- test 3d:
local lab = require "lab"   -- docs/laboratory.md
local test = lab.cube{ material = "4340 steel" }
