-- A notched beam of concrete is bent until it is through.
-- test 2d: --set body.mesh.size=*1.5 --set body.mesh.near.size=*1.5
-- test 3d: none
local lab = require "lab"   -- docs/laboratory.md
local test = lab.three_point_bend{ material = "concrete" }
