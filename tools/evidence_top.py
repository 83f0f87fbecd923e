# SPDX-License-Identifier: GPL-3.0-or-later
"""The page on top of docs/evidence: ten numbers and three plots, from the numbers of the sections."""
import re

from evidence_run import table

BENCH = "build/host/bin/triskin-bench"
# Question, answer with {section.key}, command, what it does not say.
TEN = [
    ("How fast is a placement that is proved?", "The paper's R4 in CGAL takes {placement.r4_smooth} times as long on a smooth outline, {placement.r4_rough} times on a rough one.",
     f"`{BENCH} placement --quick \\| grep baseline`, `ratio_to_r4_cgal`",
     "R4 is our own reading of the paper, timed on 400 of its 252,800 poses; two outlines of 757 cm²."),
    ("And how good?", "Modules of the search and of R4: {placement.r4_modules}; the first number is proved to be the most.", "the same rows, `modules`, `upper_bound`, `r4_modules`",
     "One lattice on one flat outline; covers bend."),
    ("How does it grow?", "With the number of vertices to the power {placement.vertices}; ε = 1e-8 instead of 0.01 mm costs {placement.tolerance} times the cells.",
     f"`{BENCH} placement --quick \\| grep -E 'vertices\\|tolerance'`", "Outlines that miss a pattern by a hair cost a hundred times more ([placement](placement.md#time-against-tolerance))."),
    ("How full is a curved cover?", "{covers.lattice} of what its area would hold, after 300 counted steps on a torso (median of five seeds).", f"`{BENCH} lattice --quick \\| grep torso`, `modules` over `bound`",
     "The rest is not proved to be lost: no better bound than the area is known."),
    ("Are the controllers the fewest?", "Proved in {wiring.proved} cases; CBC agrees in {wiring.cbc_equal} and takes {wiring.cbc} times as long for {wiring.cbc_modules} modules.", f"`{BENCH} routing --quick`, `proved`, `ratio_to_milp`",
     "CBC runs alone, with one formulation; random patches and three covers."),
    ("How much of a mesh is needed?", "{surface.decimation} of 30,000 faces go, and no point moves by more than 0.05 mm: a proved bound.", f"`{BENCH} mesh --quick \\| grep asked_mm`", "A flatter part loses more faces, a finer one fewer."),
    ("How good is the fast model of contact?", "The level `table` is at worst {contacts.table_error} of a taxel's peak off the exact layer, and {contacts.table_cheaper} times cheaper.",
     f"`{BENCH} contact --quick \\| grep '\"level\"'`", "Exact for a linear elastic layer; real foam is not linear."),
    ("Do stated errors of contacts hold?", "{contacts.covered} of the values of single contacts lie within 1.96 stated deviations (95 % would be right); error over the Cramér-Rao bound: {contacts.cramer_rao}.", f"`{BENCH} contact --quick \\| grep study`", "Simulated noise that is normal and known; thirty draws a row."),
    ("Are stamps and samples honest?", "{device.clock} times lie outside their stated bound; lost are {streams.lost}.", f"`{BENCH} device --quick \\| grep clock`; `tools/evidence --only streams`",
     "Modelled ways and virtual hardware; no real board was measured."),
    ("Does it hold at the edge of the numbers?", "{hard.hard} hard cases in {hard.hard_parts} parts pass.", "`ctest --test-dir build/host -L hard`", "[What is open](hard.md#open) is listed there."),
]
PLOTS = [("placement_r4.svg", "Placement beside the paper's R4", "placement.md"), ("contacts_levels.svg", "Contact: how much cheaper a level is, against its error", "contacts.md"),
         ("covers_steps.svg", "Covers: modules against the bound by area", "covers.md")]
INTRO = """# Evidence: speed against error

What Triskin computes, how fast and how exactly, beside others where there are any. Times are processor time and shown
as ratios within one run, with median and range of its repetitions; everything else is counted. Seeds are in the pages.

```
cmake --preset host && cmake --build build/host --target triskin triskin_bench
tools/evidence                       # all of it; without `hard` ten minutes of processor time
tools/evidence --only placement      # one section
```

## Ten numbers"""


def filled(template, numbers):
    """Puts the numbers into a sentence."""
    return re.sub(r"\{(\w+)\.(\w+)\}", lambda m: numbers.get(m[1], {}).get(m[2], {}).get("text", "(not measured)"), template)


def write(out, numbers, titles):
    parts = [INTRO, table(("#", "question", "answer", "command", "what it does not say"), [(k + 1, q, filled(a, numbers), c, n) for k, (q, a, c, n) in enumerate(TEN)]), "## Three plots"]
    parts += [f"[![{title}]({file})]({page})" for file, title, page in PLOTS if (out / file).exists()]
    parts.append("## Pages")
    parts.append(table(("page", "made"), [(f"[{titles[name]}]({name}.md)", numbers[name]["note"].replace("Made by ", "")) for name in titles if name in numbers]))
    parts.append("Older, longer and with other machines: [measurements](../measurements/README.md). A task that anyone can\nenter: the [open benchmark](../benchmark/README.md).")
    (out / "README.md").write_text("\n\n".join(parts) + "\n")
