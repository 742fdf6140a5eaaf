-- Whole experiments from a material and sizes: local test = require "lab".ucs{ material = "granite" }
-- docs/laboratory.md lists them with their keys. Each says its bodies, plates or holds, loading, measures, plots, expectations and end, and
-- returns what it made.
local suggestion = ...
local materials = require "materials"
local lab = {}

-- ------------------------------------------------------------------------------------------------------------------------ keys

local needed, computed = {}, {}
local function some(default) return { least = 0, default = default } end   -- a number that may be 0

--- What was given, with defaults for what was not; anything else is an error.
local function options(test, given, keys)
  local function refuse(text) error("lab." .. test .. ": " .. text, 0) end
  if type(given) ~= "table" then refuse("needs a table: lab." .. test .. '{ material = "granite" }') end
  local known = {}
  for key in pairs(keys) do known[#known + 1] = key end
  for key in pairs(given) do
    if keys[key] == nil then
      local word = tostring(key)
      refuse(type(key) == "number" and "every value needs a key, as material = ..." or 'unknown key "' .. word .. '"' .. suggestion(word, known))
    end
  end
  if given.speed ~= nil and given.crossings ~= nil then refuse("speed and crossings say the same; give one of them") end
  local o = { test = test, refuse = refuse }
  for key, default in pairs(keys) do
    local value, zero = given[key], false
    if type(default) == "table" and default.least then default, zero = default.default, true end
    if value == nil then
      if default == needed then refuse(key .. " is missing") end
      if default ~= computed then value = default end
    elseif key ~= "material" and key ~= "fields" then
      local type_wanted = default == computed and "number" or type(default)
      if type(value) ~= type_wanted then refuse(key .. " must be a " .. type_wanted .. ", not a " .. type(value)) end
      if type_wanted == "number" and not (value > 0 or zero and value == 0) or value == math.huge then
        refuse(key .. " = " .. tostring(value) .. " is not allowed (it must be " .. (zero and ">= 0" or "> 0") .. ")")
      end
    end
    o[key] = value
  end
  return o
end

--- `inside`: the tables that t lies in; one that holds itself has no end.
local function copy(t, inside)
  if type(t) ~= "table" then return t end
  inside = inside or {}
  if inside[t] then error("a table holds itself: it cannot be copied", 0) end
  inside[t] = true
  local c = {}
  for key, value in pairs(t) do c[key] = copy(value, inside) end
  inside[t] = nil
  return c
end

--- The material as a table of its own, with what tests ask for beside it; `part`: what it must have.
local function stuff(o, part)
  local m = o.material
  if type(m) == "string" then m = materials[m] end
  if type(m) ~= "table" then
    o.refuse("material must be a name (fissure2d materials lists them) or a table as for material{}, not " ..
             (type(m) == "userdata" and "what material{} returned" or "a " .. type(m)))
  end
  m = copy(m)
  for _, key in ipairs{ "elastic", "plastic", "fracture", "contact" } do
    if m[key] ~= nil and type(m[key]) ~= "table" then o.refuse("the material's " .. key .. " must be a table, not a " .. type(m[key])) end
  end
  if m.density ~= nil and type(m.density) ~= "number" then o.refuse("the material's density must be a number, not a " .. type(m.density)) end
  local function has(table, key) return type(table) == "table" and type(table[key]) == "number" and table[key] > 0 end
  if not (has(m, "density") and has(m.elastic, "young")) then o.refuse("the material needs density and elastic = { young = , poisson = }") end
  if part and type(m[part]) ~= "table" then
    o.refuse(string.format('material "%s" has no %s part, which this test is about', tostring(m[1] or "?"), part))
  end
  local s = { table = m, named = type(o.material) == "string", E = m.elastic.young, density = m.density, c = math.sqrt(m.elastic.young/m.density) }
  if m.fracture then
    local f = m.fracture
    for _, key in ipairs{ "tension", "shear", "G1", "G2" } do
      if not has(f, key) then o.refuse("the material's fracture part needs " .. key) end
    end
    f.insertion = f.insertion or "adaptive"
    s.ft, s.cohesion, s.G1, s.angle = f.tension, f.shear, f.G1, f.friction_angle or 0
    s.compressive = 2*s.cohesion*math.cos(s.angle)/(1 - math.sin(s.angle))   -- Mohr-Coulomb
    s.zone = s.E*s.G1/s.ft^2                                                  -- of a crack's process
  end
  m.contact = m.contact or { penalty = s.E, friction = 0.3 }
  s.friction = m.contact.friction or 0
  return s
end

--- Edges of elements: a third of the process zone, but no less than a 32nd and no more than a 10th of the size (3D: a 4th).
local function element(o, s, size)
  if o.mesh then return o.mesh end
  if dim == 3 then return size/4 end
  return math.max(size/32, math.min(size/10, s.zone and s.zone/3 or size))
end

-- --------------------------------------------------------------------------------------------------------------------- loading

--- The speed at which a length is shortened (or stretched) in all, so that waves cross it `crossings` times until it has moved by `until_peak`:
--- each of them then carries that share of the strength. Returns the speed and the time that this takes.
local function pace(o, s, length, until_peak)
  local time = o.crossings*length/s.c
  if o.speed then return o.speed, until_peak/o.speed end
  return until_peak/time, time
end

local function balance(over)
  expect{ "balance of energy", value = function(now) return math.abs(now.energy("residual"))/now.energy(over or "external") end,
          within = { 0, 0.02 }, why = "every force books its work" }
end
local function frames(o, time, fields)
  output{ every = time/o.frames, fields = o.fields or fields }
end
--- Has the measure fallen to a share of its peak, once that was more than `least`?
local function dropped(now, name, share, least) return now.peak(name) > least and now[name] < share*now.peak(name) end

local function plates(o, s, specimen, speed, ramp_time)
  local touch = { penalty = 4*s.E, friction = o.friction }
  local top = plate{ "top", above(specimen), velocity = { 0, ramp{ to = -speed/2, over = ramp_time } }, contact = touch }
  local bottom = plate{ "bottom", below(specimen), velocity = { 0, ramp{ to = speed/2, over = ramp_time } }, contact = touch }
  return top, bottom
end

-- ------------------------------------------------------------------------------------------------- compression: plain, confined

local function compression(o, confine)
  local s = stuff(o, "fracture")
  local W, H, t = o.width, o.height, o.thickness
  local tangent = (1 + math.sin(s.angle))/(1 - math.sin(s.angle))
  local theory = s.compressive + tangent*confine
  local v, time = pace(o, s, H, 1.2*(theory - confine)/s.E*H)
  local specimen = body{ "specimen", shape = box{ size = { W, H, t } }, material = material(s.table),
                         mesh = { size = element(o, s, W), irregular = 0.2, seed = o.seed } }
  local top, bottom = plates(o, s, specimen, v, time/4)
  assume{ two_d = "plane strain", thickness = t }
  if confine > 0 then
    for _, side in ipairs(dim == 3 and { "left", "right", "front", "back" } or { "left", "right" }) do
      pressure{ specimen, at = side, value = ramp{ to = confine, over = time/4 } }
    end
  end
  measure{ "axial", unit = "MPa", function(now) return (now.force(top) + now.force(bottom))/2/(W*t)/MPa end }
  measure{ "strain", function(now) return (now.displacement(bottom).y - now.displacement(top).y)/H end }
  measure{ "crack", unit = "mm2", function(now) return now.crack_area()/mm2 end }
  plot{ "axial", against = "strain" }
  frames(o, 2*time, { "principal", "damage", "fragment" })
  run{ time = 2*time, mass_damping = 0.05*s.c/H, stop = function(now) return dropped(now, "axial", 0.5, theory/MPa/4) end }
  balance()
  expect{ "strength over Mohr-Coulomb", value = function(now) return now.peak("axial")*MPa/theory end, within = { 0.75, 1.3 },
          why = string.format("2 c cos(phi)/(1 - sin(phi)) and the confinement: %.4g MPa; faces lie where the mesh has them", theory/MPa) }
  return { specimen = specimen, top = top, bottom = bottom, strength = theory }
end

local compression_keys = { material = needed, width = 25*mm, height = 50*mm, thickness = 25*mm, mesh = computed, seed = some(0), friction = some(0),
                           speed = computed, crossings = 60, frames = 40, fields = computed }

function lab.ucs(given) return compression(options("ucs", given, compression_keys), 0) end

function lab.triaxial(given)
  local keys = copy(compression_keys)
  keys.material, keys.mesh, keys.speed, keys.fields = needed, computed, computed, computed
  keys.confine = some(10*MPa)
  local o = options("triaxial", given, keys)
  return compression(o, o.confine)
end

-- ------------------------------------------------------------------------------------------------------------------- brazilian

function lab.brazilian(given)
  local o = options("brazilian", given, { material = needed, diameter = 50*mm, thickness = 25*mm, mesh = computed, seed = some(0),
    friction = some(0.1), speed = computed, crossings = 60, frames = 40, fields = computed })
  local s = stuff(o, "fracture")
  local D, t = o.diameter, o.thickness
  local v, time = pace(o, s, D, 12*s.ft/s.E*D)
  local specimen = body{ "specimen", shape = disc{ radius = D/2, thickness = t }, material = material(s.table),
    mesh = { size = o.mesh or dim == 3 and D/12 or element(o, s, D), seed = o.seed, seam = { from = { 0, -D/2 }, to = { 0, D/2 } } } }
  local top, bottom = plates(o, s, specimen, v, time/4)
  assume{ two_d = "plane stress" }
  measure{ "strength", unit = "MPa", function(now) return (now.force(top) + now.force(bottom))/(math.pi*D*t)/MPa end }
  measure{ "widening", unit = "um",
          function(now) return (now.displacement(specimen, { D/2, 0 }).x - now.displacement(specimen, { -D/2, 0 }).x)/um end }
  measure{ "crack", unit = "mm2", function(now) return now.crack_area()/mm2 end }
  plot{ "strength", against = "widening" }
  frames(o, 2*time, { "principal", "damage" })
  run{ time = 3*time, mass_damping = 0.2*s.c/D, stop = function(now) return dropped(now, "strength", 0.6, s.ft/MPa/4) end }
  balance()
  expect{ "strength over ft", value = function(now) return now.peak("strength")*MPa/s.ft end, within = { 0.85, 1.6 },
          why = "1 for a brittle rock and a fine mesh; the longer its process zone beside the disc, the more" }
  return { specimen = specimen, top = top, bottom = bottom, strength = s.ft }
end

-- ---------------------------------------------------------------------------------------------------------------- direct shear

function lab.direct_shear(given)
  local o = options("direct_shear", given, { material = needed, length = 50*mm, height = 20*mm, thickness = 25*mm, normal = some(5*MPa),
    plane = some(0.1), mesh = computed, speed = computed, crossings = 90, frames = 40, fields = computed })
  local s = stuff(o, "fracture")
  local L, H, t = o.length, o.height, o.thickness
  s.table.fracture.criterion = "traction"                                     -- the plane is one of its own, whatever pulls askew to it
  local area, rows = L*t, 2*math.ceil(H/2/(o.mesh or H/(dim == 3 and 4 or 8)) - 1e-9)              -- a row of nodes lies in the plane
  local peak = o.plane*s.cohesion + o.normal*math.tan(o.plane > 0 and s.angle or 0)
  local rest = o.normal*s.friction
  local most = math.max(peak, rest)
  if o.plane > 1 then o.refuse("plane must be at most 1: a plane stronger than the rest is not where it breaks") end
  if most == 0 then o.refuse("normal and plane are 0: nothing would resist the shear") end
  local specimen = body{ "specimen", shape = box{ size = { L, H, t } }, material = material(s.table), mesh = { size = H/rows,
          structured = true, cells = "block" } }
  joints{ "plane", specimen, at = function(x, y) return math.abs(y) < 1e-6*H end, strength = o.plane }
  -- A stiff shear box: along the plane all but its own nodes move as one, across it they are free under the normal load.
  local v, time = pace(o, s, L, 20*most/s.E*H)
  local started = time/2                                                      -- the normal load is there
  local upper = hold{ specimen, at = function(x, y) return y > 0.5*H/rows end, velocity = { ramp{ to = v, over = time/2, start = started } } }
  local lower = hold{ specimen, at = function(x, y) return y < -0.5*H/rows end, velocity = { 0 } }
  hold{ specimen, at = "bottom", velocity = { nil, 0 } }
  traction{ specimen, at = "top", value = { 0, ramp{ to = -o.normal, over = started } } }
  assume{ two_d = "plane strain", thickness = t }
  measure{ "shear", unit = "MPa", function(now) return now.reaction(upper, "x")/area/MPa end }
  measure{ "slip", unit = "um", function(now) return (now.displacement(specimen, { 0, H/2 }).x - now.displacement(specimen, { 0, -H/2 }).x)/um end }
  measure{ "crack", unit = "mm2", function(now) return now.crack_area()/mm2 end }
  plot{ "shear", against = "slip" }
  frames(o, 4*time, { "principal", "damage", "displacement" })
  run{ time = 4*time, mass_damping = 0.2*s.c/L }
  balance()
  if most > 0 then
    expect{ "strength over Mohr-Coulomb", value = function(now) return now.peak("shear")*MPa/most end, within = { 0.7, 1.15 },
            why = string.format("the plane's cohesion and friction, %.4g MPa; its ends go first", most/MPa) }
  end
  if rest > 0 then
    expect{ "what is left over friction", value = function(now) return now.shear*MPa/rest end, within = { 0.85, 1.1 },
            why = "a broken plane slides with the material's contact friction" }
  end
  return { specimen = specimen, upper = upper, lower = lower, strength = peak }
end

-- --------------------------------------------------------------------------------------------------------------------- bending

function lab.three_point_bend(given)
  local o = options("three_point_bend", given, { material = needed, span = 125*mm, depth = 50*mm, thickness = 10*mm, notch = some(25*mm),
    mesh = computed, seed = some(0), speed = computed, crossings = 60, frames = 40, fields = computed })
  local s = stuff(o, "fracture")
  local S, D, b, a = o.span, o.depth, o.thickness, o.notch
  if a >= D then o.refuse("notch must be shorter than depth") end
  if s.named and s.table.fracture.insertion == "adaptive" then s.table.fracture.penalty = 4*s.E end   -- enough for what only opens
  if S < 1.5*D then o.refuse("span must be at least 1.5 times depth") end
  local h = o.mesh or dim == 3 and (D - a)/6 or math.max((D - a)/20, math.min((D - a)/6, s.zone/3))
  local width, r = math.min(D/25, math.max(a, D/100)), D/16                   -- of the notch's mouth, of a roller's half
  local shape = box{ size = { 1.4*S, D, b }, center = { 0, D/2 } }
  if a > 0 then shape = difference{ shape, polygon{ points = { { -width/2, -width/2 }, { width/2, -width/2 }, { 0, a } }, thickness = 2*b } } end
  local specimen = body{ "specimen", shape = shape, material = material(s.table),
    mesh = { size = 2.4*h, seed = o.seed, near = { from = { 0, a }, to = { 0, D }, radius = D/6, size = h },
             seam = { from = { 0, a }, to = { 0, D } } } }
  local smooth = { penalty = s.E, friction = 0 }
  local function roller(name, x, y, velocity) return plate{ name, box = box{ size = { 2*r, 2*r, 2*b }, center = { x, y } },
          velocity = velocity, contact = smooth } end
  -- Rollers go down by v. What opens a joint for good at the notch, 2 G1/ft, at an arm of S/4 over the ligament.
  local open = 2*s.G1/s.ft
  local elastic = 2*s.ft*b*(D - a)^2/(3*S) * S^3/(4*s.E*b*(D - a)^3)
  local v = pace(o, s, S, 4*elastic + 0.5*open*S/4/(D - a))
  local time = (4*elastic + 4*open*S/4/(D - a))/v
  roller("left", -S/2, -r)
  roller("right", S/2, -r)
  local top = roller("top", 0, D + r, { 0, ramp{ to = -v, over = time/10 } })
  assume{ two_d = "plane stress", thickness = b }
  measure{ "load", unit = "N", function(now) return now.force(top) end }
  measure{ "mouth", unit = "um",
          function(now) return (now.displacement(specimen, { width/2, 0 }).x - now.displacement(specimen, { -width/2, 0 }).x)/um end }
  measure{ "deflection", unit = "um", function(now) return -now.displacement(top).y/um end }
  measure{ "crack", unit = "mm2", function(now) return now.crack_area()/mm2 end }
  plot{ "load", against = "mouth" }
  plot{ "load", against = "deflection" }
  frames(o, time, { "principal", "damage" })
  run{ time = time, mass_damping = 0.17*s.c*D/S^2, stop = function(now) return dropped(now, "load", 0.03, 0)
          and now.crack_area() > 0.5*b*(D - a) end }
  balance()
  expect{ "work of fracture over G1 times the ligament", value = function(now) return now.energy("fracture")/(s.G1*b*(D - a)) end,
          within = { 0.5, 1.2 }, why = "1 when it is through; what is left under the press is pressed and holds on" }
  return { specimen = specimen, top = top }
end

-- ------------------------------------------------------------------------------------------------------ double cantilever beam

function lab.dcb(given)
  local o = options("dcb", given, { material = needed, length = 100*mm, arm = 10*mm, thickness = 10*mm, crack = 40*mm, mesh = computed,
    speed = computed, crossings = 40, frames = 40, fields = computed })
  local s = stuff(o, "fracture")
  local L, H, b, a = o.length, o.arm, o.thickness, o.crack
  if a > 0.6*L then o.refuse("crack must be at most 0.6 length, so that it has where to grow") end
  local h = H/(2*math.ceil(H/2/(o.mesh or H/4) - 1e-9))                        -- the arms' middles have nodes
  -- The crack's plane has the material's energy, and its strength but where no elements could resolve that (Griffith's load does not know it);
  -- all else is 10 times as strong (its energies go with the square), so that the crack stays in the plane.
  local weak, f = 0.1, s.table.fracture
  local ft = math.min(s.ft, math.sqrt(s.E*s.G1/(4*h)))
  f.tension, f.shear, f.G1, f.G2, f.scatter = ft/weak, f.shear*ft/s.ft/weak, f.G1/weak^2, f.G2/weak^2, nil
  if s.named and f.insertion == "adaptive" then f.penalty = 4*s.E end                     -- enough for what only opens
  local specimen = body{ "specimen", shape = box{ size = { L, 2*H, b }, center = { L/2, 0 } }, material = material(s.table),
                         mesh = { size = h, structured = true, cells = "block", integration = "assumed_strain" } }
  joints{ "plane", specimen, at = function(x, y) return x > a and math.abs(y) < 1e-6*H end, strength = weak }
  joints{ "cut", specimen, at = function(x, y) return x < a and math.abs(y) < 1e-6*H end, strength = 0 }
  -- Griffith with Kanninen's longer arm: it grows at this opening, which then goes with the square of the arm.
  local arm = a + 0.64*H
  local opens = 8*arm^2*math.sqrt(s.G1/(12*s.E*H^3))
  local v, time = pace(o, s, arm^2/H, opens)
  local finish = math.min(L - 2*H, a + 0.5*(L - a))
  time = 1.5*opens*((finish + 0.64*H)/arm)^2/v + time
  local function grip(side) return function(x, y) return x < 1e-6*L and math.abs(y - side*H/2) < 1e-6*H end end
  local upper = hold{ specimen, at = grip(1), velocity = { 0, ramp{ to = v/2, over = time/10 } } }
  local lower = hold{ specimen, at = grip(-1), velocity = { 0, ramp{ to = -v/2, over = time/10 } } }
  assume{ two_d = "plane stress", thickness = b }
  measure{ "pull", unit = "N", function(now) return now.reaction(upper, "y") end }
  measure{ "opening", unit = "mm",
          function(now) return (now.displacement(specimen, { 0, H/2 }).y - now.displacement(specimen, { 0, -H/2 }).y)/mm end }
  measure{ "crack", unit = "mm", function(now) return now.crack_area()/b/mm end }
  -- Faces soften some way ahead of where they are broken: the length counts by the work that was spent on it.
  measure{ "G", unit = "J/m2", function(now)
    local reach = arm + now.energy("fracture")/(s.G1*b)
    return 12*now.pull^2*reach^2/(s.E*b^2*H^3)
  end }
  plot{ "G", against = "crack" }
  plot{ "pull", against = "opening" }
  frames(o, time, { "principal", "damage" })
  run{ time = time, mass_damping = 0.06*s.c*H/arm^2, stop = function(now) return now.crack > finish/mm end }
  balance()
  expect{ "work of fracture over G1 times area", value = function(now) return now.crack_energy()/(s.G1*b*(now.crack*mm - a)) end,
          within = { 0.95, 1.05 }, why = "what broke took G1" }
  expect{ "crack", value = function(now) return now.crack end, within = { finish/mm, L/mm }, why = "it has grown half way to the end (mm)" }
  return { specimen = specimen, upper = upper, lower = lower }
end

-- ----------------------------------------------------------------------------------------------------- Hopkinson's split bars

function lab.shpb(given)
  local o = options("shpb", given, { material = needed, diameter = 10*mm, length = 8*mm, bar_diameter = 20*mm, bar_length = 600*mm,
    striker_length = 150*mm, striker = 10, mesh = computed, bar_mesh = computed, friction = some(0), frames = 40, fields = computed })
  local s = stuff(o)
  if not (s.table.plastic or s.table.fracture) then o.refuse("the material has neither a plastic nor a fracture part: nothing of it can fail") end
  if o.diameter > o.bar_diameter then o.refuse("diameter must not be larger than bar_diameter") end
  if o.striker_length > 0.4*o.bar_length then o.refuse("striker_length must be at most 0.4 bar_length: pulses may not overlap at the gauges") end
  local Db, Lb, Ls, D, L = o.bar_diameter, o.bar_length, o.striker_length, o.diameter, o.length
  -- Bars of a strong steel that stay elastic; along y, the specimen between 0 and L, the incident bar below it.
  local Eb, density = 200*GPa, 7850
  local c, ratio = math.sqrt(Eb/density), (Db/D)^2
  local steel = material{ "bar steel", density = density, elastic = { young = Eb, poisson = 0.3 },
                         contact = { penalty = 4*Eb, friction = o.friction } }
  local plastic = s.table.plastic
  if plastic and plastic.law ~= "drucker_prager" then plastic.pressure = plastic.pressure or "averaged" end
  local bar_mesh = { size = o.bar_mesh or Db/(dim == 3 and 3 or 4), cells = "block" }
  local function bar(name, base, length, velocity)
    return body{ name, shape = rod{ radius = Db/2, length = length, base = { 0, base } }, mesh = bar_mesh, material = steel, velocity = velocity }
  end
  local gap = 1e-3*L
  local striker = bar("striker", -Lb - Ls - gap, Ls, { 0, o.striker, 0 })
  local incident = bar("incident", -Lb, Lb)
  local specimen = body{ "specimen", shape = rod{ radius = D/2, length = L }, mesh = { size = o.mesh or D/(dim == 3 and 6 or 10) },
          material = material(s.table) }
  local transmitter = bar("transmitter", L, Lb)
  assume{ two_d = "axisymmetric" }
  local function gauge(bar, at) return function(now) return now.stress(bar, { Db/8, at }).yy end end
  local first, second = gauge(incident, -Lb/2), gauge(transmitter, L + Lb/2)
  local arrival = gap/o.striker + Lb/c                                         -- of the pulse at the specimen
  measure{ "incident_gauge", unit = "MPa", function(now) return -first(now)/MPa end }   -- pressure
  measure{ "transmitted_gauge", unit = "MPa", function(now) return -second(now)/MPa end }
  -- What the bars say of the specimen: force from behind it; from before it by the speeds of its ends.
  measure{ "specimen_stress", unit = "MPa", function(now) return -now.stress(transmitter, { Db/8, L + Db/2 }).yy*ratio/MPa end }
  measure{ "front_stress", unit = "MPa", function(now) return -now.stress(incident, { Db/8, -Db/2 }).yy*ratio/MPa end }
  measure{ "strain", function(now) return (now.displacement(incident, { 0, 0 }).y - now.displacement(transmitter, { 0, L }).y)/L end }
  measure{ "rate", unit = "1/s", function(now) return (now.velocity(incident, { 0, 0 }).y - now.velocity(transmitter, { 0, L }).y)/L end }
  if s.table.fracture then measure{ "crack", unit = "mm2", function(now) return now.crack_area()/mm2 end } end
  plot{ "specimen_stress", against = "strain" }
  plot{ "incident_gauge" }
  plot{ "transmitted_gauge" }
  plot{ "front_stress" }
  local time = arrival + 2*Ls/c + Lb/c                                         -- until the pulse has passed the second gauge
  frames(o, time, { "von_mises", "velocity", plastic and "plastic_strain" or "damage" })
  run{ time = time, mass_damping = 0 }
  local pulse = density*c*o.striker/2
  balance("elastic")
  expect{ "incident pulse over rho c v/2", value = function(now) return now.peak("incident_gauge")*MPa/pulse end, within = { 0.9, 1.35 },
          why = "one-dimensional theory; rods ring at the head of a pulse (Pochhammer)" }
  return { specimen = specimen, striker = striker, incident = incident, transmitter = transmitter, pulse = pulse }
end

-- ---------------------------------------------------------------------------------------------------------------- Taylor's bar

function lab.taylor(given)
  local o = options("taylor", given, { material = needed, diameter = 6.4*mm, length = 32.4*mm, speed = 200, mesh = computed, seed = some(0),
          time = computed, frames = 40, fields = computed })
  local s = stuff(o, "plastic")
  local R, L, plastic = o.diameter/2, o.length, s.table.plastic
  local time = o.time or 0.5*L/o.speed + 8*L/s.c                              -- it shortens by less than a half, and rings
  plastic.pressure = plastic.pressure or (plastic.law ~= "drucker_prager" and not s.table.fracture and "averaged" or nil)
  local specimen = body{ "specimen", shape = rod{ radius = R, length = L }, mesh = { size = o.mesh or R/(dim == 3 and 3 or 8),
          seed = o.seed }, material = material(s.table), velocity = { 0, -o.speed, 0 } }
  local floor = wall{ "anvil", point = { 0, 0 }, normal = { 0, 1 }, contact = { penalty = s.table.contact.penalty, friction = 0 } }
  assume{ two_d = "axisymmetric" }
  measure{ "length", unit = "mm", function(now) return now.size(specimen).y/mm end }
  measure{ "foot", unit = "mm", function(now) return now.size(specimen).x/mm end }
  measure{ "plastic_strain", function(now) return now.largest("plastic_strain") end }
  measure{ "rear_speed", unit = "m/s", function(now) return -now.velocity(specimen, { 0, L }).y end }
  plot{ "length" }
  plot{ "foot" }
  frames(o, time, { "von_mises", "plastic_strain", "velocity" })
  run{ time = time }
  balance("plastic")
  expect{ "plastic work over the bar's energy", value = function(now) return now.energy("plastic")/(0.5*s.density*math.pi*R^2*L*o.speed^2) end,
          within = { o.time and 0.05 or 0.8, 1 }, why = "what does not fly back has flowed" }
  return { specimen = specimen, anvil = floor }
end

-- ------------------------------------------------------------------------------------------------------------- expanding ring

function lab.ring(given)
  local o = options("ring", given, { material = needed, radius = 25*mm, width = 2.5*mm, thickness = 1*mm, speed = 40, modulus = 25,
          mesh = computed, seed = some(0), time = computed, frames = 20, fields = computed })
  local s = stuff(o, "fracture")
  local R, w, v = o.radius, o.width, o.speed
  if w >= R then o.refuse("width must be smaller than radius") end
  -- It tears when stretched by ft/E, into pieces whose length balances kinetic energy and that of cracks (Grady 1982).
  local tears, piece = R*s.ft/(s.E*v), (24*s.G1*R^2/(s.density*v^2))^(1/3)
  local pieces = 2*math.pi*R/piece
  local time = o.time or 30*tears + 5*(2*s.G1/s.ft)*R/(piece*v) + 10*w/s.c
  local f = s.table.fracture
  f.scatter = f.scatter or { modulus = o.modulus, seed = o.seed }             -- if all were alike, all would break at once
  local h = o.mesh or w/(dim == 3 and 2 or 3)
  local specimen = body{ "specimen", shape = ring{ inner = R - w, outer = R, thickness = o.thickness }, mesh = { size = h,
          seed = o.seed }, material = material(s.table),
    velocity = function(x, y) local r = math.sqrt(x*x + y*y) return { v*x/r, v*y/r, 0 } end }
  assume{ two_d = "plane stress", thickness = o.thickness }
  measure{ "pieces", function(now) return #now.fragments() end }
  measure{ "heaviest", function(now)
    local all, sum = now.fragments(), 0
    for _, piece in ipairs(all) do sum = sum + piece.mass end
    return all[1].mass/sum
  end }
  measure{ "crack", unit = "mm2", function(now) return now.crack_area()/mm2 end }
  plot{ "pieces" }
  output{ every = time/o.frames, measure_every = time/200, fields = o.fields or { "principal", "fragment" } }
  run{ time = time }
  balance("kinetic")
  local resolved = s.zone > h
  expect{ "pieces", value = function(now) return now.pieces end, within = resolved and { math.max(2, pieces/4), math.max(8, 4*pieces) } or { 2, 1e6 },
          why = string.format("Grady's balance of energies says about %.0f", pieces) .. (resolved and ""
                  or "; elements are longer than the process zone, so that they decide") }
  return { specimen = specimen, tears = tears, pieces = pieces }
end

-- ------------------------------------------------------------------------------------------------------------- a cube is pulled

--- The stress that a flow law says at a plastic strain, a rate and a temperature; nil where the law is no formula.
local function flow_stress(plastic)
  local law = plastic.law or "j2"
  if law == "johnson_cook" then
    local n, C, m, heat = plastic.n or 1, plastic.C or 0, plastic.m or 0, plastic.heat
    local start = heat and heat.start or 293.15
    return function(strain, rate, T)
      local soft = heat and m > 0 and 1 - math.max(0, (T - start)/((plastic.melting or 1800) - start))^m or 1
      return (plastic.A + (plastic.B or 0)*strain^n)*(1 + C*math.max(0, math.log(rate/(plastic.rate0 or 1))))*soft
    end
  elseif law == "j2" and type(plastic.yield) == "number" then
    return function(strain) return plastic.yield + (plastic.hardening or 0)*strain end
  end
end

function lab.cube(given)
  local o = options("cube", given, { material = needed, size = 10*mm, stretch = computed, rate = computed, crossings = 50, mesh = computed,
          frames = 40, fields = computed })
  local s = stuff(o)
  local a, plastic = o.size, s.table.plastic
  local breaks = s.ft and s.ft/s.E
  if not (plastic or breaks) then o.refuse("the material has neither a plastic nor a fracture part: nothing of it can fail") end
  local stretch = o.stretch or (plastic and 0.2 or 2*breaks)
  local rate = o.rate or (plastic and 200 or breaks*s.c/(o.crossings*a))
  local v, time = rate*a, stretch/rate
  -- It moves from the start as it will be pulled: no wave runs through it.
  local specimen = body{ "specimen", shape = box{ size = { a, a, a } }, mesh = { size = o.mesh or a/4, structured = true },
          material = material(s.table),
                         velocity = function(x, y) return { 0, v*(y/a + 0.5), 0 } end }
  hold{ specimen, at = "bottom", velocity = { nil, 0 } }
  local top = hold{ specimen, at = "top", velocity = { nil, v } }
  assume{ two_d = "plane stress", thickness = a }
  measure{ "stretch", function(now) return v*now.time/a end }
  measure{ "pull", unit = "MPa", function(now) return now.reaction(top, "y")/a^2/MPa end }   -- of the first section
  measure{ "true_stress", unit = "MPa", function(now) return now.stress(specimen, { 0, 0 }).yy/MPa end }
  plot{ "true_stress", against = "stretch" }
  plot{ "pull", against = "stretch" }
  local law = plastic and flow_stress(plastic)
  if plastic then measure{ "plastic_strain", function(now) return now.field("plastic_strain", specimen, { 0, 0 }) end } end
  if law then
    measure{ "law", unit = "MPa", function(now)
      return law(now.plastic_strain, math.max(1e-9, now.field("plastic_rate", specimen, { 0, 0 })),
                 plastic.heat and now.field("temperature", specimen, { 0, 0 }) or 0)/MPa
    end }
    plot{ "law", against = "stretch" }
  end
  if breaks then measure{ "crack", unit = "mm2", function(now) return now.crack_area()/mm2 end } end
  frames(o, time, { "von_mises", plastic and "plastic_strain" or "damage" })
  run{ time = time, mass_damping = breaks and 0.05*s.c/a or 0,
       stop = breaks and function(now) return now.time > 0.2*time and dropped(now, "pull", 0.1, 0) end or nil }
  balance()
  if law and not breaks then
    expect{ "true stress over the law's", value = function(now) return now.true_stress/now.law end, within = { 0.99, 1.01 },
            why = "the law at this plastic strain, rate and temperature" }
  elseif breaks and not plastic then
    expect{ "strength over ft", value = function(now) return now.peak("pull")*MPa/s.ft end, within = { 0.95, 1.1 },
            why = "all of it is at its strength at once" }
  end
  return { specimen = specimen, top = top }
end

-- ---------------------------------------------------------------------------------------------------------------- instruments
-- Each returns a function of now: measure{ "strain", lab.extensometer(bar, { 0, -20*mm }, { 0, 20*mm }) }.
-- Points are given where they lie before the run; the nodes nearest to them are followed.

local function points(name, body, p, q)
  local function refuse(text) error("lab." .. name .. ": " .. text, 0) end
  if type(body) ~= "userdata" then refuse("value 1 must be a body, not a " .. type(body)) end
  local between = 0
  for k = 1, 3 do
    for number, point in ipairs{ p or 0, q or 0 } do
      if type(point) ~= "table" or type(point[k] or k == 3 and 0) ~= "number" then
        refuse("value " .. number + 1 .. " must be a point { x, y } or { x, y, z }")
      end
    end
    between = between + ((q[k] or 0) - (p[k] or 0))^2
  end
  if not (between > 0) then refuse("both points are the same") end
  return math.sqrt(between)
end

--- How much further two points of a body are apart than at rest [m]: the mouth of a notch, a gauge across a crack.
function lab.opening(body, p, q)
  local rest = points("opening", body, p, q)
  return function(now)
    local a, b = now.displacement(body, p), now.displacement(body, q)
    local x, y, z = q[1] - p[1] + b.x - a.x, q[2] - p[2] + b.y - a.y, (q[3] or 0) - (p[3] or 0) + b.z - a.z
    return math.sqrt(x*x + y*y + z*z) - rest
  end
end

--- The same over their distance at rest [-]: an extensometer, or a strain gauge where it is short.
function lab.extensometer(body, p, q)
  local rest = points("extensometer", body, p, q)
  local opening = lab.opening(body, p, q)
  return function(now) return opening(now)/rest end
end

--- A field with one component at n places of a body from p to q: a list of s, the distance from p [m], and value.
function lab.profile(field, body, p, q, n)
  local rest = points("profile", body, p, q)
  n = n or 20
  if math.type(n) ~= "integer" or n < 2 then
    error("lab.profile: value 5 must be a whole number of places, 2 at least", 0)
  end
  return function(now)
    local list = {}
    for k = 0, n - 1 do
      local s = k/(n - 1)
      local at = {}
      for c = 1, 3 do at[c] = (p[c] or 0) + s*((q[c] or 0) - (p[c] or 0)) end
      list[#list + 1] = { s = s*rest, value = now.field(field, body, at) }
    end
    return list
  end
end

return lab
