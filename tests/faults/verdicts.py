#!/usr/bin/env python3
"""The verdict at the end of a run: scenes made to be wrong get the right reason, sound ones get "ok". What the examples get is asked by check_results.py.

    verdicts.py fissure2d fissure3d [case ...]
"""
import json
import os
import re
import sys

from rig import cases, BLOCK, CRACKING, ELASTIC, PROGRAMS, expect, run, scene


PULLED = """
local rock = material{ "rock", density = 2700, elastic = { young = 50*GPa, poisson = 0.25 },
  fracture = { tension = 30*MPa, shear = 100*MPa, G1 = 500*J/m2, G2 = 2000*J/m2, penalty = 1000*GPa } }
local bar = body{ "bar", shape = box{ size = {40*mm, 10*mm, 10*mm}, center = {0, 0, 0} }, mesh = { size = 5*mm, structured = true }, material = rock }
hold{ bar, at = "left", velocity = { 0, 0, 0 } }
hold{ bar, at = "right", velocity = { ramp{ to = SPEED, over = 20*us }, 0, 0 } }
run{ time = TIME, mass_damping = 5e3 }
"""


def verdict(folder, text, *words, duration="20*us", status=None):
    """What both programs say at the end, which must be the same, and what run.json says."""
    said = set()
    for program in PROGRAMS:
        out = os.path.join(folder, os.path.basename(program))
        result = run(program, "run", scene(folder, text, duration), "--out", out, *words)
        line = re.search(r"^verdict: (.*)$", result.stdout, re.M)
        expect(line, result.stdout[-500:] + result.stderr[-500:])
        record = json.load(open(os.path.join(out, "run.json")))["verdict"]
        grade, _, reasons = line[1].partition(": ")
        expect(record["grade"] == grade, record)
        expect({reason["what"] for reason in record["reasons"]} == set(reasons.split(", ") if reasons else []), f"{line[1]}: {record}")
        for reason in record["reasons"]:
            expect(f"warning: {reason['why']}" in result.stdout + result.stderr, reason)
        expect(result.returncode == (1 if grade == "do not trust" else 0), f"{line[1]}: status {result.returncode}")
        said.add(line[1])
    expect(len(said) == 1, f"{said}: {words} {duration} {text}")
    return said.pop()


def expect_verdict(folder, wanted, text, *words, **more):
    got = verdict(folder, text, *words, **more)
    expect(got == wanted, f"{got}, wanted {wanted}: {words} {more} {text}")


def step_above_its_limit(folder):
    for program in PROGRAMS:
        checked = run(program, "check", scene(folder, BLOCK)).stdout
        limit = float(re.search(r"limit ([\d.e-]+) s", checked)[1])
        text = BLOCK.replace("run{ time = TIME }", f"run{{ time = {5 * limit}, dt = {1.05 * limit} }}")
        foreseen = run(program, "check", scene(folder, text)).stdout
        expect("verdict as far as it can be foreseen: do not trust: step above its limit" in foreseen, foreseen)
        result = run(program, "run", scene(folder, text), "--out", os.path.join(folder, os.path.basename(program)))
        expect("verdict: do not trust: step above its limit" in result.stdout and result.returncode == 1, result.stdout)


def contact_too_soft(folder):
    text = BLOCK.replace("{ 0, -1 }", "{ 0, -10 }").replace("density = 7800,", "density = 7800, contact = { penalty = 60*MPa },")
    expect_verdict(folder, "look again: contact too soft", text, duration="100*us")


def process_zone_unresolved(folder):
    """E' G1/ft^2 is 3 mm, elements have 2.5."""
    expect_verdict(folder, "look again: process zone", CRACKING.replace("G1 = 5*J/m2", "G1 = 0.5*J/m2"), duration="30*us")


def joints_too_soft(folder):
    expect_verdict(folder, "look again: joints too soft", CRACKING.replace("500*GPa", "100*GPa"), duration="5*us")


SHEARED = """local p, E = PRESSURE*MPa, 50*GPa
local rock = material{ "rock", density = 2600, elastic = { young = E, poisson = 0 }, contact = { penalty = E, friction = 0 },
  fracture = { tension = 200*MPa, shear = 300*MPa, G1 = 60000, G2 = 6000, penalty = 2*E, softening = "linear", insertion = "adaptive" } }
local layer = body{ "layer", shape = box{ size = { 8*mm, 8*mm, 4*mm } }, material = rock, mesh = { size = 2*mm, structured = true } }
joints{ "seam", layer, at = function(x, y) return math.abs(y) < 0.1*mm end, strength = 0.1 }
local function across(s) return function(t) return t < 40*us and -s*p/E*4*mm/(40*us) or 0 end end
local function along(s) return function(t) return t < 60*us and 0 or s*math.min(1, (t - 60*us)/(10*us)) end end
hold{ layer, at = "bottom", velocity = { along(-1), across(-1), 0 } }
hold{ layer, at = "top", velocity = { along(1), across(1), 0 } }
run{ time = TIME, mass_damping = 1e5 }
"""


def inserted_under_pressure(folder):
    """A seam that is pressed before it is sheared off takes G2 and no more, whatever the pressure."""
    for pressure in "1", "100", "300":
        expect_verdict(folder, "ok", SHEARED.replace("PRESSURE", pressure), duration="100*us")


def slip_that_no_mesh_shows(folder):
    """Its process zone, E' G2/shear^2, is half an element long; where nothing slides it does not matter."""
    brittle = SHEARED.replace("PRESSURE", "1").replace("G2 = 6000", "G2 = 2000")
    expect_verdict(folder, "look again: process zone", brittle, duration="100*us")
    expect_verdict(folder, "ok", brittle, duration="30*us")


def single_precision_with_stiff_joints(folder):
    """Joints of 1000 E open by 0.2 nm at their peak; the bar flies 0.2 mm."""
    text = PULLED.replace("tension = 30*MPa", "tension = 3*MPa").replace("1000*GPa", "50000*GPa").replace("material = rock }\n", "material = rock, velocity = { 20, 0, 0 } }\n")
    text = re.sub(r"hold.*\n", "", text)
    expect_verdict(folder, "look again: single precision", text, "--precision", "single", duration="10*us")
    expect_verdict(folder, "ok", text, duration="10*us")
    for program in PROGRAMS:
        checked = run(program, "check", scene(folder, text, "10*us"), "--precision", "single").stdout
        expect("foreseen: look again: single precision" in checked, checked)


def locked_simplices(folder):
    """A block of steel that flows at 400 m/s: triangles and tetrahedra of one pressure each; averaged pressure mends it."""
    text = BLOCK.replace("elastic = { young = 200*GPa, poisson = 0.3, law = \"neo_hookean\" }",
                         "elastic = { young = 200*GPa, poisson = 0.3 }, plastic = { law = \"j2\", yield = 300*MPa, PRESSURE }")
    text = text.replace("velocity = { 0, -1 }", "velocity = { 0, -200 }").replace("size = 2.5*mm, structured = true", "size = 1.25*mm")
    got = verdict(folder, text.replace("PRESSURE", "pressure = \"element\""), duration="8*us")
    expect(got == "look again: pressure checkerboard", got)
    expect_verdict(folder, "ok", text.replace("PRESSURE", "pressure = \"averaged\""), duration="8*us")


def hourglass_modes_that_run_away(folder):
    text = """
local steel = material{ "steel", density = 7800, elastic = { young = 200*GPa, poisson = 0.3 } }
body{ "beam", shape = box{ size = {20*mm, 2*mm, 2*mm}, center = {0, 0, 0} }, mesh = { size = 2*mm, cells = "block", integration = "HOW" },
      material = steel, velocity = function(x, y, z) return { 0, 2e4*x*x, 0 } end }
run{ time = TIME }
"""
    expect_verdict(folder, "do not trust: hourglass modes", text.replace("HOW", "one_point"), duration="40*us")
    expect_verdict(folder, "ok", text.replace("HOW", "assumed_strain"), duration="40*us")


def added_mass(folder):
    text = BLOCK.replace("run{ time = TIME }", "run{ time = TIME, mass_scaling = 1.3 }")
    expect_verdict(folder, "look again: mass scaling", text, duration="10*us")


def loaded_too_fast(folder):
    got = verdict(folder, PULLED.replace("SPEED", "5"), duration="8*us")
    expect("loaded too fast" in got, got)
    expect_verdict(folder, "ok", PULLED.replace("SPEED", "0.05"), duration="200*us")


def plate_faster_than_waves(folder):
    """Pressure waves travel at 37 m/s in it."""
    text = BLOCK.replace("density = 7800, elastic = { young = 200*GPa", "density = 1000, elastic = { young = 1*MPa").replace("{ 0, -1 }", "{ 0, -40 }")
    for program in PROGRAMS:
        result = run(program, "run", scene(folder, text, "5*us"), "--out", os.path.join(folder, os.path.basename(program)))
        expect(re.search(r"verdict: do not trust: faster than waves", result.stdout) and result.returncode == 1, result.stdout)
    for program in PROGRAMS:
        checked = run(program, "check", scene(folder, text, "5*us")).stdout
        expect("foreseen: do not trust: faster than waves" in checked, checked)


def what_was_never_touched(folder):
    text = BLOCK.replace("below(block)", "box = box{ size = { 10*mm, 1*mm, 10*mm }, center = { 0, -50*mm } }")
    expect_verdict(folder, "look again: never touched", text, duration="5*us")


def runs_that_fail(folder):
    """A step that turns elements over, and a load that crushes them at once: no run that ended with an error is ok, and check foresees what comes in its first steps."""
    for text, reasons in ((BLOCK.replace("run{ time = TIME }", "run{ time = 20*us, dt = 1.5*us }"), "step above its limit, it failed"),
                          (BLOCK.replace("output{", "hold{ block, at = \"top\", velocity = { 0, -1e6 } }\noutput{"), "faster than waves, it failed")):
        for program in PROGRAMS:
            out = os.path.join(folder, os.path.basename(program))
            result = run(program, "run", scene(folder, text), "--out", out)
            record = json.load(open(os.path.join(out, "run.json")))["verdict"]
            expect(result.returncode == 2 and f"verdict: do not trust: {reasons}\n" in result.stdout, result.stdout[-300:] + result.stderr)
            expect(record["grade"] == "do not trust" and record["reasons"][-1]["why"] in result.stderr, record)
            checked = run(program, "check", scene(folder, text))
            expect("verdict as far as it can be foreseen: do not trust" in checked.stdout, checked.stdout[-300:])


GLUED = """
local function stuff(ft) return { tension = ft, shear = 5*ft, G1 = GLUE, G2 = 4*GLUE, penalty = 600*GPa } end
local strong = stuff(200*MPa)
strong.G1, strong.G2 = 2e3, 2e3
local rock = material{ "rock", density = 2700, elastic = { young = 30*GPa, poisson = 0.2 }, fracture = strong }
local a = body{ "a", shape = box{ size = {20*mm, 10*mm, 10*mm}, center = {-10*mm, 0, 0} }, mesh = { size = 5*mm, structured = true }, material = rock }
local b = body{ "b", shape = box{ size = {20*mm, 10*mm, 10*mm}, center = {10*mm, 0, 0} }, mesh = { size = 5*mm, structured = true }, material = rock }
bond{ a, b, fracture = stuff(1*MPa) }
hold{ a, at = "left", velocity = { 0, nil, nil } }
hold{ b, at = "right", velocity = { ramp{ to = 0.05, over = 100*us }, nil, nil } }
run{ time = 1*ms }
"""


def joints_of_bodies_and_bonds_are_told_apart(folder):
    """Only the bond softens: what the bodies' joints could not resolve does not count, what the bond's could not does."""
    expect_verdict(folder, "ok", GLUED.replace("GLUE", "50"))
    expect_verdict(folder, "look again: process zone", GLUED.replace("GLUE", "0.2"))


def large_elastic_strain(folder):
    """A bar too strong to flow, drawn out: its elastic shear strain is 0.7 of the logarithm of its stretch 
    (stress over 2 mu: less, as J grows). Drawn out and pushed back, and a short neck between two broad ends, too."""
    drawn = """
local much = STRETCH
local strong = material{ "strong", density = 7800, elastic = { young = 200*GPa, poisson = 0.3 }, plastic = { law = "j2", yield = 1e15*Pa, strain = "RATE" } }
local bar = body{ "bar", shape = box{ size = {40*mm, 10*mm, 10*mm}, center = {20*mm, 0, 0} }, mesh = { size = 5*mm, structured = true }, material = strong,
  velocity = function(x) return { much*x/1e-3, 0, 0 } end }
hold{ bar, at = "left", velocity = { 0, nil, nil } }
hold{ bar, at = "right", velocity = { much*40*mm/1e-3, nil, nil } }
run{ time = 1*ms }
"""
    for stretch, verdict_then in ("0.1", "ok"), ("0.3", "look again: large elastic strain"), ("0.9", "do not trust: large elastic strain"):
        text = drawn.replace("STRETCH", stretch)
        expect_verdict(folder, verdict_then, text.replace("RATE", "jaumann"))
        expect_verdict(folder, "ok", text.replace("RATE", "logarithmic"))
    there_and_back = drawn.replace("much*40*mm/1e-3", "function(t) return 40*math.cos(3.14159265*t/1e-3) end")
    there_and_back = there_and_back.replace("STRETCH", "1").replace("RATE", "jaumann")
    expect_verdict(folder, "look again: large elastic strain", there_and_back)
    neck = """
local strong = material{ "strong", density = 7800, elastic = { young = 200*GPa, poisson = 0.3 },
  plastic = { law = "j2", yield = 1e15*Pa } }
local bar = body{ "bar", shape = union{ box{ size = {40*mm, 40*mm, 4*mm}, center = {-24*mm, 0, 0} },
  box{ size = {8*mm, 4*mm, 4*mm} },
  box{ size = {40*mm, 40*mm, 4*mm}, center = {24*mm, 0, 0} } }, mesh = { size = 4*mm }, material = strong }
hold{ bar, at = "left", velocity = { 0, nil, nil } }
hold{ bar, at = "right", velocity = { 10, nil, nil } }
run{ time = 0.6*ms }
"""
    expect_verdict(folder, "look again: large elastic strain", neck)


def coarse_mesh(folder):
    """A beam five times as long as deep, two and four simplices over its depth.

    It sags by 0.6 and 0.9 of F L^3/(3 E I).
    """
    for cells, verdict_then in (2, "look again: coarse mesh"), (4, "ok"):
        expect_verdict(folder, verdict_then, f"""
local steel = material{{ "steel", density = 7800, elastic = {{ young = 200*GPa, poisson = 0.3 }} }}
local beam = body{{ "beam", shape = box{{ size = {{50*mm, 10*mm, 10*mm}} }}, material = steel,
  mesh = {{ size = 10*mm/{cells}, structured = true }} }}
hold{{ beam, at = "left", velocity = {{ 0, 0, 0 }} }}
traction{{ beam, at = "right", value = {{ 0, function(t) return -1*MPa*math.min(1, t/(2*ms)) end }} }}
assume{{ two_d = "plane stress" }}
run{{ time = 2.5*ms, mass_damping = 3000 }}
""")


def overlap_at_the_start(folder):
    """A block a micrometre within a wall is thrown off by the energy of that alone.

    A press fit beside a blow is none.
    """
    for speed, verdict_then in ("0", "look again: overlap at the start"), ("-100", "ok"):
        expect_verdict(folder, verdict_then, f"""
local steel = material{{ "steel", density = 7800, elastic = {{ young = 200*GPa, poisson = 0.3 }} }}
body{{ shape = box{{ size = {{20*mm, 20*mm, 20*mm}} }}, mesh = {{ size = 4*mm, structured = true }}, material = steel,
  velocity = {{ 0, {speed}, 0 }} }}
wall{{ "floor", point = {{ 0, -9.999*mm, 0 }}, normal = {{ 0, 1, 0 }} }}
run{{ time = 20*us }}
""")


def what_lies_at_rest_is_not_wrong(folder):
    """A block that lies exactly on a plate: where rounding overlaps, that is all; else nothing presses."""
    for y, verdict_then in ("13e-3", "ok"), ("1.7", "ok"), ("0", "ok"), ("0.1", "look again: never touched"):
        expect_verdict(folder, verdict_then, f"""
local steel = material{{ "steel", density = 7800, elastic = {{ young = 200*GPa, poisson = 0.3 }} }}
body{{ shape = box{{ size = {{20*mm, 20*mm, 20*mm}}, center = {{0, {y}}} }}, material = steel,
  mesh = {{ size = 4*mm, structured = true }} }}
plate{{ "floor", box = box{{ size = {{60*mm, 10*mm, 60*mm}}, center = {{0, {y} - 15*mm}} }} }}
run{{ time = 20*us }}
""")


def what_flies_rings_or_falls_is_not_wrong(folder):
    """Two bodies side by side at 8 km/s; a cantilever shaken in resonance; a block that falls and comes to rest by damping."""
    flight = """
local steel = material{ "steel", density = 7800, elastic = { young = 200*GPa, poisson = 0.3 } }
for i = 1, 2 do body{ shape = box{ size = {5*mm, 5*mm, 5*mm}, center = {i*20*mm, 0, 0} }, mesh = { size = 2.5*mm, structured = true }, material = steel, velocity = { 0, 8000 + i } } end
run{ time = 5*us }
"""
    expect_verdict(folder, "ok", flight)
    shaken = """
local steel = material{ "steel", density = 7800, elastic = { young = 200*GPa, poisson = 0 } }
local bar = body{ "bar", shape = box{ size = {40*mm, 5*mm, 5*mm}, center = {0, 0, 0} }, mesh = { size = 2.5*mm, structured = true }, material = steel }
local omega = math.pi/2*math.sqrt(200*GPa/7800)/(40*mm)
hold{ bar, at = "left", velocity = { function(t) return 1*mm*math.cos(omega*t) end, 0, 0 } }
run{ time = 4*ms }
"""
    expect_verdict(folder, "ok", shaken)
    falls = """
local soft = material{ "soft", density = 1000, elastic = { young = 5*MPa, poisson = 0.3 }, contact = { penalty = 20*MPa } }
local block = body{ "block", shape = box{ size = {10*mm, 10*mm, 10*mm}, center = {0, 6*mm, 0} }, mesh = { size = 2.5*mm, structured = true }, material = soft }
wall{ point = { 0, 0 }, normal = { 0, 1 } }
gravity{ 0, -9.81 }
run{ time = 60*ms, mass_damping = 500 }
"""
    expect_verdict(folder, "ok", falls)


def sound_runs_are_ok(folder):
    """A verdict that cries wolf is none."""
    soft = 'elastic = { young = 5*MPa, poisson = 0.4, law = "neo_hookean" }'
    for text, duration in (
            (BLOCK, "20*us"), (ELASTIC, "10*us"), (CRACKING, "20*us"), (PULLED.replace("SPEED", "0.1"), "100*us"),
            (BLOCK.replace("{ 0, -1 }", "{ 0, -0.01 }"), "40*us"),
            (BLOCK.replace("{ 0, -1 }", "{ 0, -50 }"), "10*us"),
            (BLOCK.replace("size = 2.5*mm, structured = true", 'size = 2.5*mm, cells = "block"'), "20*us"),
            (BLOCK.replace("size = 2.5*mm, structured = true", 'size = 2.5*mm, cells = "block", integration = "full"'), "20*us"),
            (BLOCK.replace('elastic = { young = 200*GPa, poisson = 0.3, law = "neo_hookean" }', soft).replace("7800", "1000"), "1*ms"),
            (CRACKING.replace("friction = 0.3", "friction = 0"), "10*us"), (CRACKING.replace("2.5*mm }", "2*mm, seed = 3 }"), "10*us")):
        expect_verdict(folder, "ok", text, duration=duration)
    for text in BLOCK, ELASTIC, CRACKING:
        expect_verdict(folder, "ok", text, "--precision", "single", duration="10*us")


if __name__ == "__main__":
    sys.exit(cases(globals()))
