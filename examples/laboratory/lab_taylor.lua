-- A rod of Armco iron hits an anvil at 200 m/s.
-- test 2d:
-- test 3d:
local lab = require "lab"   -- docs/laboratory.md
local test = lab.taylor{ material = "Armco iron", speed = 200 }
