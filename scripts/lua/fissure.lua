---@meta
-- Completion and hover for scenes in editors with the Lua language server (LuaLS). Written by the program; do not edit it.

---@class fissure.shape
---@field radius number [m]
---@field diameter number [m]
---@field length number [m]
---@field inner number [m]
---@field outer number [m]
---@field thickness number [m]
---@field left number [m]
---@field right number [m]
---@field bottom number [m]
---@field top number [m]
---@field width number [m]
---@field height number [m]

---@class fissure.body
---@field radius number [m]
---@field diameter number [m]
---@field length number [m]
---@field inner number [m]
---@field outer number [m]
---@field thickness number [m]
---@field left number [m]
---@field right number [m]
---@field bottom number [m]
---@field top number [m]
---@field width number [m]
---@field height number [m]

---@class fissure.plate
---@field radius number [m]
---@field diameter number [m]
---@field length number [m]
---@field inner number [m]
---@field outer number [m]
---@field thickness number [m]
---@field left number [m]
---@field right number [m]
---@field bottom number [m]
---@field top number [m]
---@field width number [m]
---@field height number [m]

---@class fissure.material
---@field density number [kg/m3]
---@field young number [Pa]
---@field poisson number

---@class fissure.wall

---@class fissure.hold

---@class fissure.spring

---@class fissure.tie

---@class fissure.now
---@field [string] number the latest value of a measure
---@field time number simulated time [s]
---@field step integer number of steps done
---@field force fun(plate: fissure.plate, axis?: string): number size of the force on a plate along "y" (or "x", "z") [N]; 2D: for the scene's thickness, or once around the axis
---@field wall_force fun(wall: fissure.wall, axis?: string): number the same for a wall [N]
---@field reaction fun(hold: fissure.hold, axis?: string): number the same for a prescribed motion [N]; what two holds share counts for the first
---@field torque fun(hold: fissure.hold): number moment that a hold with around needs, about its axis by the right hand [N m]; 2D: for the scene's thickness
---@field contact_force fun(body: fissure.body|fissure.plate, other: string, axis?: string): number the same for what two bodies push and rub each other with where they touch [N], either way round; not what a bond between them carries
---@field contact_area fun(body: fissure.body|fissure.plate, other: string): number area of the first body's surface that the other presses on, in whole faces of its cells as they are now (a contact of few faces is no finer than they are) [m^2]; 2D: for the scene's thickness, or once around the axis
---@field contact_pressure fun(body: fissure.body|fissure.plate, other: string): number what presses there along the surface's normals, over that area [Pa]; 0: they do not touch
---@field spring_force fun(spring: fissure.spring): number what a spring pulls its ends together with [N]; below 0 it pushes; broken: 0
---@field tie_force fun(tie: fissure.tie, axis?: string): number what the first body of a tie pulls the second with, along "y" (or "x", "z") and with that sign: below 0 it points against the axis [N]
---@field displacement fun(body: fissure.body|fissure.plate, point?: number[]): table x, y, z of the node nearest to a point { x, y } at rest, on the point's side of a crack; for a plate, its own [m]
---@field velocity fun(body: fissure.body|fissure.plate, point?: number[]): table x, y, z of the node nearest to a point at rest, on its side of a crack; without a point, the body's mean [m/s]
---@field stress fun(body: fissure.body|fissure.plate, point?: number[]): table xx, yy, zz, xy, yz, zx of the element at a point at rest, tension positive [Pa]
---@field field fun(name: string, body: fissure.body|fissure.plate, point?: number[]): number an output field with one component, or a component of stress ("xx", ... "zx"), at the element nearest to a point at rest
---@field average fun(name: string, body: fissure.body|fissure.plate, inside: string): number mean by volume at rest of an output field with one component, or of a component of stress ("xx", "yy", "zz", "xy", "yz", "zx"), over the cells of a body; with function(x, y, z) over those whose middle at rest it says true of
---@field size fun(body: fissure.body|fissure.plate): table x, y, z: how far a body reaches now along each axis [m]; axisymmetric: x is its diameter
---@field energy fun(name: string): number a term of the energy balance [J]
---@field crack_area fun(): number area of broken joints [m2]; 2D: length times thickness, or once around the axis
---@field crack_energy fun(): number what damage took of joints that are broken [J]; the rest of energy("fracture") is of joints that softened and hold on, and friction in them
---@field broken_joints fun(): integer how many joints are broken
---@field removed_pieces fun(): integer how many crushed pieces have left the run, where `run{ crushed = "remove" }` is given
---@field fragments fun(body: fissure.body|fissure.plate): list pieces that hang together by faces, heaviest first, of a body or of all: tables of mass [kg], center [m], velocity [m/s] and size [m], the last three with x, y, z; # of it is how many there are
---@field largest fun(field: string): number largest value of an output field in all bodies
---@field peak fun(measure: string): number largest value of a measure so far
---@field peak_time fun(measure: string): number when that was [s]
---@field mean fun(measure: string, duration: string): number mean over time of a measure, of the last so many seconds that were recorded, the latest value included
---@field at_rest fun(share: string): boolean whether in the last tenth of the time (ten samples at least) no sample had more kinetic energy than this share (left out: 1e-4) of the most there was: `stop = function(now) return now.at_rest() end`. Without damping little ever rests; a force still wavers then, so take its mean

---@type integer 2 or 3
dim = 3
---metre
m = 1
---millimetre
mm = 0.001
---micrometre
um = 9.9999999999999995e-07
---centimetre
cm = 0.01
---kilometre
km = 1000
---square metre
m2 = 1
---square millimetre
mm2 = 9.9999999999999995e-07
---square centimetre
cm2 = 0.0001
---cubic metre
m3 = 1
---cubic millimetre
mm3 = 1.0000000000000001e-09
---cubic centimetre
cm3 = 9.9999999999999995e-07
---second
s = 1
---millisecond
ms = 0.001
---microsecond
us = 9.9999999999999995e-07
---nanosecond
ns = 1.0000000000000001e-09
---kilogram
kg = 1
---gram
g = 0.001
---tonne
t = 1000
---newton
N = 1
---kilonewton
kN = 1000
---meganewton
MN = 1000000
---pascal
Pa = 1
---kilopascal
kPa = 1000
---megapascal
MPa = 1000000
---gigapascal
GPa = 1000000000
---joule
J = 1
---kilojoule
kJ = 1000
---millijoule
mJ = 0.001
---hertz
Hz = 1
---kilohertz
kHz = 1000
---kelvin
K = 1
---degree
deg = 0.017453292519943295

---@class fissure.param_table
---@field [1] any how --set calls it
---@field [2] any its value when nothing is set
---@field [3] any what it is, for `params`
---@field least? number smallest value that makes sense
---@field most? number largest value that makes sense

---A number that --set can change.
---
---`local v = param("speed", 2, "speed of each plate (m/s)")`
---@param first fissure.param_table|any
---@param ... any
---@return number
function param(first, ...) end

---@class fissure.material_table_elastic
---@field law? "neo_hookean"|"munjiza" elastic law. neo_hookean: compressible neo-Hookean law, has a stored energy at any strain; the default; munjiza: Munjiza's law, linear in shape and volume strains (paper eq. 2); no stored energy at large strain
---@field young number Young's modulus [Pa]
---@field poisson number Poisson's ratio; 0.5 would be incompressible and needs an infinite wave speed, below 0 there is law = "munjiza"
---@field damping? number|string|table viscosity mu of the stress 2 mu D; "critical" is 2 h sqrt(E density) with the element size h, and costs a smaller time step; a share of it costs less [Pa s]

---@class fissure.material_table_plastic_heat
---@field capacity number heat capacity per mass [J/(kg K)]
---@field share? number share of the plastic work that becomes heat (Taylor-Quinney), not above 1
---@field start? number temperature at the start; a body may have another one [K]
---@field reference? number the T0 of m, up to which nothing softens: room temperature in most tables; left out: as start [K]

---@class fissure.material_table_plastic
---@field law? "j2"|"johnson_cook"|"drucker_prager" flow law. j2: J2 with a yield stress that is a number, a table or a function; johnson_cook: J2 with the hardening of Johnson and Cook (paper eq. 25); drucker_prager: yield stress that grows with pressure; the cohesion is a number, a table or a function
---@field yield number|table|fun(strain: number, rate: number): number yield stress (Drucker-Prager: cohesion): a number, a list of { plastic strain, stress }, a list of such lists each with rate = (1/s), or a function(strain, rate) [Pa]
---@field hardening? number slope of the yield stress over plastic strain, beside a number [Pa]
---@field tolerance? number how closely a table follows a yield function, share of its value
---@field strain_to? number largest plastic strain at which a yield function is asked
---@field A number yield stress without plastic strain [Pa]
---@field B? number hardening B ep^n [Pa]
---@field n? number its exponent
---@field C? number rate hardening 1 + C ln(rate/rate0), above rate0
---@field rate0? number reference strain rate [1/s]
---@field m? number thermal softening 1 - ((T - reference)/(melting - reference))^m; 0: none; needs heat
---@field melting? number temperature at which nothing is left of the strength [K]
---@field friction_angle number angle theta of the yield surface in the p-q plane [rad]
---@field dilation_angle? number angle psi of the flow; equal to friction_angle: associated [rad]
---@field beta? number share of hardening that is isotropic; the rest is kinematic
---@field strain? "jaumann"|"logarithmic" how stress follows the motion: by the Jaumann rate (fast), or by logarithmic strain (exact in closed cycles and large elastic shear)
---@field solver? "newton"|"bisection" how the return mapping is solved; bisection is the slow reference
---@field pressure? "element"|"averaged" averaged: over the elements about a node that are still joined, so that flow does not lock (J2 laws only)
---@field heat? fissure.material_table_plastic_heat adiabatic heating by plastic work; left out: no temperature

---@class fissure.material_table_fracture_scatter
---@field modulus number Weibull's modulus m; a tenth of scatter is about m = 12
---@field area? number of a face that has the material's strengths on average: others have (area of face/area)^(-1/m) times as much; left out: any face [m2]
---@field seed? number another number, other strengths

---@class fissure.material_table_fracture
---@field tension number tensile strength [Pa]
---@field shear number shear strength without pressure (cohesion when friction_angle is given) [Pa]
---@field friction_angle? number Mohr-Coulomb: shear strength grows by pressure times its tangent [rad]
---@field G1 number fracture energy of opening (mode I) [J/m2]
---@field G2 number fracture energy of slip (modes II and III) [J/m2]
---@field penalty number joint stiffness times spacing: the body keeps about 1/(1 + E/penalty) of its stiffness [Pa]
---@field mixed? "ellipse"|"independent" opening and slip at once. ellipse: (sigma/tension)^2 + (tau/shear)^2 = 1 at the peak, W1/G1 + W2/G2 = 1 at separation; independent: each has its full strength, as in the classical combined method; a joint at 45 degrees is then 1.41 times as strong and takes 1.41 times the energy or more
---@field criterion? "rankine"|"traction" when a joint begins to open. rankine: where it carries what its face carries when the largest principal stress beside it is tension, if the face lies within 60 degrees across that, too; it then takes G1 times the area across the tension. traction: by the traction on its face alone, so that faces askew to a crack make a body too strong and too tough. With mixed = "independent" always traction
---@field insertion? "intrinsic"|"adaptive" when joints are there. intrinsic: from the start, on every face, so that the body is softer by 1/(1 + E/penalty); adaptive: inserted where the stress beside a face reaches its strength, carrying the traction that is there; until then the body is whole, so that what opens needs no more than 2 E (what slips under pressure: 20 E) and steps stay long. A bond's are always there
---@field softening? any how the strength falls over the gap beyond the peak, to enclose G1: "munjiza", "linear", "bilinear" or "exponential", points (m, Pa) whose shape is taken, or a function that returns a traction
---@field shear_softening? any how the strength falls over the gap beyond the peak, to enclose G2: "munjiza", "linear", "bilinear" or "exponential", points (m, Pa) whose shape is taken, or a function that returns a traction
---@field rate? number[][] how many times as strong a joint is whose gap grows at a speed (m/s): points from { 0, 1 } on, or a function, sampled from 1e-4 to 1e3 m/s; fracture energies are its square times those at rest
---@field scatter? fissure.material_table_fracture_scatter Weibull's scatter of strengths: every joint has s times the strengths and s^2 times the fracture energies, s of mean 1; left out: all joints are alike

---@class fissure.material_table_contact
---@field penalty number contact penalty: pressure at full overlap [Pa]
---@field friction? number Coulomb friction coefficient

---@class fissure.material_table
---@field [1] any its name
---@field source? string where its numbers come from; a run takes no notice
---@field density number mass per volume [kg/m3]
---@field elastic fissure.material_table_elastic how it deforms
---@field plastic? fissure.material_table_plastic how it flows; left out: it stays elastic
---@field fracture? fissure.material_table_fracture how it breaks; left out: it cannot break
---@field contact? fissure.material_table_contact how it touches; left out: a penalty of lambda + 2 mu and no friction

---What bodies are made of. Leaving a part out leaves its model out.
---
---`local rock = material{ "rock", density = 2700, elastic = { young = 50*GPa, poisson = 0.25 } }`
---@param first fissure.material_table
---@return fissure.material
function material(first) end

---@class fissure.body_table_mesh_seam
---@field from number[] start of the line [m]
---@field to number[] end of the line [m]
---@field corners? number[][] 3D: of a flat polygon instead of the line, in order around (2D takes the line) [m]

---@class fissure.body_table_mesh_near
---@field from number[] start of the line, or the point (3D: along z) [m]
---@field to? number[] end of the line; left out: a point [m]
---@field radius number of the place about the line [m]
---@field size number of edges there [m]

---@class fissure.body_table_mesh
---@field size number length of an element's edges; shorter near an outline of many points [m]
---@field cells? "simplex"|"block"|"tri"|"quad"|"tet"|"hex" kind of elements; "simplex" (tri or tet) and "block" (quad or hex) are right in both dimensions
---@field integration? "one_point"|"full"|"b_bar"|"assumed_strain" of blocks: "one_point" is fast, "b_bar" right in plastic flow, "assumed_strain" in bending of thin parts
---@field structured? boolean a regular grid, for simplices cut into them (boxes only)
---@field irregular? number inner nodes are moved at random by up to this share of their shortest edge, so that cracks find no lattice
---@field seed? number another number, another unstructured mesh of the same size
---@field seam? fissure.body_table_mesh_seam straight line (3D: plane along z, or flat polygon) on which the mesh has faces, so that a crack can follow it
---@field near? fissure.body_table_mesh_near smaller elements about a line or a point: those within `radius` have edges of `size`, from there on they grow by 0.3 per length

---@class fissure.body_table_stress
---@field xx? number component of the stress [Pa]
---@field yy? number component of the stress [Pa]
---@field zz? number component of the stress [Pa]
---@field xy? number component of the stress [Pa]
---@field yz? number component of the stress [Pa]
---@field zx? number component of the stress [Pa]

---@class fissure.body_table
---@field [1] any its name
---@field shape fissure.shape where it is: box{}, disc{}, ...
---@field mesh fissure.body_table_mesh how it is cut into elements
---@field material fissure.material what it is made of
---@field velocity? number[]|fun(x: number, y: number, z: number): number[] initial velocity; a function returns { x, y } or { x, y, z } [m/s]
---@field stress? fissure.body_table_stress that it begins with, in the place where it is drawn, tension positive; or a function(x, y, z) that returns such a table, linear in place unless the material flows. In plane strain zz follows from the others, but for what flows; around an axis it equals xx, and all are alike at all radii. What keeps it in balance (pressures, holds, weight) is the scene's: where nothing does, as on a free slope, the body settles as if it had been cut free at the start
---@field rigid? boolean true: it moves and turns as one piece that never deforms, pushed by what it touches, by loads and by its weight; of its material it takes the density and what contact needs. A hold moves all of it
---@field temperature? number at the start, of a material with plastic = { heat = }; left out: its heat.start [K]

---Something that deforms, moves and can break.
---
---`local disc = body{ "disc", shape = disc{ radius = 25*mm, thickness = 25*mm }, mesh = { size = 3*mm }, material = rock }`
---@param first fissure.body_table
---@return fissure.body
function body(first) end

---@class fissure.joints_table
---@field [1] any its name
---@field [2] any the body
---@field strength number their strengths over those of the material; their fracture energies are its square times those; 0: broken from the start
---@field from? number[] faces on the line (3D: plane along z) from here; mesh.seam puts faces there [m]
---@field to? number[] to here [m]
---@field corners? number[][] 3D: of a flat polygon instead of the line, in order around (2D takes the line) [m]
---@field at? number[]|fun(x: number, y: number, z: number): number[] says true for the middles of its faces
---@field facing? number[] faces whose normal is within an angle of it, either way
---@field within? number that angle [rad]

---Joints of a body with strengths of their own: weak planes, joint sets, cracks that are there from the start. Of from and to, at and facing all that are given must hold. A face belongs to one set at most.
---
---`joints{ "bedding", block, facing = { 0, 1 }, within = 20*deg, strength = 0.3 }`
---@param first fissure.joints_table
function joints(first) end

---@class fissure.bond_table_fracture_scatter
---@field modulus number Weibull's modulus m; a tenth of scatter is about m = 12
---@field area? number of a face that has the material's strengths on average: others have (area of face/area)^(-1/m) times as much; left out: any face [m2]
---@field seed? number another number, other strengths

---@class fissure.bond_table_fracture
---@field tension number tensile strength [Pa]
---@field shear number shear strength without pressure (cohesion when friction_angle is given) [Pa]
---@field friction_angle? number Mohr-Coulomb: shear strength grows by pressure times its tangent [rad]
---@field G1 number fracture energy of opening (mode I) [J/m2]
---@field G2 number fracture energy of slip (modes II and III) [J/m2]
---@field penalty number joint stiffness times spacing: the body keeps about 1/(1 + E/penalty) of its stiffness [Pa]
---@field mixed? "ellipse"|"independent" opening and slip at once. ellipse: (sigma/tension)^2 + (tau/shear)^2 = 1 at the peak, W1/G1 + W2/G2 = 1 at separation; independent: each has its full strength, as in the classical combined method; a joint at 45 degrees is then 1.41 times as strong and takes 1.41 times the energy or more
---@field criterion? "rankine"|"traction" when a joint begins to open. rankine: where it carries what its face carries when the largest principal stress beside it is tension, if the face lies within 60 degrees across that, too; it then takes G1 times the area across the tension. traction: by the traction on its face alone, so that faces askew to a crack make a body too strong and too tough. With mixed = "independent" always traction
---@field insertion? "intrinsic"|"adaptive" when joints are there. intrinsic: from the start, on every face, so that the body is softer by 1/(1 + E/penalty); adaptive: inserted where the stress beside a face reaches its strength, carrying the traction that is there; until then the body is whole, so that what opens needs no more than 2 E (what slips under pressure: 20 E) and steps stay long. A bond's are always there
---@field softening? any how the strength falls over the gap beyond the peak, to enclose G1: "munjiza", "linear", "bilinear" or "exponential", points (m, Pa) whose shape is taken, or a function that returns a traction
---@field shear_softening? any how the strength falls over the gap beyond the peak, to enclose G2: "munjiza", "linear", "bilinear" or "exponential", points (m, Pa) whose shape is taken, or a function that returns a traction
---@field rate? number[][] how many times as strong a joint is whose gap grows at a speed (m/s): points from { 0, 1 } on, or a function, sampled from 1e-4 to 1e3 m/s; fracture energies are its square times those at rest
---@field scatter? fissure.bond_table_fracture_scatter Weibull's scatter of strengths: every joint has s times the strengths and s^2 times the fracture energies, s of mean 1; left out: all joints are alike

---@class fissure.bond_table
---@field [1] any its name
---@field [2] any the bodies: any two of them that touch are joined, face to face
---@field fracture fissure.bond_table_fracture how the bond breaks, as that of a material; a bond is a plane of its own and begins by the traction on it, whatever criterion says
---@field at? number[]|fun(x: number, y: number, z: number): number[] says true for the middles of faces that are joined; left out: all where the bodies meet; others are cracks from the start

---Joints between bodies that touch: glue, mortar, the skin of an inclusion. The bodies are meshed together, so that their faces match; where the bond is broken they touch like others. They keep their materials, names and places, must be able to crack and have cells that are simplices.
---
---`bond{ "mortar", brick, wall, fracture = { tension = 0.5*MPa, shear = 1*MPa, G1 = 10*J/m2, G2 = 40*J/m2, penalty = 100*GPa } }`
---@param first fissure.bond_table
function bond(first) end

---@class fissure.tie_table
---@field [1] any its name
---@field [2] any the two bodies; the one with the smaller cells where they meet hangs on the other
---@field within? number nodes nearer than this to a surface of the other body that faces them hang on it; left out: a fifth of that one's edges there [m]
---@field at? number[]|fun(x: number, y: number, z: number): number[] says true for nodes that are tied; left out: all that are near enough

---Two bodies that hang together where their surfaces meet, whatever their meshes: a fine region in a coarse one, a specimen glued to its platens. A tie never breaks, costs no time step and does no work.
---
---`local glue = tie{ platen, specimen }`
---@param first fissure.tie_table|any
---@param ... any
---@return fissure.tie
function tie(first, ...) end

---@class fissure.box_table
---@field size number[] edge lengths along x, y and z (2D: z is the thickness, and may be left out) [m]
---@field center? number[] its middle [m]

---A box; in 2D a rectangle.
---
---`box{ size = { 40*mm, 20*mm, 10*mm } }`
---@param first fissure.box_table
---@return fissure.shape
function box(first) end

---@class fissure.disc_table
---@field radius number radius [m]
---@field thickness? number extent along z, centred on z = 0; in 2D only forces know it (default there: 1 m) [m]
---@field center? number[] its middle [m]

---A disc; in 3D a short cylinder along z.
---
---`disc{ radius = 25*mm, thickness = 25*mm }`
---@param first fissure.disc_table
---@return fissure.shape
function disc(first) end

---@class fissure.rod_table
---@field radius number radius [m]
---@field length number length along y [m]
---@field end_radius? number radius of its upper end, for a tapered rod; left out: as radius [m]
---@field base? number[] middle of its lower end [m]

---A cylinder along y; in 2D its lengthwise section (half of it when axisymmetric).
---
---`rod{ radius = 3.2*mm, length = 32.4*mm }`
---@param first fissure.rod_table
---@return fissure.shape
function rod(first) end

---@class fissure.ball_table
---@field radius number radius [m]
---@field center? number[] its middle [m]

---A ball; in 2D its middle section (half of it when axisymmetric).
---
---`ball{ radius = 5*mm }`
---@param first fissure.ball_table
---@return fissure.shape
function ball(first) end

---@class fissure.ring_table
---@field inner number inner radius [m]
---@field outer number outer radius [m]
---@field thickness? number extent along z, centred on z = 0; in 2D only forces know it (default there: 1 m) [m]
---@field center? number[] its middle [m]

---A ring; in 3D a hollow cylinder along z.
---
---`ring{ inner = 49*mm, outer = 50*mm, thickness = 1*mm }`
---@param first fissure.ring_table
---@return fissure.shape
function ring(first) end

---@class fissure.polygon_table
---@field points number[][] corners, in order around [m]
---@field thickness? number extent along z, centred on z = 0; in 2D only forces know it (default there: 1 m) [m]

---The inside of an outline; in 3D extruded along z.
---
---`polygon{ points = { {0, 0}, {2, 0}, {1, 1} }, thickness = 0.1 }`
---@param first fissure.polygon_table
---@return fissure.shape
function polygon(first) end

---@class fissure.revolved_table
---@field points number[][] corners, in order around [m]

---A section at x >= 0 turned once about the y axis; in 2D the section and its mirror image (the section alone when axisymmetric).
---
---`revolved{ points = { {0, 0}, {4*mm, 0}, {1*mm, 9*mm}, {0, 9*mm} } }`
---@param first fissure.revolved_table
---@return fissure.shape
function revolved(first) end

---@class fissure.notch_table
---@field from number[] start of its middle line [m]
---@field to number[] end of its middle line [m]
---@field width number width [m]

---A slot through the whole thickness, to be taken away from a shape.
---
---`difference{ plate_shape, notch{ from = {0, 0}, to = {50*mm, 0}, width = 0.3*mm } }`
---@param first fissure.notch_table
---@return fissure.shape
function notch(first) end

---@class fissure.mesh_file_table
---@field [1] any file beside the scene (or in a folder there), from Gmsh; physical groups become names

---A mesh from Gmsh as a body's shape.
---
---`mesh_file{ "part.msh" }`
---@param first fissure.mesh_file_table|any
---@param ... any
---@return fissure.shape
function mesh_file(first, ...) end

---@class fissure.union_table
---@field [1] any shapes that become one

---Shapes that become one; they may overlap, touch or lie apart.
---
---`union{ box{...}, disc{...} }`
---@param first fissure.union_table|any
---@param ... any
---@return fissure.shape
function union(first, ...) end

---@class fissure.difference_table
---@field [1] any a shape, then those that are taken away from it

---The first shape without all others.
---
---`difference{ box{...}, disc{...} }`
---@param first fissure.difference_table|any
---@param ... any
---@return fissure.shape
function difference(first, ...) end

---@class fissure.moved_table
---@field [1] any the shape
---@field by number[] how far [m]

---A shape at another place.
---
---`moved{ ball{ radius = 5*mm }, by = { 0, 12*mm } }`
---@param first fissure.moved_table
---@return fissure.shape
function moved(first) end

---@class fissure.turned_table
---@field [1] any the shape
---@field angle number how far, from x to y where the axis is z [rad]
---@field axis? "x"|"y"|"z" it is turned about a line along this axis (2D: z)
---@field about? number[] a point of that line [m]

---A shape turned about a line.
---
---`turned{ box{ size = { 40*mm, 20*mm, 10*mm } }, angle = 30*deg }`
---@param first fissure.turned_table
---@return fissure.shape
function turned(first) end

---@class fissure.mirrored_table
---@field [1] any the shape
---@field normal? number[] of the plane that it is mirrored in (2D: of the line)
---@field point? number[] a point of that plane [m]

---A shape mirrored in a plane; union{ half, mirrored{ half } } is both halves.
---
---`mirrored{ polygon{...}, normal = { 1, 0 } }`
---@param first fissure.mirrored_table|any
---@param ... any
---@return fissure.shape
function mirrored(first, ...) end

---@class fissure.scaled_table
---@field [1] any the shape
---@field factor number|string|table how many times as large; alike in all directions (the thickness as well), or along x, y and z; z is 1 where it is left out, and 2D takes it for the thickness
---@field about? number[] a point that stays [m]

---A shape larger or smaller: an ellipse, or a mesh file in millimetres.
---
---`scaled{ disc{ radius = 1*mm, thickness = 1*mm }, factor = { 10, 5 } }`
---@param first fissure.scaled_table
---@return fissure.shape
function scaled(first) end

---@class fissure.above_table
---@field [1] any what it touches
---@field thickness? number of the box (default: a tenth of the body) [m]
---@field cover? number its width as a share of the body's

---A rigid box on top of a body, touching it: for plate{}.
---
---`plate{ above(disc), velocity = { 0, -1 } }`
---@param first fissure.above_table|any
---@param ... any
---@return fissure.shape
function above(first, ...) end

---@class fissure.below_table
---@field [1] any what it touches
---@field thickness? number of the box (default: a tenth of the body) [m]
---@field cover? number its width as a share of the body's

---A rigid box under a body, touching it.
---
---`plate{ below(disc) }`
---@param first fissure.below_table|any
---@param ... any
---@return fissure.shape
function below(first, ...) end

---@class fissure.left_of_table
---@field [1] any what it touches
---@field thickness? number of the box (default: a tenth of the body) [m]
---@field cover? number its width as a share of the body's

---A rigid box to the left of a body, touching it.
---
---`plate{ left_of(disc) }`
---@param first fissure.left_of_table|any
---@param ... any
---@return fissure.shape
function left_of(first, ...) end

---@class fissure.right_of_table
---@field [1] any what it touches
---@field thickness? number of the box (default: a tenth of the body) [m]
---@field cover? number its width as a share of the body's

---A rigid box to the right of a body, touching it.
---
---`plate{ right_of(disc) }`
---@param first fissure.right_of_table|any
---@param ... any
---@return fissure.shape
function right_of(first, ...) end

---@class fissure.plate_table_servo
---@field every number how often it is asked; in between nothing changes [s]
---@field velocity fun(now: fissure.now): any returns { x, y } or { x, y, z } [m/s]

---@class fissure.plate_table_contact
---@field penalty number contact penalty: pressure at full overlap [Pa]
---@field friction? number Coulomb friction coefficient

---@class fissure.plate_table
---@field [1] any its name
---@field [2] any a rigid box: above(body), below(body), left_of(body), right_of(body)
---@field box? fissure.shape a rigid box: box{ size = ..., center = ... }
---@field velocity? (number|fun(t: number): number)[] how it moves; a component left out stands still [m/s]
---@field force? (number|fun(t: number): number)[] what drives it instead; nil leaves a component as velocity says, 0 lets it slide freely. 2D: on the scene's thickness, or once around the axis [N]
---@field mass? number of a plate that a force drives [kg]
---@field servo? fissure.plate_table_servo what finds its velocity while the run goes on, along directions that neither velocity nor force names
---@field contact? fissure.plate_table_contact how it touches; left out: as the body that touches it

---A rigid box that moves as told; now.force(plate) is what the bodies push it with.
---
---`local top = plate{ above(disc), velocity = { 0, -0.05 } }`
---@param first fissure.plate_table|any
---@param ... any
---@return fissure.plate
function plate(first, ...) end

---@class fissure.wall_table_contact
---@field penalty number contact penalty: pressure at full overlap [Pa]
---@field friction? number Coulomb friction coefficient

---@class fissure.wall_table
---@field [1] any its name
---@field point? number[] a point of it [m]
---@field normal? number[] points to the side where everything must stay
---@field contact? fissure.wall_table_contact how it touches; left out: as the body that touches it

---A rigid half-space: everything behind a plane.
---
---`wall{ point = {0, 0}, normal = {0, 1} }`
---@param first fissure.wall_table|any
---@param ... any
---@return fissure.wall
function wall(first, ...) end

---@class fissure.hold_table_around
---@field turning? number|fun(t: number): number how fast, by the right hand [rad/s]
---@field outward? number|fun(t: number): number away from the axis [m/s]
---@field through? number[] a point of the axis [m]
---@field axis? number[] its direction, required in 3D; in 2D it is z

---@class fissure.hold_table
---@field [1] any the body
---@field at string|fun(x: number, y: number, z: number): boolean part of it: "left", "right", "bottom", "top", "front", "back", "surface", "all" (what is furthest that way, wherever the shape was turned), a physical group of its mesh file, or function(x, y, z) that says true there
---@field velocity? (number|fun(t: number): number)[] prescribed velocity; nil leaves a component free, 0 holds it (a roller); two holds may not move one vertex differently. Required without around [m/s]
---@field around? fissure.hold_table_around instead: about an axis that stands still; what is held moves in no other way, along the axis neither

---Prescribed motion of a part of a body.
---
---`local foot = hold{ bar, at = "bottom", velocity = { nil, 0 } }`
---@param first fissure.hold_table
---@return fissure.hold
function hold(first) end

---@class fissure.traction_table
---@field [1] any the body
---@field at string|fun(x: number, y: number, z: number): boolean part of it: "left", "right", "bottom", "top", "front", "back", "surface" (what is furthest that way, wherever the shape was turned), a physical group of its mesh file, or function(x, y, z) that says true there
---@field value (number|fun(t: number): number)[] force per reference area [Pa]

---A force per area on a part of a body's surface.
---
---`traction{ bar, at = "top", value = { 0, 1*MPa } }`
---@param first fissure.traction_table
function traction(first) end

---@class fissure.pressure_table
---@field [1] any the body
---@field at string|fun(x: number, y: number, z: number): boolean part of it: "left", "right", "bottom", "top", "front", "back", "surface" (what is furthest that way, wherever the shape was turned), a physical group of its mesh file, or function(x, y, z) that says true there
---@field value number|fun(t: number): number pressure, inward when positive [Pa]
---@field follows? boolean true: it acts on the surface as it stands, as a fluid does; false: on its area and along its normal at rest

---A pressure on a part of a body's surface.
---
---`pressure{ ring, at = function(x, y, z) return x^2 + y^2 < 0.01 end, value = function(t) return 1e9*t end }`
---@param first fissure.pressure_table
function pressure(first) end

---@class fissure.force_table
---@field [1] any the body
---@field at string|fun(x: number, y: number, z: number): boolean part of it: "left", "right", "bottom", "top", "front", "back", "surface" (what is furthest that way, wherever the shape was turned), a physical group of its mesh file, or function(x, y, z) that says true there, or a point { x, y }, of which the nearest vertex is taken
---@field value (number|fun(t: number): number)[] on all of it together, spread evenly; 2D: on the scene's thickness, or once around the axis [N]

---A force on a part of a body's surface, or at a point.
---
---`force{ beam, at = { 0, 50*mm }, value = { 0, ramp{ to = -2*kN, over = 1*ms } } }`
---@param first fissure.force_table
function force(first) end

---@class fissure.spring_table
---@field [1] any its name
---@field [2] any the body at `from`, then the one at `to` (the same twice: inside it); one alone: `to` is a place that stands still
---@field from number[] its first end, on the cell that this point lies in [m]
---@field to number[] its second end [m]
---@field stiffness number force per change of length; 2D: on the scene's thickness, or once around the axis [N/m]
---@field length? number without force; a shorter one is taut from the start [m]
---@field damping? number force per rate of length, of a damper beside it [N s/m]
---@field strength? number pulled harder than this, its damper not counted, it breaks; left out: never [N]
---@field slack? boolean true: it only pulls and never pushes, as a rope does

---A spring between two points: a bolt, an anchor, a rope.
---
---`local bolt = spring{ "bolt", roof, from = { 0, 0 }, to = { 0, 2 }, stiffness = 2e8, strength = 100*kN }`
---@param first fissure.spring_table
---@return fissure.spring
function spring(first) end

---@class fissure.body_force_table
---@field [1] any the body
---@field value number[]|fun(x: number, y: number, z: number): number[] force per volume at rest; a function of the place at rest returns { x, y } or { x, y, z } [N/m3]
---@field times? number|fun(t: number): number how many times that, by time

---A force on every part of a body, by place and time.
---
---`body_force{ rotor, value = function(x, y) return { 7800*om^2*x, 7800*om^2*y } end }`
---@param first fissure.body_force_table
function body_force(first) end

---@class fissure.excavate_table
---@field [1] any the body
---@field time number when it leaves: with the first step from then on [s]
---@field within? number[]|fun(x: number, y: number, z: number): number[] says true of the middles, at rest, of those cells that leave; the body's cells must have corners of their own (joints that are there from the start, insertion = "intrinsic"); else make what leaves a body of its own and bond{} both

---A body, or a part of one, leaves the run with its mass and all that it holds: a tunnel, a prop that is struck away. Whole cells leave; questions about them are answered by 0.
---
---`excavate{ rock, time = 2*ms, within = function(x, y) return x^2 + y^2 < 4 end }`
---@param first fissure.excavate_table
function excavate(first) end

---@class fissure.absorb_table
---@field [1] any the body
---@field at string|fun(x: number, y: number, z: number): boolean part of it: "left", "right", "bottom", "top", "front", "back", "surface" (what is furthest that way, wherever the shape was turned), a physical group of its mesh file, or function(x, y, z) that says true there

---A part of a body's surface that takes up the waves that reach it, as if the body went on: dashpots of its wave impedances (Lysmer & Kuhlemeyer 1969). It carries nothing at rest.
---
---`absorb{ ground, at = "bottom" }`
---@param first fissure.absorb_table
function absorb(first) end

---@class fissure.ramp_table
---@field to number where it ends, in the unit of what is ramped
---@field over number how long it takes [s]
---@field from? number where it begins
---@field start? number when it begins [s]

---A function of time that goes smoothly from one value to another: velocities and loads that start few vibrations.
---
---`local push = plate{ above(disc), velocity = { 0, ramp{ to = -0.05, over = 1*ms } } }`
---@param first fissure.ramp_table
---@return fun(t: number): number
function ramp(first) end

---@class fissure.settle_table
---@field time? number how long; left out: ten times as long as a wave takes through the scene and back, twice [s]
---@field damping? number alpha of the damping force alpha m v in that time; left out: what calms the slowest vibration of a scene of this size soonest [1/s]

---Before the start bodies come to rest under weight, loads and stresses as they are at t = 0, while holds and plates stand still; at t = 0 they begin with their velocities. What they moved by stays in displacements.
---
---`settle{}`
---@param first fissure.settle_table|any
---@param ... any
function settle(first, ...) end

---@class fissure.gravity_table
---@field [1] any along x [m/s2]
---@field [2] any along y [m/s2]
---@field [3] any along z (3D) [m/s2]

---Acceleration of everything, always. One that changes by place or time is a body_force{}: density times it.
---
---`gravity{ 0, -9.81 }`
---@param first fissure.gravity_table|any
---@param ... any
function gravity(first, ...) end

---@class fissure.assume_table
---@field two_d? "plane strain"|"plane stress"|"axisymmetric" how a 2D program reads the scene; axisymmetric: x is the radius, y the axis, all is per full revolution
---@field contact? boolean false: bodies and fragments go through each other; only plates and walls stop them
---@field thickness? number out of plane, in 2D: forces are those of such a slice [m]

---How the world is simplified.
---
---`assume{ two_d = "plane stress" }`
---@param first fissure.assume_table|any
---@param ... any
function assume(first, ...) end

---@class fissure.measure_table
---@field [1] any its name: a column of the history, and now.<name>; no question that now answers already
---@field [2] any returns the number
---@field unit? string for the axis of a plot

---A number that is recorded while the experiment runs.
---
---`measure{ "load", unit = "N", function(now) return now.force(top) end }`
---@param first fissure.measure_table|any
---@param ... any
function measure(first, ...) end

---@class fissure.plot_table
---@field [1] any the measure
---@field against? string "time" (the default) or another measure

---A picture of a measure.
---
---`plot{ "load", against = "time" }`
---@param first fissure.plot_table|any
---@param ... any
function plot(first, ...) end

---@class fissure.output_table
---@field every? number time between two frames; 0: the first and the last only [s]
---@field measure_every? number time between two rows of the history; 0: a thousandth of the run [s]
---@field checkpoint_every? number time between two checkpoints; 0: only at the end [s]
---@field fields? string[] what frames hold: "displacement", "velocity", "stress", "pressure", "von_mises", "principal", "damage", "body", "material", "plastic_strain", "plastic_rate", "temperature", "yield_ratio", "fragment"

---What is written down, and how often.
---
---`output{ every = 20*us, fields = { "stress", "damage" } }`
---@param first fissure.output_table|any
---@param ... any
function output(first, ...) end

---@class fissure.expect_table
---@field [1] any what is expected; with `of`, a measure
---@field value? fun(now: fissure.now): any returns the number, after the run
---@field of? "peak"|"last" instead of value: the measure's largest or last value
---@field equals? number the number it must be
---@field tolerance? number how far from it may be, in the same unit
---@field within? number[] instead of equals: where it must lie
---@field why string where the number comes from

---A number that the finished run must show.
---
---`expect{ "load", of = "peak", within = { 4*kN, 6*kN }, why = "a published test" }`
---@param first fissure.expect_table
function expect(first) end

---@class fissure.finish_table
---@field [1] any what it prints is said at the end of a run, unless that is interrupted

---What is said of a finished run: all that the function prints, on the terminal, in run.json (`told`) and on the page of the run.
---
---`finish{ function(now) print(string.format("%.1f kN", now.peak("load")/kN)) end }`
---@param first fissure.finish_table|any
---@param ... any
function finish(first, ...) end

---@class fissure.study_table
---@field [1] any the measure whose error is asked for
---@field vary? string[] what is varied, each "NAME=A,B,C": a param, a key of all tables of a verb, precision or dimension
---@field of? "peak"|"last"|"mean"|"least" which of its values
---@field reference? any the right answer: a number, "finest", "limit" or "NAME=VALUE"
---@field tolerance? number what is good enough, in per cent [%]

---What scripts/study varies and measures when its command line does not say; a run takes no notice.
---
---`study{ "load", vary = { "h=4,2,1", "precision=double,single" }, reference = "limit" }`
---@param first fissure.study_table|any
---@param ... any
function study(first, ...) end

---@class fissure.run_table
---@field time number how long [s]
---@field dt? number time step; left out: found automatically [s]
---@field safety? number share of the largest stable step
---@field stop? fun(now: fissure.now): any true ends the run early
---@field mass_damping? number alpha of the damping force alpha m v [1/s]
---@field mass_scaling? number factor on every inertia, not on weights: larger steps, for slow loading only
---@field allowed_residual? number energy that may be missing or too much at the end, as a share of the ledger's largest term, or of the energy turned over where that differs; from it on the exit status is 1
---@field crushed? "stop"|"remove" "stop": a cell that turns inside out ends the run; "remove": a lone one (a simplex that no joint holds any more) leaves when it is pressed to a tenth of its volume, with all that it holds, which the ledger's `removed` books

---How long, and how.
---
---`run{ time = 2*ms }`
---@param first fissure.run_table
function run(first) end

