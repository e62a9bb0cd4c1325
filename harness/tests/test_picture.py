"""The picture of a switching record, on a trace of a few samples."""

import pytest

from switchid_harness import picture
from switchid_harness.picture import Panel, Trace, draw, known_stretches, read_trace


def test_an_instant_and_a_value_lie_where_the_axes_say():
    panel = Panel(top=100.0, height=50.0, low=-1.0, high=3.0, end=10.0)
    assert panel.x(0.0) == picture.LEFT and panel.x(10.0) == picture.WIDTH - picture.RIGHT
    assert panel.y(-1.0) == 150.0 and panel.y(0.0) == 137.5 and panel.y(9.0) == 100.0


def test_a_level_stretch_is_drawn_by_its_ends():
    panel = Panel(top=0.0, height=10.0, low=0.0, high=10.0, end=5.0)
    level = panel.points([(0.0, 1.0), (1.0, 1.0), (2.0, 1.0), (3.0, 4.0), (4.0, 4.0)])
    assert [point.split(",")[1] for point in level.split()] == ["9.0", "9.0", "6.0", "6.0"]


def test_nothing_is_drawn_where_a_coefficient_is_not_known():
    known = known_stretches([0.0, 1.0, 2.0, 3.0, 4.0], [(1.0, 0.1), (2.0, 0.2), None, (3.0, 0.3), (4.0, 0.4)])
    assert known == [[(0.0, 1.0, 0.1), (1.0, 2.0, 0.2)], [(3.0, 3.0, 0.3), (4.0, 4.0, 0.4)]]


def test_a_trace_gives_coefficients_and_every_alarm(tmp_path, monkeypatch):
    monkeypatch.setattr(picture, "STRIDE", 2)
    path = tmp_path / "trace.csv"
    head = "t,coef.q_3,std.q_3,switch.count,switch.detection_time"
    path.write_text("\n".join([head, "0,1.5,1e30,0,0", "1,1.5,0.2,1,1", "2,2.5,0.25,1,1", "3,2,0.1,2,3", ""]))
    trace = read_trace(path, ["q^3"])
    assert trace.t == [0.0, 2.0] and trace.alarms == [1.0, 3.0]
    assert trace.coefficients == {"q^3": [None, (2.5, 0.25)]}


@pytest.mark.parametrize("alarm, words", [(12.25, "+250 ms"), (4.0, "false")])
def test_an_alarm_is_marked_with_its_delay(alarm, words):
    stages = [
        {"start": 0.0, "end": 12.0, "coefficients": {"q": 4.0}},
        {"start": 12.0, "end": 20.0, "coefficients": {"q": 5.0}},
    ]
    trace = Trace([0.0, 20.0], {"q": [(4.0, 0.1), (4.0, 0.1)]}, [alarm])
    svg = draw([(0.0, -0.5), (20.0, 1.0)], {"stages": stages, "switch_times": [12.0]}, trace)
    assert words in svg and svg.startswith("<svg")
