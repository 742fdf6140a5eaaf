-- asked: two blocks that begin within one another, by a share of an element
-- vary: share=0,0.01,0.5
-- outcome share=0.01: look again: overlap at the start
-- outcome share=0.5: refused: overlap by 0.0025 m at the start
-- limit: what contact holds at the start drives them apart; it is named and booked
local share = param{ "share", 0, "depth over the size of an element" }
local E, L, h = 1*GPa, 20*mm, 5*mm
local stuff = material{ "stuff", density = 1000, elastic = { young = E, poisson = 0.2 }, contact = { penalty = E } }
local function block(name, x)
  return body{ name, shape = box{ size = { L, L, L }, center = { x, 0 } }, mesh = { size = h, structured = true }, material = stuff }
end
local left, right = block("left", -(L - share*h)/2), block("right", (L - share*h)/2)
run{ time = 300*us }
expect{ "gap at the end, negative when they overlap, over the size of an element", within = { -1e-6, 10 }, why = "contact drives them apart",
        value = function(now) return (now.displacement(right, { h, 0 }).x - now.displacement(left, { -h, 0 }).x)/h - share end }
