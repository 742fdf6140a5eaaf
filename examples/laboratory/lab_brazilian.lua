-- A marble disc splits between two plates: tensile strength by pressure.
-- test 2d:
-- test 3d: none
local lab = require "lab"   -- docs/laboratory.md
local test = lab.brazilian{ material = "marble" }
