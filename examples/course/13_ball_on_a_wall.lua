-- Course 13: a ball bounces off a wall.  Contact that grows: the harder it is pressed, the more of it touches.
-- Theory: Hertz (1882): F = 4/3 E' sqrt(R) d^(3/2), E' = E/(1 - nu^2). A ball of mass m at the speed v touches for 2.868 (m^2/(R E'^2 v))^(1/5) and is
-- pressed in by (15 m v^2/(16 E' sqrt(R)))^(2/5), where what touches is small beside the ball and waves run through it many times meanwhile.
-- It is elastic here at any speed; real steel is dented from some tenths of a metre per second on, since the middle of what touches bears 10 GPa and more.
-- Question: twice as fast, how much shorter does it touch?
-- Now change: --set v=5, and 20: when does Hertz fit better?  In 3D take --set h=3.
-- test 2d:
-- test 3d: --set h=3
local v = param{ "v", 10, "speed (m/s)", least = 1, most = 50 }
local h = param{ "h", 1, "element size (mm); an eighth where it touches", least = 0.5, most = 4 }
local R, E, nu, density = 10*mm, 210*GPa, 0.3, 7850
local steel = material{ "steel", density = density, elastic = { young = E, poisson = nu }, contact = { penalty = 10*E, friction = 0 } }
local ball = body{ "ball", shape = ball{ radius = R, center = { 0, R } }, material = steel, velocity = { 0, -v, 0 },
                   mesh = { size = h*mm, near = { { from = { 0, 0 }, radius = 2*mm, size = h/8*mm } } } }
local floor = wall{ "floor", point = { 0, 0 }, normal = { 0, 1 } }
assume{ two_d = "axisymmetric" }

measure{ "pressed", unit = "kN", function(now) return now.wall_force(floor)/kN end }
measure{ "depth", unit = "mm", function(now) return -now.displacement(ball, { 0, R }).y/mm end }
measure{ "speed", unit = "m/s", function(now) return now.velocity(ball).y end }
plot{ "pressed" }
plot{ "pressed", against = "depth" }
output{ every = 2*us, measure_every = 0.1*us, fields = { "pressure" } }
run{ time = 60*us, stop = function(now) return now.speed > 0 and now.wall_force(floor) == 0 end }

local m, Es = 4/3*math.pi*R^3*density, E/(1 - nu^2)
local d = (15*m*v^2/(16*Es*math.sqrt(R)))^0.4
local why = "Hertz; what touches is a tenth of R, so to about a tenth"
expect{ "speed after it", value = function(now) return now.speed/v end, within = { 0.99, 1.001 }, why = "all of it comes back, but for what still rings" }
expect{ "touches for", value = function(now) return now.time/(2.868*(m^2/(R*Es^2*v))^0.2) end, within = { 0.9, 1.02 }, why = why }
expect{ "depth", value = function(now) return now.peak("depth")*mm/d end, within = { 0.9, 1.02 }, why = why }
expect{ "force", value = function(now) return now.peak("pressed")*kN/(4/3*Es*math.sqrt(R)*d^1.5) end, within = { 0.98, 1.1 }, why = why }
