-- Concrete seen closely: stones in mortar, the skin of each weaker than both. The crack goes around the stones.
-- test 2d: --set h=2.5 --set time=300
-- test 3d: none
local h    = param{ "h", 1.6, "edge length (mm)", least = 0.3, most = 5 }
local skin = param{ "skin", 0.5, "strength of the stones' skins over that of the mortar", least = 0.05, most = 5 }
local time = param("time", 600, "time (us)")

local function stuff(name, young, tension, G1)
  return material{ name, density = 2400, elastic = { young = young, poisson = 0.2 },
    fracture = { tension = tension, shear = 5*tension, G1 = G1, G2 = 4*G1, penalty = 20*young, softening = "exponential" },
    contact = { penalty = young, friction = 0.5 } }
end
local mortar, granite = stuff("mortar", 25*GPa, 4*MPa, 40*J/m2), stuff("granite", 60*GPa, 10*MPa, 100*J/m2)

-- Stones: circles of three sizes, a millimetre apart at least.
local width, height = 60*mm, 40*mm
math.randomseed(7)
local circles, stones = {}, {}
for _, radius in ipairs{ 7*mm, 5*mm, 3.5*mm } do
  for _ = 1, 200 do
    local x = (math.random() - 0.5)*(width - 2*radius - 3*mm)
    local y = (math.random() - 0.5)*(height - 2*radius - 3*mm)
    local free = true
    for _, c in ipairs(circles) do free = free and math.sqrt((x - c.x)^2 + (y - c.y)^2) > radius + c.radius + 1*mm end
    if free and #circles < 14 then circles[#circles + 1] = { x = x, y = y, radius = radius } end
  end
end
local parts = { box{ size = { width, height, 10*mm } } }
for i, c in ipairs(circles) do
  local shape = disc{ center = { c.x, c.y }, radius = c.radius, thickness = 10*mm }
  parts[i + 1] = shape
  stones[i] = body{ "stone " .. i, shape = shape, mesh = { size = h*mm }, material = granite }
end
local matrix = body{ "mortar", shape = difference(parts), mesh = { size = h*mm }, material = mortar }

local all = { "skin", matrix, table.unpack(stones) }
all.fracture = { tension = skin*4*MPa, shear = skin*12*MPa, G1 = skin*40*J/m2, G2 = skin*160*J/m2, penalty = 500*GPa, softening = "exponential" }
bond(all)

local speed = ramp{ to = 0.1, over = 100*us }
hold{ matrix, at = "left", velocity = { 0, nil } }
local grip = hold{ matrix, at = "right", velocity = { speed, nil } }

measure{ "elongation", unit = "um", function(now) return now.displacement(matrix, { width/2, 0 }).x/um end }
measure{ "pull", unit = "N", function(now) return now.reaction(grip, "x") end }
measure{ "crack", unit = "mm2", function(now) return now.crack_area()/mm^2 end }
measure{ "pieces", function(now) return #now.fragments() end }
plot{ "pull", against = "elongation" }
output{ every = time/20*us, fields = { "principal", "damage", "material", "fragment" } }
run{ time = time*us, mass_damping = 5e3 }
expect{ "balance", value = function(now) return math.abs(now.energy("residual"))/now.energy("external") end, within = { 0, 1e-3 },
        why = "no path of opening and slip gives work" }
expect{ "strength over the mortar's", value = function(now) return now.peak("pull")/(4*MPa*height*10*mm) end, within = { skin, 1.1 },
        why = "between that of a cut through skins alone and one through mortar" }
