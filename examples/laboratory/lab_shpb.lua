-- A copper disc between Hopkinson's bars: 10 m/s of the striker.
-- test 2d:
-- test 3d:
local lab = require "lab"   -- docs/laboratory.md
local test = lab.shpb{ material = "OFHC copper" }
