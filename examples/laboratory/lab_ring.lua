-- A granite ring flies apart at 40 m/s.
-- test 2d:
-- test 3d: none
local lab = require "lab"   -- docs/laboratory.md
local test = lab.ring{ material = "granite" }
