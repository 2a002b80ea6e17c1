"""Pareto fronts by hand; and their pictures and page."""

import random

import pytest

from meissner.tradeoff import page, pareto
from meissner.tradeoff.axis import Axis, Figure
from tradeoff import toy


@pytest.mark.parametrize(
    ("rows", "expected"),
    [
        ([(1, 5), (2, 3), (3, 3), (4, 1)], [True, True, False, True]),  # dominates despite a tie
        ([(2, 2), (2, 2), (1, 3), (3, 1)], [True] * 4),  # equal rows do not dominate
        ([(2, 2), (2, 2), (1, 2)], [False, False, True]),
        ([(1, None), (2, 2), (None, 0)], [False, True, False]),  # None: not measured
        ([(3,), (3,), (4,)], [True, True, False]),
        ([(1, 1, 9), (1, 1, 8), (0, 2, 9), (1, 2, 8)], [False, True, True, False]),
        ([], []),
    ],
)
def test_fronts_by_hand(rows, expected):
    assert pareto.front(rows) == expected


def test_fronts_of_many_rows_by_a_loop_over_pairs():
    """Small numbers, so that ties are frequent; a loop over all pairs gives the same front as
    pareto.front."""
    draw = random.Random(1)
    for width in (1, 2, 3, 4):
        rows = [tuple(draw.randrange(6) for _ in range(width)) for _ in range(150)]
        expected = []
        for row in rows:
            beaten = False
            for other in rows:
                no_worse = all(other[at] <= row[at] for at in range(width))
                beaten |= no_worse and other != row
            expected.append(not beaten)
        assert pareto.front(rows) == expected


def test_stairs_join_the_front_of_two_figures():
    assert pareto.stairs([(3, 1), (1, 4), (2, 4), (2, 2), (3, 1)]) == [(1, 4), (2, 2), (3, 1)]


def rows_of(points):
    """Rows of the toy axis: (number, price, wrong, front)."""
    for number, price, wrong, front in points:
        yield {
            "point": {"number": number},
            "cost": {"price": price},
            "error": {"wrong": wrong, "third": number / 3},
            "front": front,
            "shipped": number == 3,
        }


def test_the_table_has_the_front_and_what_ships():
    rows = list(rows_of([(1, 5, 2.0, True), (2, 7, 4.0, False), (3, 6, 3.0, False), (4, 9, 1.0, True)]))
    table = page.table(toy.AXES[0], rows)
    assert [row["number"] for row in table] == ["4", "1", "3"], "by the error"
    assert [row["ships"] for row in table] == ["", "", "yes"]
    assert table[2]["again"] == "meissner tradeoff --axis toy --point number=3"
    assert table[1]["price (€)"] == "5" and table[1]["wrong (%)"] == "2"
    text = page.verdict(toy.AXES[0], rows)
    assert text == (
        "4 points, 2 on the front; the shipped one is not: 1 point dominates it, for example "
        "meissner tradeoff --axis toy --point number=1"
    )


def test_points_that_differ_in_what_nobody_chooses_do_not_compete():
    from meissner.tradeoff import sweep

    axis = Axis(
        name="two",
        title="",
        about="",
        values={"side": (3, 5), "bits": (8, 9)},
        shipped={"side": 3, "bits": 8},
        apart=("side",),
        cost=lambda point: {"bits": point["bits"]},
        error=lambda point: {"wrong": 4 if point["side"] == 5 else 1},
        figures=(Figure("bits", "", judged=True), Figure("wrong", "", judged=True)),
    )
    tasks = sweep.tasks_of(axis)
    key = sweep._key
    found = {key(task): {"cost": axis.cost(task.point), "error": axis.error(task.point)} for task in tasks}
    rows = sweep._rows(axis, tasks, found)
    assert [(row["point"]["side"], row["point"]["bits"], row["front"]) for row in rows] == [
        *((3, 8, True), (3, 9, False)),
        *((5, 8, True), (5, 9, False)),
    ]


def test_a_page_with_a_picture_of_each_axis(tmp_path):
    rows = {"toy": list(rows_of([(1, 5, 2.0, True), (3, 6, 3.0, False), (4, 9, 1.0, True)]))}
    names = page.write(tmp_path, toy.AXES, rows, {"points": 3})
    assert names == ["toy.png", "report.html"]
    assert (tmp_path / "toy.png").read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
    text = (tmp_path / "report.html").read_text("utf-8")
    assert "meissner tradeoff --axis toy --point number=4" in text and "data:image/png;base64," in text
    assert "3 points on 1 axes" not in text and "3 points on 1 axis" in text
