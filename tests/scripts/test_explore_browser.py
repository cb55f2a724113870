"""The explorer's page in a real browser: it loads without complaint, and hover, click and sliders do what they say."""

from __future__ import annotations

import re
import shutil
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import IO, Any

import numpy as np
import pytest

from compare.files import save_system
from floquet import StabilityChart, monodromy
from floquet_scripts import explore
from periodic.examples import coupled_mathieu
from plate import MovingPlate
from tests.paths import ROOT

pytest.importorskip("bokeh", reason="the page needs bokeh: pip install 'floquet-charts[explore]'")
webdriver = pytest.importorskip("selenium.webdriver", reason="browser tests need selenium")
Keys = webdriver.Keys
CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
DRIVER = shutil.which("chromedriver")
pytestmark = pytest.mark.skipif(not (CHROMIUM and DRIVER), reason="browser tests need chromium and chromedriver")

SLIDERS = ["speed", "tension", "damping", "width", "aspect_ratio", "harmonics"]
# The server as its command starts it, but for the resolutions: the last two take most of its time.
SERVER = """
import sys
from compare.explorer import live
from floquet_scripts import explore
live.LIVE_RESOLUTIONS = live.LIVE_RESOLUTIONS[:3]
sys.exit(explore.main())
"""
FINEST = "96 × 48 points"
SYSTEM = coupled_mathieu(damping=(0.02, 0.05))
PLATE = """
title = "small plate"
[plate]
axial_terms = 2
lateral_terms = 2
[chart]
Omega = [10.0, 40.0]
eps = 0.5
"""
MODEL = "Bokeh.documents[0].get_model_by_name(arguments[0])"
# Bokeh draws inside shadow roots, which no selector of WebDriver's looks into.
FIND = """
const found = []
const walk = (root) => root.querySelectorAll("*").forEach((element) => {
  if (element.matches(arguments[0])) found.push(element)
  if (element.shadowRoot) walk(element.shadowRoot)
})
walk(document)
return found
"""


class Browser:
    """A page under test: its models by name, and a pointer that knows the chart's coordinates."""

    def __init__(self, driver: Any, address: str) -> None:
        self.driver = driver
        driver.get(address)
        self.wait(lambda: driver.execute_script("return !!window.Bokeh && Bokeh.documents.length > 0"))

    def wait(self, condition: Callable[[], Any], seconds: float = 60.0) -> Any:
        deadline = time.monotonic() + seconds
        while not (result := condition()):
            assert time.monotonic() < deadline, f"nothing happened within {seconds} s; {self.complaints()}"
            time.sleep(0.05)
        return result

    def get(self, name: str, what: str) -> Any:
        return self.driver.execute_script(f"return {MODEL}.{what}", name)

    def data(self, name: str, column: str) -> Any:
        return self.driver.execute_script(f"return Array.from({MODEL}.data[arguments[1]])", name, column)

    def text(self, name: str) -> str:
        return re.sub("<[^>]*>", " ", self.get(name, "text"))

    def find(self, selector: str) -> list[Any]:
        return self.driver.execute_script(FIND, selector)

    def point_at(self, Omega: float, eps: float) -> Any:
        """Return an action chain that has moved the pointer to a place of the chart."""
        x, y, width, height = self.driver.execute_script(
            f"""const view = Bokeh.index.find_one({MODEL})
            return [view.frame.x_scale.compute(arguments[1]), view.frame.y_scale.compute(arguments[2]),
                    view.canvas_view.el.clientWidth, view.canvas_view.el.clientHeight]""",
            "chart",
            Omega,
            eps,
        )
        canvas = self.find(".bk-Canvas")[0]
        actions = webdriver.ActionChains(self.driver)
        return actions.move_to_element_with_offset(canvas, round(x - width / 2), round(y - height / 2))

    def complaints(self) -> list[str]:
        return [entry["message"] for entry in self.driver.get_log("browser") if entry["level"] in ("SEVERE", "WARNING")]


@pytest.fixture(scope="module")
def driver(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    options = webdriver.ChromeOptions()
    options.binary_location = CHROMIUM
    for argument in (
        "--headless",
        "--no-sandbox",
        "--disable-gpu",
        "--disable-quic",
        "--no-first-run",
        "--disable-background-networking",
        "--disable-component-update",
        "--disable-sync",
        "--window-size=1400,900",
        f"--user-data-dir={tmp_path_factory.mktemp('profile')}",
    ):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    chrome = webdriver.Chrome(options=options, service=webdriver.ChromeService(DRIVER))
    yield chrome
    chrome.quit()


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("page")
    save_system(folder / "pair.npz", SYSTEM)
    arguments = ["--system", folder / "pair.npz", "--Omega", 1.5, 4.5, "--eps", 1.0, "--points", 48, 24, "--html"]
    assert explore.main([*map(str, arguments), "--output", str(folder / "out"), "--no-progress", "--jobs", "1"]) == 0
    return folder / "out"


@pytest.fixture
def page(driver: Any, folder: Path) -> Iterator[Browser]:
    browser = Browser(driver, (folder / "pair.html").as_uri())
    browser.wait(lambda: browser.data("solution", "w"))
    yield browser
    assert browser.complaints() == []


def test_the_file_needs_nothing_from_anywhere(page: Browser) -> None:
    assert page.driver.execute_script("return performance.getEntriesByType('resource').map((e) => e.name)") == []


def test_it_opens_at_the_fastest_growing_point(page: Browser, folder: Path) -> None:
    chart = StabilityChart.load(folder / "pair.npz")
    row, column = np.unravel_index(chart.growth_rate.argmax(), chart.growth_rate.shape)
    assert f"Ω = {chart.Omega[column]:.6g}".rstrip("0") in page.text("facts")
    assert f"ε = {chart.eps[row]:.5g}" in page.text("facts")


def test_the_pointer_tells_the_numbers_of_its_cell(page: Browser, folder: Path) -> None:
    chart = StabilityChart.load(folder / "pair.npz")
    row, column = 18, 19  # not the middle of anything
    step = chart.Omega[1] - chart.Omega[0]
    page.point_at(chart.Omega[column] + 0.2 * step, chart.eps[row]).perform()
    tooltip = page.wait(lambda: [element.text for element in page.find(".bk-Tooltip") if "growth" in element.text])[0]
    shown = dict(re.findall(r"(.+?):\s*(.+)", tooltip))
    assert float(shown["Ω"]) == pytest.approx(chart.Omega[column], rel=1e-5)
    assert float(shown["ε"]) == pytest.approx(chart.eps[row], rel=1e-5)
    # four-byte numbers, five digits
    assert float(shown["growth rate"]) == pytest.approx(chart.growth_rate[row, column], rel=1e-4)
    assert float(shown["error of log|μ|"]) == pytest.approx(chart.error[row, column], rel=0.05)
    assert shown["verdict"].startswith("unstable" if chart.kind[row, column] > 0 else "stable")


def _number(name: str, text: str) -> float:
    """Return the number that follows ``name = `` in a text of the page."""
    found = re.search(rf"{name} = ([\d.]+)", text)
    assert found is not None, text
    return float(found[1])


def _served(output: IO[str]) -> str:
    """Return the address that the server says; it may say before that it compiles."""
    for line in output:
        if found := re.search(r"http://127\.0\.0\.1:\d+/", line):
            return found[0]
    raise AssertionError("the server ended without an address")


def test_a_click_shows_multipliers_and_growing_solution(page: Browser) -> None:
    before = page.text("facts")
    page.point_at(2.75, 0.6).click().perform()
    page.wait(lambda: page.text("facts") != before)
    Omega, eps = (_number(name, page.text("facts")) for name in ("Ω", "ε"))
    assert abs(Omega - 2.75) < 0.1  # a block of the chart is 3 / 32 wide and 1 / 16 high
    assert abs(eps - 0.6) < 0.0625
    expected = monodromy(SYSTEM, Omega, eps)
    np.testing.assert_allclose(page.data("multipliers", "modulus"), np.abs(expected.multipliers), rtol=1e-4)

    # The solution is multiplied by mu in every period; on the asinh scale w = 2 sinh(y ln 10).
    samples = 2 * np.sinh(np.log(10) * np.array(page.data("solution", "w"))).reshape(10, -1)
    assert np.abs(samples[0]).max() == pytest.approx(1.0, abs=0.35)  # the phase of a complex pair decides
    envelope = np.sqrt((samples**2).sum(axis=1))
    growth = np.polyfit(np.arange(10), np.log(envelope), 1)[0]
    assert growth == pytest.approx(np.log(np.abs(expected.multipliers[0])), abs=0.03)


def test_the_legend_switches_boundaries_curves_and_labels(page: Browser) -> None:
    def visible() -> list[bool]:
        return page.get("chart", "above[0].items.map((item) => item.renderers[0].visible)")

    def click(name: str) -> None:
        next(element for element in page.find(".bk-item") if element.text == name).click()

    assert all(visible())

    def shows(number: int, wanted: bool) -> bool:
        return visible()[number] is wanted

    for number, name in enumerate(("Floquet boundary (traced)", "multiple scales, order 1", "region labels")):
        for wanted in (False, True):
            click(name)
            page.wait(partial(shows, number, wanted))


def test_colours_by_kind_of_instability(page: Browser) -> None:
    def visible() -> list[bool]:
        return page.get("chart", "renderers.filter((r) => r.glyph.type === 'Image').map((r) => r.visible)")

    assert visible() == [True, False]
    next(element for element in page.find(".bk-btn") if element.text == "kind of instability").click()
    page.wait(lambda: visible() == [False, True])


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    case = tmp_path_factory.mktemp("case") / "small.toml"
    case.write_text(PLATE, encoding="utf-8")
    command = [sys.executable, "-c", SERVER, "--case", str(case), "--serve", "--port", "0"]
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as server:
        assert server.stdout is not None
        try:
            yield _served(server.stdout)
        finally:
            server.terminate()
            left = server.stdout.read()
    assert "Traceback" not in left


@pytest.fixture
def live(driver: Any, address: str) -> Iterator[Browser]:
    browser = Browser(driver, address)
    browser.wait(lambda: FINEST in browser.text("message"))
    yield browser
    assert browser.complaints() == []


def _press(page: Browser, slider: str, key: str) -> None:
    page.find(".noUi-handle")[SLIDERS.index(slider)].send_keys(key)


def _chart(page: Browser) -> list[float]:
    return page.driver.execute_script(f"return Array.from({MODEL}.data.rate[0])", "cells")


def _differs(page: Browser, before: list[float]) -> bool:
    return _chart(page) != before


def _moved(page: Browser, slider: str, before: Any) -> bool:
    return bool(page.get(slider, "value") != before)


@pytest.mark.slow
def test_every_slider_changes_the_chart(live: Browser) -> None:
    for slider in SLIDERS:
        if slider == "harmonics":  # a cosine has but one
            before = _chart(live)
            live.driver.execute_script(f"{MODEL}.value = 'sawtooth'", "waveform")
            live.wait(partial(_differs, live, before))
            live.wait(lambda: FINEST in live.text("message"))
        before, value = _chart(live), live.get(slider, "value")
        _press(live, slider, Keys.ARROW_LEFT if slider == "width" else Keys.ARROW_RIGHT)
        live.wait(partial(_moved, live, slider, value))
        live.wait(partial(_differs, live, before))
        live.wait(lambda: FINEST in live.text("message"))  # refined when idle


def test_a_wrong_value_is_a_sentence_and_the_next_right_one_a_chart(live: Browser) -> None:
    before = _chart(live)
    _press(live, "speed", Keys.END)
    live.wait(lambda: "divergence speed" in live.text("message"))
    assert "last valid result" in live.text("message")
    assert _chart(live) == before
    _press(live, "speed", Keys.HOME)
    live.wait(lambda: "points" in live.text("message"))
    assert _chart(live) != before


def test_a_click_is_computed_on_the_server(live: Browser) -> None:
    live.point_at(25.3, 0.31).click().perform()
    live.wait(lambda: "Ω = 25." in live.text("facts"))
    Omega, eps = (_number(name, live.text("facts")) for name in ("Ω", "ε"))
    assert (Omega, eps) == (pytest.approx(25.3, abs=0.05), pytest.approx(0.31, abs=0.002))  # a pixel
    expected = monodromy(MovingPlate(axial_terms=2, lateral_terms=2), Omega, eps)
    np.testing.assert_allclose(live.data("multipliers", "modulus"), np.abs(expected.multipliers), rtol=1e-4)


def test_zooming_computes_the_window_that_is_seen(live: Browser) -> None:
    live.point_at(15.0, 0.4).click_and_hold().perform()
    live.point_at(20.0, 0.1).release().perform()
    live.wait(lambda: live.get("chart", "x_range.end") < 21)
    live.wait(lambda: live.data("cells", "x")[0] + live.data("cells", "dw")[0] < 21)
    assert live.data("cells", "x")[0] == pytest.approx(15.0, abs=0.5)
    assert live.data("cells", "y")[0] == pytest.approx(0.1, abs=0.05)


@pytest.mark.skipif(sys.platform != "linux", reason="only there 127.0.0.2 is this machine too")
def test_it_is_served_on_this_machine_alone(address: str) -> None:
    port = int(address.rstrip("/").rsplit(":", 1)[1])
    socket.create_connection(("127.0.0.1", port), timeout=5).close()
    with pytest.raises(ConnectionRefusedError):
        socket.create_connection(("127.0.0.2", port), timeout=5)
