// The built-in library of scenes, `require "materials"`: part of the program, so that an installed binary finds it.

#include "lua/reader.h"

namespace fissure::lua {
namespace {

char const* const materials = R"lua(
-- Real materials as tables for material{}: local rock = material(require "materials".granite)
-- To change a part: local granite = require "materials".granite; granite.contact = { penalty = 10*GPa, friction = 0.3 }
--
-- Sources. [P] INFIDEP paper: table 1 (42CrMo4, after Ming & Pantale 2018), table 4 (Brazilian test, after Munjiza et
-- al. 2011). [J] G. R. Johnson, W. H. Cook, A constitutive model and data for metals subjected to large strains, high
-- strain rates and high temperatures, 7th Int. Symp. on Ballistics, The Hague, 1983. [L] D. R. Lesuer, G. J. Kay, M. M.
-- LeBlanc, Modeling large-strain, high-rate deformation in metals, Lawrence Livermore UCRL-JC-134118, 2001. [M] fib
-- Model Code 2010, sec. 5.1 (concrete C30/37). [T] a typical value inside the range that handbooks give for this class
-- of material, not of one specimen: replace it by your own.
-- Rocks, concrete and glass scatter by tens of per cent; a number marked [T] decides nothing that you publish.
-- Metals have no fracture part: a joint law fitted to their ductile fracture does not exist here.
-- Their plastic parts are fitted to fast loading. Those with heat are adiabatic; for slow loading, where heat flows
-- away: copper.plastic.m, copper.plastic.heat = nil, nil. Meshes lock less with copper.plastic.pressure = "averaged".
-- Joint penalties are 20 E: the joints then take about 5 % of the body's stiffness.
local function with_joints(t)
  t.fracture.penalty = 20*t.elastic.young
  return t
end

return {
  granite = with_joints{ "granite",
    density  = 2650,                                                        -- [T]
    elastic  = { young = 60*GPa, poisson = 0.25 },                          -- [T]
    fracture = { tension = 8*MPa, shear = 20*MPa, friction_angle = 50*deg, G1 = 80*J/m2, G2 = 160*J/m2,
      softening = "exponential" },  -- [T]
    contact  = { penalty = 60*GPa, friction = 0.6 },                        -- [T]
  },
  marble = with_joints{ "marble",
    density  = 2700,                                                        -- [T]
    elastic  = { young = 55*GPa, poisson = 0.25 },                          -- [T]
    fracture = { tension = 6*MPa, shear = 15*MPa, friction_angle = 40*deg, G1 = 40*J/m2, G2 = 80*J/m2,
      softening = "exponential" },   -- [T]
    contact  = { penalty = 55*GPa, friction = 0.6 },                        -- [T]
  },
  concrete = with_joints{ "concrete",
    density  = 2400,                                                        -- [M] plain, normal weight
    elastic  = { young = 33*GPa, poisson = 0.2 },                           -- [M] C30/37, quartzite aggregate: 33.6 GPa
    fracture = { tension = 2.9*MPa, shear = 7*MPa, friction_angle = 37*deg, -- tension [M]; shear and angle [T]
                 G1 = 141*J/m2, G2 = 1410*J/m2 },                           -- G1 [M] 73 fcm^0.18, fcm = 38 MPa; G2 [T]
    contact  = { penalty = 33*GPa, friction = 0.6 },                        -- [T]
  },
  glass = with_joints{ "glass",                                             -- soda-lime float glass
    density  = 2500,                                                        -- EN 572-1
    elastic  = { young = 70*GPa, poisson = 0.2 },                           -- EN 572-1: 70 GPa, 0.2
    fracture = { tension = 60*MPa, shear = 120*MPa, G1 = 8*J/m2, G2 = 16*J/m2 },  -- [T]; flaws decide the strength
    contact  = { penalty = 70*GPa, friction = 0.2 },                        -- [T]
  },
  ["42CrMo4"] = { "42CrMo4",
    density = 7830, elastic = { young = 206.9*GPa, poisson = 0.29 },        -- [P] table 1
    plastic = { law = "johnson_cook", A = 806*MPa, B = 614*MPa, n = 0.168, C = 0.0089, rate0 = 1 },  -- [P] table 1
  },
  ["OFHC copper"] = { "OFHC copper",
    density = 8960, elastic = { young = 124*GPa, poisson = 0.34 },          -- density [J]; elastic constants [T]
    plastic = { law = "johnson_cook", A = 90*MPa, B = 292*MPa, n = 0.31, C = 0.025, rate0 = 1, m = 1.09,   -- [J]
                melting = 1356, heat = { capacity = 383 } },                -- [J]; share and start are the defaults
  },
  ["6061-T6"] = { "6061-T6",
    density = 2700, elastic = { young = 68.9*GPa, poisson = 0.33 },         -- [T] handbook values of the alloy
    plastic = { law = "johnson_cook", A = 324*MPa, B = 114*MPa, n = 0.42, C = 0.002, rate0 = 1, m = 1.34,  -- [L]
                melting = 925, heat = { capacity = 896 } },                 -- [T] liquidus, handbook capacity
  },
  -- The rock of the Brazilian test in the paper, with its own penalties: it is not a real rock.
  brazilian_rock = { "rock",
    density  = 2700, elastic = { young = 50*GPa, poisson = 0.25 },          -- [P] table 4
    fracture = { tension = 3*MPa, shear = 31.5*GPa, G1 = 5*J/m2, G2 = 5*J/m2, penalty = 40*GPa },
    contact  = { penalty = 40*GPa, friction = 0.1 },
  },
}
)lua";

}  // namespace

char const* library(std::string const& name) { return name == "materials" ? materials : nullptr; }

std::vector<std::string> library_names() { return {"materials"}; }

}  // namespace fissure::lua
