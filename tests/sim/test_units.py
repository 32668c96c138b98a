"""What Yosys wrote of a design is cut where statements end, and nothing of it is lost or out of order."""

from __future__ import annotations

import re

import pytest

from roslet.sim import units

DESIGN = """#include <cxxrtl/cxxrtl.h>
namespace cxxrtl_design {

struct p_top : public module {
	value<1> p_clk;
	value<1> prev_p_clk;
	/*outline*/ value<4> p_known;
}; // struct p_top

void p_top::reset() {
	p_a = wire<4>{0u};
}

bool p_top::eval(performer *performer) {
	bool converged = true;
	bool posedge_p_clk = this->posedge_p_clk();
	// \\hdlname: node known
	value<4> p_known;
	value<4> i_near;
	value<4> i_far;
	value<4> i_unused;
	// cells $1
	i_near = add_uu<4>(p_a.curr, value<1>{0x1u});
	p_known = i_near;
	i_far = p_known;
	// cell \\register
	if (posedge_p_clk) {
		if (i_far == value<4> {3u}) {
			p_a.next = i_far;
		} else {
			p_a.next = p_known;
		}
	}
	return converged;
}

void p_top::debug_eval() {
}

} // namespace cxxrtl_design
extern "C"
"""

STATEMENTS = [
    "\ti_near = add_uu<4>(p_a.curr, value<1>{0x1u});",
    "\tp_known = i_near;",
    "\ti_far = p_known;",
    "\tif (posedge_p_clk) {\n\t\tif (i_far == value<4> {3u}) {\n\t\t\tp_a.next = i_far;\n\t\t} else {\n"
    "\t\t\tp_a.next = p_known;\n\t\t}\n\t}",
]


def functions(found: units.Units) -> dict[str, list[str]]:
    """The lines of each function of the units that run often."""
    text = "\n".join(found.often)
    return {
        name: body.splitlines()
        for name, body in re.findall(
            r"^\w+ p_top::(\w+)\([^)]*\) \{\n(.*?)^}", text, re.MULTILINE | re.DOTALL
        )
    }


@pytest.mark.parametrize("count", [1, 2, 5])
def test_every_statement_is_in_a_function_of_its_own_where_they_are_long(
    monkeypatch: pytest.MonkeyPatch, count: int
) -> None:
    monkeypatch.setattr(units, "PART", 1)
    found = units.cut(DESIGN, count)
    assert len(found.often) == count
    bodies = functions(found)
    edge = "\tbool posedge_p_clk = this->posedge_p_clk();"
    assert bodies == {
        **{f"part{n}": [edge, *text.splitlines()] for n, text in enumerate(STATEMENTS)},
        "eval": ["\tpart0();", "\tpart1();", "\tpart2();", "\tpart3();", "\treturn true;"],
    }
    # p_known is a member already, for waveforms; i_near and i_far become ones; nobody needs i_unused.
    members = found.header[found.header.index("/*outline*/") : found.header.index("}; // struct p_top")]
    assert members.splitlines()[1:] == [
        "\tvalue<4> i_near;",
        "\tvalue<4> i_far;",
        *(f"\tvoid part{n}();" for n in range(4)),
    ]
    assert found.header.endswith("}; // struct p_top\n\n} // namespace cxxrtl_design\n")


READ = """\tauto tmp_0 = memory_index(p_a.curr, 0, 16);
	CXXRTL_ASSERT(tmp_0.valid && "out of bounds read");
	if(tmp_0.valid) {
		value<4> tmp_1 = memory_p_mem[tmp_0.index];
		i_far = tmp_1;
	} else {
		i_far = value<4> {};
	}"""


def test_what_is_read_of_a_memory_without_a_clock_stays_with_its_index(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(units, "PART", 1)
    bodies = functions(units.cut(DESIGN.replace("\ti_far = p_known;", READ), 1))
    assert bodies["part2"][1:] == READ.splitlines()
    assert bodies["part3"][1:] == STATEMENTS[3].splitlines()


def test_what_one_function_alone_knows_stays_its_own() -> None:
    found = units.cut(DESIGN, 1)
    assert functions(found)["part0"][:4] == [
        "\tbool posedge_p_clk = this->posedge_p_clk();",
        "\tvalue<4> p_known;",
        "\tvalue<4> i_near;",
        "\tvalue<4> i_far;",
    ]
    assert "i_near" not in found.header


def test_what_runs_seldom_is_apart_and_clocks_and_feedback_are_found() -> None:
    found = units.cut(DESIGN, 1)
    assert (
        "p_top::reset" in found.seldom
        and "p_top::debug_eval" in found.seldom
        and 'extern "C"' in found.seldom
    )
    assert "p_top::eval" not in found.seldom and "p_top::reset" not in found.header
    assert found.clocks == 'ROSLET_CLOCK("clk", prev_p_clk)\n'
    assert not found.feedback
    fed = units.cut(DESIGN.replace("converged = true", "converged = false"), 1)
    assert fed.feedback and functions(fed)["eval"][-1] == "\treturn false;"
    looked_at = DESIGN.replace("p_known = i_near;", "p_known = p_clk;")
    assert units.cut(looked_at, 1).clocks == ""


@pytest.mark.parametrize(
    ("there", "instead"),
    [
        ("bool p_top::eval(", "bool p_other::eval("),
        ("}; // struct p_top", "};"),
        ("void p_top::reset() {", "void p_top::begin() {"),
        ("\tbool converged = true;\n", ""),
        ("\tp_known = i_near;", "\tconverged = p_cell.eval();"),
        ("\t\t}\n\t}\n", "\t\t}\n"),
    ],
)
def test_a_design_that_does_not_look_as_expected_is_refused(there: str, instead: str) -> None:
    assert there in DESIGN
    with pytest.raises(units.UnexpectedDesign, match="Yosys wrote a"):
        units.cut(DESIGN.replace(there, instead), 1)
