-- asked: a block of steel that hits another, from a crawl to faster than its waves (5 km/s)
-- vary: speed=0.001,1,100,1000,6000
-- outcome single speed=0.001: do not trust: balance of energy
-- outcome 3d speed=1000: look again: contact too soft
-- outcome speed=6000: refused: verdict: do not trust: faster than waves
-- limit: contact, which holds what its penalty can; single precision below strains of 1e-6
local speed = param{ "speed", 1, "of one block (m/s)" }
local L = 10*mm
local steel = material{ "steel", density = 7800, elastic = { young = 200*GPa, poisson = 0.3 }, plastic = { law = "j2", yield = 500*MPa, pressure = "averaged" } }
local function block(name, x, v)
  return body{ name, shape = box{ size = { L, L, L }, center = { x, 0 } }, mesh = { size = 2.5*mm, structured = true }, material = steel, velocity = { v, 0 } }
end
local hits, hit = block("hits", -L/2, speed), block("is hit", L/2, 0)
run{ time = 12*us, safety = 0.4 }
expect{ "momentum at the end over that at the start", equals = 1, tolerance = 1e-4, why = "nothing else pushes",
        value = function(now) return (now.velocity(hits).x + now.velocity(hit).x)/speed end }
expect{ "speed of the block that is hit, over half the speed", within = { 0.5, 2.02 }, why = "it must be pushed; 1: both go on together, 2: elastic",
        value = function(now) return now.velocity(hit).x/(speed/2) end }
