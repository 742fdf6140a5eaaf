-- A bar runs against a wall and flows: Johnson-Cook with heat. round = 1: about the y axis, in 2D. averaged = 1: pressure of patches.
local round = param{ "round", 0, "2D: 1: axisymmetric", least = 0, most = 1 }
local averaged = param{ "averaged", 0, "1: pressure averaged over nodes", least = 0, most = 1 }
local time  = param("time", 6*us, "simulated time (s)")
local steel = material{ "steel",
  density = 7830,
  elastic = { young = 206.9*GPa, poisson = 0.29 },
  plastic = { law = "johnson_cook", A = 806*MPa, B = 614*MPa, C = 0.0089, n = 0.168, rate0 = 1, m = 1.1, melting = 1813,
              heat = { capacity = 460, share = 0.9, start = 293 }, pressure = averaged == 1 and "averaged" or nil },
}
local bar = body{ "bar", shape = box{ size = { 4*mm, 8*mm, 4*mm }, center = { 2*mm, 4*mm } }, mesh = { size = 1*mm, structured = true }, material = steel,
                  velocity = { 0, -150 } }
wall{ point = { 0, 0 }, normal = { 0, 1 } }
assume{ two_d = round == 1 and "axisymmetric" or "plane strain" }
measure{ "length", unit = "m", function(now) return now.size(bar).y end }
measure{ "plastic_strain", function(now) return now.largest("plastic_strain") end }
measure{ "temperature", unit = "K", function(now) return now.largest("temperature") end }
run{ time = time, allowed_residual = 1 }
