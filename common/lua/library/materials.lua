-- Real materials as tables for material{}: local rock = material(require "materials".granite)
-- To change a part: local granite = require "materials".granite; granite.contact = { penalty = 10*GPa, friction = 0.3 }
-- `fissure2d materials` lists them.
--
-- Sources ([A] and [G] as remembered, not looked up again for this table):
-- [A] R. J. Munro, Evaluated material properties for a sintered alpha-alumina, J. Am. Ceram. Soc. 80 (1997) 1919-1928: at room temperature.
-- [G] R. E. Goodman, Introduction to Rock Mechanics, 2nd ed., Wiley 1989, tables 3.1, 3.3 and 6.1, for the rock that is named.
-- [I] P. H. Gammon, H. Kiefte, M. J. Clouter, W. W. Denner, Elastic constants of artificial and natural ice samples by Brillouin
--     spectroscopy, J. Glaciol. 29 (1983) 433-460.
-- [J] G. R. Johnson, W. H. Cook, A constitutive model and data for metals subjected to large strains, high strain rates and high temperatures,
--     7th Int. Symp. on Ballistics, The Hague, 1983: density, heat capacity, melting and the constants of the law; elastic constants are [T].
-- [L] D. R. Lesuer, G. J. Kay, M. M. LeBlanc, Modeling large-strain, high-rate deformation in metals, Lawrence Livermore UCRL-JC-134118, 2001.
-- [M] fib Model Code 2010, sec. 5.1 (concrete C30/37).
-- [P] INFIDEP paper: table 1 (42CrMo4, after Ming & Pantale 2018), table 4 (Brazilian test, after Munjiza et al. 2011).
-- [R] J. J. Petrovic, Mechanical properties of ice and snow, J. Mater. Sci. 38 (2003) 1-6, doi 10.1023/A:1021134128038.
-- [S] EN 1993-1-1 (S235: yield 235 MPa, strength 360 MPa).
-- [Z] F. Zhou, J.-F. Molinari, K. T. Ramesh, A cohesive model based fragmentation analysis: effects of strain rate and initial defects
--     distribution, Int. J. Solids Struct. 42 (2005) 5181-5207, doi 10.1016/j.ijsolstr.2005.02.009.
-- [T] typical: a value inside the range that handbooks give for this class of material, not of one specimen: replace it by your own.
-- Rocks, concrete, glass and ice scatter by tens of per cent; a number marked [T] decides nothing that you publish.
--
-- Metals have no fracture part: a joint law fitted to their ductile fracture does not exist here.
-- Their plastic parts are fitted to fast loading. Those with heat are adiabatic; for slow loading, where heat flows
-- away: copper.plastic.m, copper.plastic.heat = nil, nil. Meshes lock less with copper.plastic.pressure = "averaged".
-- Joint penalties are 20 E: the joints then take about 5 % of the body's stiffness. Contact: penalty E, friction [T].
local function brittle(t)
  t.fracture.penalty = t.fracture.penalty or 20*t.elastic.young
  t.contact = t.contact or { penalty = t.elastic.young, friction = 0.6 }
  return t
end
--- The cohesion with which a slender specimen of this friction angle has this strength in compression (Mohr-Coulomb).
local function cohesion(compressive, angle) return compressive*(1 - math.sin(angle))/(2*math.cos(angle)) end
--- The energy of a crack whose toughness is K [Pa sqrt(m)], in plane strain (Irwin).
local function energy(K, elastic) return K^2*(1 - elastic.poisson^2)/elastic.young end

--- A metal of [J].
local function metal(name, density, young, poisson, A, B, n, C, m, capacity, melting)
  return { name, source = "Johnson & Cook 1983; E, nu typical", density = density, elastic = { young = young*GPa, poisson = poisson },
    plastic = { law = "johnson_cook", A = A*MPa, B = B*MPa, n = n, C = C, rate0 = 1, m = m, melting = melting, heat = { capacity = capacity } } }
end

return {
  -- Rocks
  granite = brittle{ "granite", source = "typical",
    density  = 2650,
    elastic  = { young = 60*GPa, poisson = 0.25 },
    fracture = { tension = 8*MPa, shear = 20*MPa, friction_angle = 50*deg, G1 = 80*J/m2, G2 = 160*J/m2, softening = "exponential" },
  },
  marble = brittle{ "marble", source = "typical",
    density  = 2700,
    elastic  = { young = 55*GPa, poisson = 0.25 },
    fracture = { tension = 6*MPa, shear = 15*MPa, friction_angle = 40*deg, G1 = 40*J/m2, G2 = 80*J/m2, softening = "exponential" },
  },
  sandstone = brittle{ "sandstone", source = "Goodman 1989 (Berea): shear, angle; rest typical",
    density  = 2200,
    elastic  = { young = 19*GPa, poisson = 0.25 },                          -- E [G]; nu [T], [G] has 0.38
    fracture = { tension = 4*MPa, shear = 27.2*MPa, friction_angle = 27.8*deg, -- tension [T]; shear, angle [G]
                 G1 = 25*J/m2, G2 = 100*J/m2, softening = "exponential" },  -- [T]
  },
  limestone = brittle{ "limestone", source = "Goodman 1989 (Bedford): E, nu, shear, angle; rest typical",
    density  = 2300,
    elastic  = { young = 28.5*GPa, poisson = 0.29 },                        -- [G]
    fracture = { tension = 4*MPa, shear = cohesion(51*MPa, 42*deg), friction_angle = 42*deg, -- tension [T]; 51 MPa and angle [G]
                 G1 = 30*J/m2, G2 = 90*J/m2, softening = "exponential" },   -- [T]; a toughness of 1 MPa sqrt(m)
  },
  basalt = brittle{ "basalt", source = "Goodman 1989 (Nevada Test Site); density, energies typical",
    density  = 2700,
    elastic  = { young = 34.9*GPa, poisson = 0.32 },                        -- [G]
    fracture = { tension = 13.1*MPa, shear = cohesion(148*MPa, 31*deg), friction_angle = 31*deg, -- [G]
                 G1 = 90*J/m2, G2 = 360*J/m2, softening = "exponential" },  -- [T]
  },
  -- The rock of the Brazilian test in the paper, with its own penalties: it is not a real rock.
  brazilian_rock = brittle{ "rock", source = "INFIDEP paper, table 4: no real rock",
    density  = 2700, elastic = { young = 50*GPa, poisson = 0.25 },          -- [P] table 4
    fracture = { tension = 3*MPa, shear = 31.5*GPa, G1 = 5*J/m2, G2 = 5*J/m2, penalty = 40*GPa },
    contact  = { penalty = 40*GPa, friction = 0.1 },
  },

  -- Concrete, ceramics, polymers, ice
  concrete = brittle{ "concrete", source = "fib Model Code 2010 (C30/37); shear, angle, G2 typical",
    density  = 2400,                                                        -- [M] plain, normal weight
    elastic  = { young = 33*GPa, poisson = 0.2 },                           -- [M] C30/37, quartzite aggregate: 33.6 GPa
    fracture = { tension = 2.9*MPa, shear = 7*MPa, friction_angle = 37*deg, -- tension [M]; shear and angle [T]
                 G1 = 141*J/m2, G2 = 1410*J/m2 },                           -- G1 [M] 73 fcm^0.18, fcm = 38 MPa; G2 [T]
  },
  mortar = brittle{ "mortar", source = "typical",
    density  = 2100,
    elastic  = { young = 25*GPa, poisson = 0.2 },
    fracture = { tension = 3*MPa, shear = 8*MPa, friction_angle = 35*deg, G1 = 50*J/m2, G2 = 500*J/m2, softening = "bilinear" },
  },
  glass = brittle{ "glass", source = "EN 572-1; strength, energies typical",  -- soda-lime float glass
    density  = 2500,                                                        -- EN 572-1
    elastic  = { young = 70*GPa, poisson = 0.2 },                           -- EN 572-1: 70 GPa, 0.2
    fracture = { tension = 60*MPa, shear = 120*MPa, G1 = 8*J/m2, G2 = 16*J/m2 },  -- [T]; flaws decide the strength
    contact  = { penalty = 70*GPa, friction = 0.2 },                        -- [T]
  },
  alumina = brittle{ "alumina", source = "Munro 1997; shear, G2 typical",
    density  = 3984,                                                        -- [A]
    elastic  = { young = 416*GPa, poisson = 0.231 },                        -- [A]
    fracture = { tension = 380*MPa, shear = 760*MPa, softening = "linear",  -- in bending [A]; shear [T]
                 G1 = energy(3.5*MPa, { young = 416*GPa, poisson = 0.231 }), G2 = 60*J/m2 },  -- 3.5 MPa sqrt(m) [A]; G2 [T]
    contact  = { penalty = 416*GPa, friction = 0.4 },                       -- friction [A]
  },
  ceramic = brittle{ "ceramic", source = "Zhou, Molinari & Ramesh 2005; nu, shear, G2 typical",  -- like alumina, of a theory of fragments
    density  = 2750,                                                        -- [Z]
    elastic  = { young = 275*GPa, poisson = 0.2 },                          -- [Z]; nu [T], [Z] has one dimension
    fracture = { tension = 300*MPa, shear = 600*MPa, G1 = 100*J/m2, G2 = 200*J/m2, softening = "linear" },  -- [Z]; shear, G2 [T]
    contact  = { penalty = 275*GPa, friction = 0.2 },
  },
  PMMA = brittle{ "PMMA", source = "typical",                               -- at room temperature; brittle, no flow
    density  = 1180,
    elastic  = { young = 3.1*GPa, poisson = 0.35 },
    fracture = { tension = 70*MPa, shear = 70*MPa, G1 = 400*J/m2, G2 = 400*J/m2, softening = "linear" },
    contact  = { penalty = 3.1*GPa, friction = 0.4 },
  },
  ice = brittle{ "ice", source = "Gammon et al. 1983, Petrovic 2003; shear, angle, G2 typical",  -- fresh water, about -15 C
    density  = 917,
    elastic  = { young = 9.33*GPa, poisson = 0.325 },                       -- [I]
    fracture = { tension = 1.5*MPa, shear = 3*MPa, friction_angle = 30*deg, -- tension 0.7 to 3.1 MPa [R]; shear, angle [T]
                 G1 = energy(0.1*MPa, { young = 9.33*GPa, poisson = 0.325 }), G2 = 2*J/m2 },  -- 0.05 to 0.15 MPa sqrt(m) [R]; G2 [T]
    contact  = { penalty = 9.33*GPa, friction = 0.1 },                      -- [T]
  },

  -- Metals
  ["mild steel"] = { "mild steel", source = "EN 1993-1-1 (S235)",
    density = 7850, elastic = { young = 210*GPa, poisson = 0.3 },           -- [S]
    -- [S] 235 MPa, and 360 MPa of the first section; reached at 15 % of lengthening [T], as true stress and plastic strain
    plastic = { law = "j2", yield = { { 0, 235*MPa }, { 0.138, 414*MPa } } },
  },
  ["42CrMo4"] = { "42CrMo4", source = "INFIDEP paper, table 1",
    density = 7830, elastic = { young = 206.9*GPa, poisson = 0.29 },        -- [P] table 1
    plastic = { law = "johnson_cook", A = 806*MPa, B = 614*MPa, n = 0.168, C = 0.0089, rate0 = 1 },  -- [P] table 1
  },
  --                                               density   E   nu      A    B    n    C      m   heat melting
  ["OFHC copper"]     = metal("OFHC copper",          8960, 124, 0.34,   90, 292, 0.31, 0.025, 1.09, 383, 1356),
  ["cartridge brass"] = metal("cartridge brass",      8520, 110, 0.35,  112, 505, 0.42, 0.009, 1.68, 385, 1189),
  ["Armco iron"]      = metal("Armco iron",           7890, 207, 0.29,  175, 380, 0.32, 0.060, 0.55, 452, 1811),
  ["1006 steel"]      = metal("1006 steel",           7890, 207, 0.29,  350, 275, 0.36, 0.022, 1.00, 452, 1811),
  ["4340 steel"]      = metal("4340 steel",           7830, 205, 0.29,  792, 510, 0.26, 0.014, 1.03, 477, 1793),
  ["S-7 steel"]       = metal("S-7 steel",            7750, 207, 0.29, 1539, 477, 0.18, 0.012, 1.00, 477, 1763),
  ["2024-T351"]       = metal("2024-T351",            2770,  73, 0.33,  265, 426, 0.34, 0.015, 1.00, 875,  775),
  ["7039"]            = metal("7039",                 2770,  70, 0.33,  337, 343, 0.41, 0.010, 1.00, 875,  877),
  ["6061-T6"] = { "6061-T6", source = "Lesuer et al. 2001; E, nu, heat typical",
    density = 2700, elastic = { young = 68.9*GPa, poisson = 0.33 },         -- [T] handbook values of the alloy
    plastic = { law = "johnson_cook", A = 324*MPa, B = 114*MPa, n = 0.42, C = 0.002, rate0 = 1, m = 1.34,  -- [L]
                melting = 925, heat = { capacity = 896 } },                 -- [T] liquidus, handbook capacity
  },
}
