#!/usr/bin/python3
"""docs/mistakes.md shows what the program says: check_mistakes.py FISSURE2D [--write]

Makes each of these mistakes in one scene, takes what is said, and compares the page made of it with docs/mistakes.md, which --write brings up to date. Words must be the
same, and numbers to a hundredth: meshes may differ in their last bits from one processor to another.
"""
import dataclasses
import os
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs/mistakes.md"
SCENE = """\
local rock = material{ "rock", density = 2700, elastic = { young = 50*GPa, poisson = 0.25 },
  fracture = { tension = 3*MPa, shear = 10*MPa, G1 = 5*J/m2, G2 = 20*J/m2, penalty = 500*GPa },
  contact = { penalty = 50*GPa, friction = 0.3 } }
local stone = body{ "stone", shape = disc{ radius = 25*mm, thickness = 10*mm }, mesh = { size = 3*mm }, material = rock,
                    velocity = { 0, -10 } }
local floor = plate{ "floor", below(stone), velocity = { 0, 0 } }
measure{ "load", unit = "N", function(now) return now.force(floor) end }
plot{ "load" }
output{ every = 10*us, fields = { "principal", "damage" } }
run{ time = 20*us }
"""


@dataclasses.dataclass
class Mistake:
    title: str
    right: str                                # of the scene, "" for the end: becomes
    wrong: str
    advice: str
    command: str = "fissure2d check stone.lua"


SECTIONS = {
    "Writing Lua": [
        Mistake("A comma is missing", "poisson = 0.25 },\n", "poisson = 0.25 }\n", "Entries of a table stand between commas, at the end of a line, too."),
        Mistake("A brace is missing", "run{ time = 20*us }", "run{ time = 20*us", "Lua noticed at the end of the file; what is open began in the line it names."),
        Mistake("Parentheses for braces", "run{ time = 20*us }", "run( time = 20*us )", "All verbs take a table: braces."),
        Mistake("A decimal comma", "radius = 25*mm", "radius = 25,5*mm", "A comma ends an entry; write `25.5*mm`."),
        Mistake("A comment of another language", "run{", "// how long\nrun{", "Write `-- how long`."),
        Mistake("Unequal in another language", "return now.force(floor)", "if now.time != 0 then return 1 end return 0", "Write `now.time ~= 0`."),
        Mistake("`local` is missing", "local floor", "floor", "Every name is declared once, with `local`: so a misspelt one cannot pass for a new one."),
        Mistake("Used before it is there", "plot{ \"load\" }\n", "plate{ above(stone), velocity = { 0, -speed } }\nlocal speed = 2\n",
                "A scene is read from top to bottom."),
        Mistake("A verb is assigned to", 'plot{ "load" }', "gravity = { 0, -9.81 }", "Verbs are called: `gravity{ 0, -9.81 }`."),
        Mistake("A number is called", "now.force(floor)", "now.force(floor)/now.time()", "`now.time` and `now.step` are numbers; what takes an argument is called."),
    ],
    "Words and values": [
        Mistake("A verb is misspelt", "measure{", "mesure{", "The [scene reference](reference/scene.md) has all of them."),
        Mistake("A unit in other letters", "3*MPa", "3*Mpa", "[Units](reference/scene.md#units) are written as in books: `MPa`, `kN`, `us`."),
        Mistake("Values without their keys", "disc{ radius = 25*mm, thickness = 10*mm }", "disc(25*mm, 10*mm)", "The message ends with an example that is right."),
        Mistake("A number where a vector belongs", "velocity = { 0, -10 }", "velocity = -10", "y points up: `{ 0, -10 }` is downwards."),
        Mistake("The mesh as a number", "mesh = { size = 3*mm }", "mesh = 3*mm", "`mesh` is a table, since it can have more than a size."),
        Mistake("A name in quotes", "material = rock", 'material = "rock"', "`\"rock\"` is what the program calls it; `rock` is the material."),
        Mistake("A key of another verb", 'below(stone), velocity = { 0, 0 }', 'below(stone), speed = { 0, 0 }', "Plates have a `velocity`."),
        Mistake("A place that a body has not", 'plot{ "load" }', 'hold{ stone, at = "botom", velocity = { 0, 0 } }', "Or say where by a function: `at = function(x, y, z) return y < -20*mm end`."),
        Mistake("A kind of cells of the other dimension", "size = 3*mm }", 'size = 3*mm, cells = "tet" }', "`\"simplex\"` and `\"block\"` are right in both."),
        Mistake("Not a word of a list", 'plot{ "load" }', 'assume{ two_d = "planestress" }', "What may stand there is in the message."),
    ],
    "Measures": [
        Mistake("`return` is forgotten", "return now.force", "local force = now.force", "A function without `return` answers nothing."),
        Mistake("A question that there is not", "now.force(floor)", "now.frce(floor)", "[`now`](reference/scene.md#now) has all questions."),
        Mistake("The force on a body", "now.force(floor)", "now.force(stone)", "Forces are known of plates, walls (`now.wall_force`) and holds (`now.reaction`)."),
        Mistake("A name that is taken", '"load", unit', '"time", unit', "A measure can be asked as `now.NAME`, so that its name must be free."),
        Mistake("A plot of nothing", 'plot{ "load" }', 'plot{ "lod" }', "`plot` and `expect` name a measure as `measure` does."),
        Mistake("A division by zero", "velocity = { 0, -10 }", "velocity = function(x, y) return { 1/x, 1/y } end", "The place is named. Where the function has no value there, give it one: `y == 0 and 0 or 1/y`."),
    ],
    "Physics": [
        Mistake("A density in g/cm3", "density = 2700", "density = 2.7", "SI: 2700 kg/m3."),
        Mistake("An angle in degrees", "penalty = 500*GPa", "friction_angle = 35, penalty = 500*GPa", "Angles are radians; `35*deg` is that."),
        Mistake("Incompressible", "poisson = 0.25", "poisson = 0.5", "0.49 is nearly incompressible, and makes steps short."),
        Mistake("Joints that are too soft", "penalty = 500*GPa", "penalty = 50*GPa", "[Joints cost stiffness](theory/joints.md): 10 to 20 E, or 2 E with `insertion = \"adaptive\"`."),
        Mistake("A mesh too coarse for the crack", "G1 = 5*J/m2", "G1 = 0.5*J/m2", "The [verdict](verdict.md) has it, too. A finer mesh, or a tougher material."),
        Mistake("A step that is too long", "20*us }", "20*us, dt = 1*us }", "Leave `dt` out: it is found, and follows what happens."),
        Mistake("No time", "run{ time = 20*us }", "run{ safety = 0.5 }", "A run ends at `time`, or earlier, by `stop`."),
    ],
    "The command line": [
        Mistake("The command is forgotten", "", "", "", "fissure2d stone.lua"),
        Mistake("A unit in --set", "", "", "SI units as plain numbers: `--set body.mesh.size=3e-3`.", "fissure2d check stone.lua --set body.mesh.size=3*mm"),
        Mistake("A parameter that the scene has not", "", "", "`param` declares one in the scene: `local size = param(\"size\", 3*mm, \"of elements (m)\")`; keys of tables can be set without.",
                "fissure2d check stone.lua --set size=3e-3"),
        Mistake("The ending of the file is missing", "", "", "`stone.lua`.", "fissure2d check stone"),
        Mistake("A folder with other things in it", "", "", "A run replaces the folder of an earlier run, and no other.", "fissure2d run stone.lua --out notes"),
        Mistake("Going on with what has not run", "", "", "`restart` takes the folder of a run, not its scene.", "fissure2d restart stone"),
    ],
}


def said(program, mistake, folder):
    """What the program says, and the line that is wrong."""
    assert mistake.right in SCENE, mistake.title
    scene = SCENE.replace(mistake.right, mistake.wrong, 1) if mistake.right else SCENE
    (folder / "stone.lua").write_text(scene)
    (folder / "notes").mkdir(exist_ok=True)
    (folder / "notes" / "thesis.txt").write_text("mine")
    words = mistake.command.split()
    done = subprocess.run([program, *words[1:]], cwd=folder, capture_output=True, text=True, check=False)
    lines = [line for line in done.stdout.splitlines() if line.startswith(("warning:", "verdict"))] + done.stderr.splitlines()
    assert done.returncode == 2 or any(line.startswith("warning:") for line in lines), f"{mistake.title}: status {done.returncode}, {lines}"
    lines = [line for line in lines if not line.startswith("verdict") or not line.endswith("ok")]
    before = SCENE.splitlines()
    changed = [line for line in scene.splitlines() if line not in before] or [line for line in before if line not in scene.splitlines()]
    return changed, list(dict.fromkeys(lines))


def page(program):
    count = sum(map(len, SECTIONS.values()))
    text = f"""# {count} mistakes, and what the program says

Each is made in this scene, `stone.lua`; below are the line as it was then, what came out, and what to do. A test makes them all and writes this page.

```lua scene
{SCENE}```

`file:line: what: why; the nearest right word`: the line is where Lua was when it noticed; what is wrong may stand in the line above.
"""
    with tempfile.TemporaryDirectory() as place:
        for section, mistakes in SECTIONS.items():
            text += f"\n## {section}\n"
            for mistake in mistakes:
                changed, lines = said(program, mistake, pathlib.Path(place))
                shown = changed if mistake.right else ["$ " + mistake.command]
                text += f"\n### {mistake.title}\n\n" + "".join(f"    {line}\n" for line in shown) + "\n"
                text += ">\n".join(f"> {markdown(line)}\n" for line in lines) + (f"\n{mistake.advice}\n" if mistake.advice else "")
    return text


def markdown(line):
    """As it is, whatever stands in it."""
    ticks = "``" if "`" in line else "`"
    return f"{ticks}{line}{ticks}"


def pieces(text):
    number = re.compile(r"(?<![\w.])-?\d+\.?\d*(?:e[-+]?\d+)?(?![\w])")
    return number.sub("#", text), [float(found) for found in number.findall(text)]


def main():
    program = os.path.abspath(sys.argv[1])
    made = page(program)
    if "--write" in sys.argv:
        PAGE.write_text(made, encoding="utf-8")
        return
    (words, numbers), (shown, shown_numbers) = pieces(made), pieces(PAGE.read_text(encoding="utf-8"))
    if words != shown or any(abs(a - b) > 0.01 * max(abs(a), abs(b)) for a, b in zip(numbers, shown_numbers)):
        import difflib
        print("\n".join(difflib.unified_diff(PAGE.read_text(encoding="utf-8").splitlines(), made.splitlines(), "docs/mistakes.md", "what is said", lineterm="", n=0)))
        sys.exit("docs/mistakes.md is not what the program says (tests/check_mistakes.py FISSURE2D --write)")


if __name__ == "__main__":
    main()
