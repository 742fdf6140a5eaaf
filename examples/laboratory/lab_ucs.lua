-- A granite block is crushed between two smooth plates: its strength in compression.
-- test 2d: --set body.mesh.size=*2
-- test 3d: none
local lab = require "lab"   -- docs/laboratory.md
local test = lab.ucs{ material = "granite" }
