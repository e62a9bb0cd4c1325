"""A page in Debian's Chromium: what it draws, and what it fails on."""

import json
import os
import re
import shutil
import subprocess
from html import unescape
from pathlib import Path

import pytest

_SECONDS = 120
_PROBE = """<script>
const errors = [];
addEventListener("error", (event) => errors.push(event.message));
addEventListener("unhandledrejection", (event) => errors.push(String(event.reason)));
const until = async (holds) => { while (!holds()) await new Promise((done) => setTimeout(done, 20)); };
addEventListener("load", async () => {
  const plots = () => [...document.querySelectorAll(".plot")], drawn = () => plots().filter((place) => place._fullLayout);
  await until(() => errors.length || document.body.dataset.shown);
  dispatchEvent(new Event("beforeprint"));
  await until(() => errors.length || drawn().length === plots().length);
  const first = drawn().find((place) => place.layout.xaxis.title.text === "t, s"), stretch = [2, 3];
  if (first) await Plotly.relayout(first, { "xaxis.range": stretch });
  const zoomed = () => drawn().filter((place) => String(place._fullLayout.xaxis.range) === String(stretch)).length;
  await new Promise((done) => setTimeout(done, 1000));
  document.body.dataset.found = JSON.stringify({ errors, plots: plots().length, drawn: drawn().length, zoomed: zoomed() });
});
</script></head>"""


def drawn(page: str, folder: Path) -> dict:
    """`errors` of the page's scripts; `plots` that it has places for, `drawn` ones, and those `zoomed` with the first.

    Where there is no Chromium the test is skipped; on CI it fails.
    """
    chromium = shutil.which("chromium")
    if chromium is None:
        assert "CI" not in os.environ, "chromium is missing: apt-get install chromium"
        pytest.skip("there is no chromium")
    path = folder / "page.html"
    path.write_text(page.replace("</head>", _PROBE, 1), encoding="utf-8")
    command = [chromium, "--headless", "--no-sandbox", "--disable-gpu", "--window-size=1300,1000"]
    command += [f"--user-data-dir={folder / 'profile'}", "--virtual-time-budget=60000", "--dump-dom", path.as_uri()]
    done = subprocess.run(command, capture_output=True, text=True, timeout=_SECONDS, check=True)
    found = re.search(r'data-found="([^"]*)"', done.stdout)
    assert found, "the page was never drawn"
    return json.loads(unescape(found.group(1)))
