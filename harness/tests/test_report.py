"""The page: self-contained, complete, and faithful to its traces."""

import base64
import json
import re
import zlib

import numpy as np
import pytest
from browser import drawn
from fake import TERMS, FakePlant, Puppet
from plotly.offline import get_plotlyjs, get_plotlyjs_version

from switchid_harness import scenarios
from switchid_harness.report.equations import digits, equation, power
from switchid_harness.report.page import page
from switchid_harness.report.run_views import run_views
from switchid_harness.report.store import grid, pack
from switchid_harness.run import evaluate
from switchid_harness.stepping import step_together


def unpack(text: str, traces: int) -> np.ndarray:
    planes = np.frombuffer(zlib.decompress(base64.b64decode(text)), np.uint8).reshape(traces, 4, -1)
    return np.ascontiguousarray(planes.transpose(0, 2, 1)).view("<f4")[..., 0]


@pytest.fixture(scope="module")
def results():
    scenario = scenarios.publication_cases()[0]
    identifiers = {"default": Puppet(scenario, 0.2, 0.1, 1e-7), "publication": Puppet(scenario, 0.4, 0.5, 1e-3, (7.3,))}
    run = evaluate(scenario, step_together(FakePlant(scenario), identifiers, TERMS, scenario.end), TERMS)
    return [(run.figures, run_views(run))]


def test_packed_traces_keep_four_digits_and_gaps():
    values = np.array([[1.0, -2.34567e-9, np.nan, 1.23456e7], [0.0, 5.4321, -1.0, 1e30]])
    assert unpack(pack(list(values)), 2) == pytest.approx(values, rel=1e-4, nan_ok=True)


def test_the_grid_is_denser_after_switches_and_inside_the_record():
    kept = grid(80_000, [16_000, 79_900])
    assert kept[0] == 0 and kept[-1] == 79_999 and len(np.unique(kept)) == len(kept)
    assert np.diff(kept[(kept > 16_000) & (kept < 17_000)]).max() <= 5
    assert np.diff(kept[(kept > 30_000) & (kept < 31_000)]).max() > 20


def test_the_page_loads_nothing_from_elsewhere(results):
    text = page(1, results, []).replace(get_plotlyjs(), "")
    assert not re.search(r'(src|href)\s*=\s*"|@import|url\((?!#)', text)
    assert "http" not in re.sub(r"data-[^<]*</script>", "", text)


def test_the_page_holds_every_run_with_traces_of_one_length(results):
    text = page(1, results, [])
    figures, traces = results[0]
    meta = json.loads(re.search(rf'id="meta-{re.escape(figures["id"])}">(.*?)</script>', text).group(1))
    found = unpack(traces["data"], len(meta["names"]))
    assert found.shape == (len(meta["names"]), meta["points"])
    q = dict(zip(meta["names"], found))["default.coef.q_3"]
    assert q[-1] == pytest.approx(2.0, rel=1e-3)
    assert "<!--" not in re.sub(r"<!doctype html>", "", text)


def named_traces(panel: dict) -> set[str]:
    """Names of the store's traces that a panel's layers are drawn from."""
    contents = [content for layer in panel["layers"] for content in layer.values()]
    points = [content.get("points", content.get("edges")) for content in contents]
    return {name for found in points if isinstance(found, dict) for name in found.values() if isinstance(name, str)}


def test_every_panel_names_traces_that_the_page_has(results):
    views = results[0][1]["views"]
    assert set(views) == {"state", "prediction", "portraits", "coefficients", "error", "deviation"}
    named = set().union(*(named_traces(panel) for panels in views.values() for panel in panels))
    assert named == set(results[0][1]["names"])


def test_coefficients_are_drawn_about_the_true_ones_with_switches_and_false_alarms(results):
    figures, described = results[0]
    stiffness = next(panel for panel in described["views"]["coefficients"] if "q³" in panel["y"]["label"])
    layers = [layer for layer in stiffness["layers"] if "band" not in layer]
    assert [next(iter(layer)) for layer in layers] == ["reference", "area", "line", "line"]
    assert {value for _, value in layers[0]["reference"]["points"]} == {2.0}
    low, high = stiffness["y"]["range"]
    assert low < 2.0 < high
    assert sum("band" in layer for layer in stiffness["layers"]) == len(figures["stages"])
    published = described["views"]["deviation"][1]
    assert "1 false alarm" in published["title"]
    assert [layer["mark"]["at"] for layer in published["layers"] if "mark" in layer] == [pytest.approx(7.3, abs=2e-3)]


def test_a_browser_draws_every_panel_and_zooms_them_together(results, tmp_path):
    found = drawn(page(1, results, []), tmp_path)
    panels = sum(len(panels) for panels in results[0][1]["views"].values())
    assert found["errors"] == [] and found["plots"] == found["drawn"] == panels
    # one stretch in every panel over time, the status's among them
    assert found["zoomed"] == panels - len(results[0][1]["views"]["portraits"])


def test_both_pages_hold_the_same_plotly():
    assert get_plotlyjs_version() == "3.0.1", "tests/page.rs names the version of the Rust crate's page"


def test_report_json_has_no_nan(results):
    json.dumps(results[0][0], allow_nan=False)


def test_laws_are_written_with_the_digits_their_std_supports():
    text = re.sub(
        r"<[^>]+>", "", equation({"q": 4.0123, "qdd": 1.00042, "qd": -0.3, "q_3": 0.0}, {"qdd": 1e-5, "q": 0.2})
    )
    assert text == "1.00042\u2009q̈ − 0.3000\u2009q̇ + 4.01\u2009q = F"


def test_no_coefficient_is_no_law():
    assert "no law" in equation({"q": 0.0, "qdd": 0.0}, {})


def test_numbers():
    assert digits(0.0, None) == "0" and digits(123.456, 0.5) == "123.5"
    assert power(0.0314) == "0.031" and power(1.0) == "1" and power(-172.0) == "−170"
    assert power(1.04e-14) == "1.0 · 10<sup>−14</sup>" and power(None) == "–"
