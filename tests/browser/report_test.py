#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The HTML report as a reader meets it: reports that batten writes are opened in a headless Chromium.

    report_test.py BATTEN SOURCE WORK

BATTEN is the program, SOURCE the project, WORK a folder for reports and pictures. Exit code 77 (ctest:
skipped) where chromedriver is missing. WebGL is drawn by software: webdriver.SOFTWARE_GL."""
import math
import os
import re
import subprocess
import sys
import time
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import webdriver  # noqa: E402

READY_SECONDS = 2.0  # of the page's own main thread, so that a busy machine does not count
SKIPPED = 77

# Of a drawing: how many of its pixels are not white, and a sum that changes with any pixel.
SUMMARY = """
  const p = battenReport.pixels();
  let inked = 0, hash = 2166136261;
  for (let i = 0; i < p.data.length; i += 4) {
    if (p.data[i] < 250 || p.data[i + 1] < 250 || p.data[i + 2] < 250) ++inked;
    hash = Math.imul(hash ^ (p.data[i] | p.data[i + 1] << 8 | p.data[i + 2] << 16), 16777619);
  }
  return { inked: inked / (p.width * p.height), hash, width: p.width, height: p.height };"""


def curve_points(path):
    """An ellipse with a bump and a little ripple that stands for noise."""
    with open(path, "w") as file:
        for i in range(240):
            t = 2 * math.pi * (i + 0.5) / 240
            r = 1 + 0.08 * math.exp(-8 * (t - 2) ** 2) + 0.0008 * math.sin(97 * t)
            file.write(f"{60 * r * math.cos(t):.6f} {35 * r * math.sin(t):.6f}\n")


def helix_points(path):
    with open(path, "w") as file:
        for i in range(300):
            t = i / 299
            file.write(f"{30 * math.cos(9 * t):.6f} {30 * math.sin(9 * t):.6f} {40 * t + 0.01 * math.sin(211 * t):.6f}\n")


def two_sheets(path):
    with open(path, "w") as file:
        for x0, count in ((0, 40), (100, 20)):
            for i in range(count):
                for j in range(count):
                    x, y = i + 0.3 * math.sin(7 * j), j + 0.3 * math.sin(5 * i)
                    file.write(f"{x0 + x:.6f} {y:.6f} {0.01 * x * x + 0.002 * math.sin(97 * i + 31 * j):.6f}\n")


class ReportTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        batten, source, work = ARGUMENTS
        os.makedirs(work, exist_ok=True)
        cls.work = work
        curve_points(os.path.join(work, "oval.xy"))
        helix_points(os.path.join(work, "helix.xyz"))
        two_sheets(os.path.join(work, "sheets.xyz"))
        panel = os.path.join(source, "data/panel.ply")

        def run(*arguments):
            done = subprocess.run([batten, *arguments, "--quiet"], cwd=work, stderr=subprocess.PIPE, text=True, timeout=200)
            if done.returncode not in (0, 3):
                raise AssertionError(f"batten {' '.join(arguments)}: {done.stderr}")

        run("fit", "surface", panel, "-o", "panel.step", "--tolerance", "0.3", "--report", "panel.html")
        run("fit", "curve", "oval.xy", "-o", "oval.step", "--report", "oval.html")
        run("fit", "curve", "helix.xyz", "-o", "helix.step", "--tolerance", "0.0001", "--report", "helix.html")
        run("compare", "panel.step", panel, "--report", "compare.html")
        run("fit", "surface", panel, "-o", "sigma.json", "--uncertainty", "--certify", "--report", "sigma.html")
        run("make", "sphere", "-o", "ball.json", "--radius", "20")
        run("sample", "ball.json", "-o", "ball.xyz", "--count", "800", "--noise", "0.01")
        run("fit", "primitive", "ball.xyz", "-o", "form.json", "--kind", "sphere", "--report", "form.html")
        run("compare", "ball.json", "ball.xyz", "--align", "best", "--profile", "0.01", "--report", "profile.html")
        run("fit", "surface", "sheets.xyz", "-o", "sheet.step", "--part", "1", "--report", "part.html")
        run("fit", "surface", "sheets.xyz", "-o", "sheets.step", "--part", "all", "--report", "parts.html")
        run("fit", "surface", panel, "-o", "coarse.step", "--control-points", "6,5", "--trim", "none", "--accept-doubt", "--report", "pair.html",
            "--beside", "panel.html")
        run("fit", "curve", "helix.xyz", "-o", "again.step", "--report", "mixed.html", "--beside", "panel.html")
        run("fit", "curve", "oval.xy", "-o", "loose.step", "--control-points", "7", "--report", "ovals.html", "--beside", "oval.html")
        cls.browser = webdriver.Browser()

    @classmethod
    def tearDownClass(cls):
        cls.browser.__exit__()

    # The window is small where its size does not matter: software draws every pixel of it.
    def open(self, name, width=880, height=620, browser=None):
        browser = browser or self.browser
        browser.resize(width, height)
        browser.console()
        browser.open(os.path.join(self.work, name))
        browser.wait_for("document.documentElement.dataset.battenReady", 60)

    def summary(self):
        return self.browser.run(SUMMARY)

    def assert_calm(self, browser=None):
        loud = [m for level, m in (browser or self.browser).console() if level in ("SEVERE", "WARNING")]
        self.assertEqual(loud, [], "the console is silent")

    def assert_within_the_page(self):
        wide = self.browser.run("""
          const w = document.documentElement.clientWidth;
          return [document.documentElement.scrollWidth - w,
                  [...document.querySelectorAll("main *")].filter((e) => !e.closest("svg, details") &&
                    e.getBoundingClientRect().right > w + 1).map((e) => e.tagName + "." + e.className)];""")
        self.assertLessEqual(wide[0], 0, "nothing to scroll sideways")
        self.assertEqual(wide[1], [], "nothing reaches beyond the page")

    def test_a_surface_is_drawn_without_a_word_on_the_console(self):
        self.open("panel.html")
        s = self.summary()
        self.assertGreater(s["inked"], 0.15, "the panel fills a good part of the view")
        self.assertLess(s["inked"], 0.9, "around it is white paper")
        self.browser.screenshot(os.path.join(self.work, "panel.png"))
        self.assert_calm()

    def test_it_is_ready_within_two_seconds(self):
        self.browser.devtools("Performance.enable", timeDomain="threadTicks")
        for name in ("panel.html", "oval.html"):
            self.open(name, 1440, 900)
            metrics = {m["name"]: m["value"] for m in self.browser.devtools("Performance.getMetrics")["metrics"]}
            wall = int(self.browser.run("return document.documentElement.dataset.battenReady"))
            print(f"{name}: {metrics['TaskDuration']:.2f} s of the main thread, ready after {wall} ms", flush=True)
            self.assertLess(metrics["TaskDuration"], READY_SECONDS)
        self.browser.devtools("Performance.disable")

    def test_every_mode_and_layer_changes_the_drawing(self):
        for name, hidden in (("panel.html", {"outliers", "cloud", "knots", "net"}), ("helix.html", {"knots", "net"})):
            self.open(name)
            seen = {self.summary()["hash"]}
            modes = self.browser.run("return battenReport.modes")
            for mode in modes[1:]:
                self.assertTrue(self.browser.run("return battenReport.setMode(arguments[0])", mode))
                found = self.summary()["hash"]
                self.assertNotIn(found, seen, f"{name}: {mode} looks like none before")
                seen.add(found)
            if modes:
                self.browser.run("battenReport.setMode('deviation')")
            layers = self.browser.run("return battenReport.layers")
            self.assertTrue(hidden <= set(layers), f"{name} has {layers}")
            for layer in layers:
                before = self.summary()["hash"]
                self.assertTrue(self.browser.run("return battenReport.setLayer(arguments[0], arguments[1])", layer, layer in hidden))
                self.assertNotEqual(self.summary()["hash"], before, f"{name}: {layer} is seen")
                self.browser.run("battenReport.setLayer(arguments[0], arguments[1])", layer, layer not in hidden)
                self.assertEqual(self.summary()["hash"], before, f"{name}: {layer} leaves nothing behind")
            self.assertFalse(self.browser.run("return battenReport.setLayer('nonsense', true)"))
            self.assert_calm()

    def test_the_buttons_do_what_the_script_does(self):
        self.open("panel.html")
        before = self.summary()["hash"]
        self.browser.run("document.querySelector('[data-name=zebra]').click()")
        zebra = self.summary()["hash"]
        self.assertNotEqual(zebra, before)
        self.browser.run("document.querySelector('[data-name=deviation]').click()")
        self.assertEqual(self.summary()["hash"], before)
        self.browser.run("document.querySelector('input[data-layer=net]').click()")
        self.assertNotEqual(self.summary()["hash"], before)

    def test_a_smaller_range_of_colours_moves_the_legend_and_the_drawing(self):
        self.open("panel.html")
        legend = "return document.querySelector('.legend').textContent"
        before, words = self.summary()["hash"], self.browser.run(legend)
        self.assertIn("+0.3 tol.", words)
        self.browser.run("battenReport.setLimit(0.1)")
        self.assertNotEqual(self.summary()["hash"], before)
        self.assertNotIn("tol.", self.browser.run(legend), "the tolerance lies beyond the range")

    def test_dragging_turns_and_the_reset_button_returns(self):
        self.open("panel.html", 1440, 900)
        before = self.summary()["hash"]
        box = self.browser.run("const r = document.querySelector('canvas').getBoundingClientRect(); return [r.x, r.y, r.width, r.height]")
        x, y = box[0] + box[2] / 2, box[1] + box[3] / 2
        self.browser.pointer(("move", x, y), ("down",), ("move", x + 120, y + 40), ("up",))
        self.assertNotEqual(self.summary()["hash"], before)
        self.browser.run("[...document.querySelectorAll('.looks button')].find((b) => b.textContent === 'Reset').click()")
        self.assertEqual(self.summary()["hash"], before)

    def test_one_finger_turns_and_two_move_and_zoom(self):
        self.open("panel.html", 390, 844)
        self.browser.devtools("Emulation.setTouchEmulationEnabled", enabled=True, maxTouchPoints=2)
        start = self.summary()
        x, y, w, h = self.browser.run("const r = document.querySelector('canvas').getBoundingClientRect(); return [r.x, r.y, r.width, r.height]")
        if y + h > 844:
            self.browser.run("window.scrollTo(0, arguments[0])", y - 100)
            y = self.browser.run("return document.querySelector('canvas').getBoundingClientRect().y")
        x, y = x + w / 2, y + h / 2
        scrolled = self.browser.run("return window.scrollY")
        self.browser.touch([(x, y)], [(x + 20, y + 5)], [(x + 60, y + 30)])
        turned = self.summary()
        self.assertNotEqual(turned["hash"], start["hash"], "one finger turns")
        near, far = [(x - 20, y), (x + 20, y)], [(x - 60, y), (x + 60, y)]
        self.browser.touch([near[0]], near, [(x - 40, y), (x + 40, y)], far)
        self.assertGreater(self.summary()["inked"], turned["inked"], "two fingers that part come nearer")
        self.browser.touch([far[0]], far, near)
        self.browser.touch([far[0]], far, near)
        self.assertLess(self.summary()["inked"], turned["inked"], "two that meet go away")
        self.assertEqual(self.browser.run("return window.scrollY"), scrolled, "the page stays where it is")
        self.browser.run("[...document.querySelectorAll('.looks button')].find((b) => b.textContent === 'Reset').click()")
        self.assertEqual(self.summary()["hash"], start["hash"])
        self.browser.devtools("Emulation.setTouchEmulationEnabled", enabled=False)
        self.assert_calm()

    def test_the_pointer_reads_coordinates_of_the_world_and_the_deviation(self):
        self.open("panel.html", 1440, 900)
        self.browser.run("battenReport.setView('z'); battenReport.renderNow()")
        box = self.browser.run("const r = document.querySelector('canvas').getBoundingClientRect(); return [r.x, r.y, r.width, r.height]")
        self.browser.pointer(("move", box[0] + 0.42 * box[2], box[1] + box[3] / 2))
        self.browser.wait_for("!document.querySelector('.label').hidden")
        words = self.browser.run("return document.querySelector('.label').innerText").replace("\u2212", "-")
        self.assertRegex(words, r"deviation [+-]?0\.\d+")
        x, y = (float(re.search(axis + r" (-?[\d.]+)", words).group(1)) for axis in "xy")
        # The panel is 800 by 500 and begins at zero; the place is a little left of its middle.
        self.assertTrue(200 < x < 400, words)
        self.assertTrue(200 < y < 300, words)

    def test_the_words_and_figures_are_those_of_the_report(self):
        self.open("panel.html")
        report = self.browser.run("return JSON.parse(document.getElementById('batten-data').textContent).report")
        text = self.browser.run("return document.querySelector('main').innerText").replace("\u202f", " ").replace("\u2009", " ")
        self.assertIn("Tolerance reached", text)
        self.assertIn(f"{report['error']['rms']:.3f}", text)
        self.assertIn(f"{report['error']['max']:.3f}", text)
        self.assertIn(report["command"], text)
        n, m = report["geometry"]["control_points"]
        self.assertIn(f"{n} \u00d7 {m}", text)
        for warning in report["warnings"]:
            self.assertIn(warning, text)
        for title in ("Distribution of deviations", "Convergence", "Deviations", "Points", "Geometry", "Run", "Command"):
            self.assertIn(title, text)
        self.assertNotIn("NaN", text)
        self.assertNotIn("undefined", text)

    def test_every_figure_has_a_value(self):
        for name in ("panel.html", "oval.html", "helix.html", "compare.html", "part.html", "parts.html"):
            self.open(name)
            text = self.browser.run("return document.querySelector('main').textContent")
            self.assertIsNone(re.search(r"undefined|NaN|null|Infinity|\[object", text), name)

    def test_checks_beside_the_distances_are_told(self):
        for name, verdict, titles in (
            ("sigma.html", "No tolerance", ("Standard deviations along the normal", "Proved")),
            ("form.html", "No tolerance", ("Sphericity",)),
            ("profile.html", "Does not conform", ("Profile tolerance", "Alignment of the points")),
        ):
            self.open(name)
            text = self.browser.run("return document.querySelector('main').innerText")
            for title in titles:
                self.assertIn(title, text, name)
            self.assertIn(verdict, self.browser.run("return document.querySelector('.verdict').innerText"), name)
            self.assertIsNone(re.search(r"undefined|NaN|null|Infinity|\[object", text), name)
            self.assert_calm()

    def test_standard_deviations_colour_the_surface(self):
        self.open("sigma.html")
        before = self.summary()["hash"]
        self.assertTrue(self.browser.run("return battenReport.setMode('sigma')"))
        self.assertNotEqual(self.summary()["hash"], before)
        self.assertIn("std. deviation", self.browser.run("return document.querySelector('.legend').textContent"))
        self.browser.screenshot(os.path.join(self.work, "sigma.png"))
        self.assert_calm()

    def test_parts_of_the_cloud_and_of_the_geometry_are_told_apart(self):
        tables = """return [...document.querySelectorAll("section")].filter((s) => s.querySelector("h2")).map((s) =>
          [s.querySelector("h2").textContent, [...s.querySelectorAll("tbody tr")].map((r) => [...r.children].map((c) => c.textContent))])"""
        for name, used in (("part.html", ["yes", "no"]), ("parts.html", ["yes", "yes"])):
            self.open(name)
            found = dict(self.browser.run(tables))
            cloud = found["Parts of the cloud"]
            self.assertEqual([row[-1] for row in cloud], used, name)
            self.assertEqual([int(re.sub(r"\D", "", row[1])) for row in cloud], [1600, 400], name)
            self.assertNotIn("Parts", found, "no errors by geometry where none are told")

    def test_the_histogram_has_a_bar_for_every_count_and_lines_at_the_tolerance(self):
        self.open("panel.html")
        counts = self.browser.run("return JSON.parse(document.getElementById('batten-data').textContent).histogram.counts")
        self.assertEqual(self.browser.run("return document.querySelectorAll('rect.bar').length"), sum(c > 0 for c in counts))
        self.assertGreaterEqual(self.browser.run("return document.querySelectorAll('.side .tolerance-line').length"), 2)

    def test_two_reports_stand_side_by_side_on_one_scale(self):
        self.open("pair.html", 1440, 900)
        both = """
          const id = (k) => JSON.parse(document.getElementById(k).textContent);
          const a = id("batten-data"), b = id("batten-beside"), legends = [...document.querySelectorAll(".legend")];
          return { limits: [a.limit, b.limit], rms: [a.report.error.rms, b.report.error.rms],
                   ticks: legends.map((l) => [...l.querySelectorAll(".legend-number:not(.strong)")].map((t) => t.textContent).filter((t) => /[0-9]/.test(t))),
                   axes: [...document.querySelectorAll(".chart[aria-label='Histogram of deviations'] text")].map((t) => t.textContent) };"""
        seen = self.browser.run(both)
        self.assertNotEqual(*seen["limits"])
        ticks = [{float(re.sub("[^0-9.]", "", tick)) for tick in legend} for legend in seen["ticks"]]
        self.assertEqual(max(ticks[0]), max(ticks[1]), "one scale serves both")
        self.assertTrue(min(seen["limits"]) < max(ticks[0]) <= max(seen["limits"]), "which is the wider range")
        rows = dict(self.browser.run("""return [...document.querySelectorAll(".compared tbody tr")].map((r) =>
          [r.children[0].textContent, [...r.children].slice(1).map((c) => c.textContent)])"""))
        plain = [text.replace("\u2212", "-").replace("\u202f", "") for text in rows["rms [mm]"]]
        self.assertAlmostEqual(float(plain[0]), seen["rms"][0], 2)
        self.assertAlmostEqual(float(plain[1]), seen["rms"][1], 2)
        self.assertAlmostEqual(float(plain[2].split(" (")[0]), seen["rms"][0] - seen["rms"][1], 2)
        self.assertEqual(rows["points read"][2], "0")
        self.browser.screenshot(os.path.join(self.work, "pair.png"))
        self.assert_within_the_page()
        self.assert_calm()

    def test_of_two_reports_one_turns_and_colours_both(self):
        self.open("pair.html", 1440, 900)
        other = SUMMARY.replace("battenReport", "battenReport.beside")
        def seen():
            return self.summary()["hash"], self.browser.run(other)["hash"]
        first = seen()
        for act in ("battenReport.setMode('zebra')", "battenReport.setMode('deviation')", "battenReport.setLayer('cloud', true)",
                    "battenReport.setLayer('cloud', false)", "battenReport.setLimit(0.07)", "battenReport.beside.setView('z')",
                    "battenReport.setView('all')"):
            before = seen()
            self.browser.run(act)
            self.browser.run("return new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
            after = seen()
            self.assertNotEqual(after[0], before[0], act)
            self.assertNotEqual(after[1], before[1], act)
        self.open("pair.html", 1440, 900)
        self.assertEqual(seen(), first, "the same each time")
        self.assert_calm()

    def test_two_reports_fit_a_phone_print_and_need_no_likeness(self):
        self.open("pair.html", 390, 844)
        self.assert_within_the_page()
        self.assertTrue(self.browser.print_page().startswith(b"%PDF"))
        for name in ("mixed.html", "ovals.html"):
            self.open(name, 1240, 800)
            text = self.browser.run("return document.querySelector('main').textContent")
            self.assertIsNone(re.search(r"undefined|NaN|null|Infinity|\[object", text), name)
            self.assertGreater(self.browser.run(SUMMARY.replace("battenReport", "battenReport.beside"))["inked"], 0.002)
            self.browser.screenshot(os.path.join(self.work, name[:-4] + "png"))
            self.assert_within_the_page()
            self.assert_calm()

    def test_a_comparison_has_no_convergence_and_no_gap(self):
        self.open("compare.html")
        text = self.browser.run("return document.querySelector('main').innerText")
        self.assertIn("Comparison of geometry and points", text)
        self.assertNotIn("Convergence", text)
        self.assertNotIn("NaN", text)
        self.assertGreater(self.summary()["inked"], 0.15)
        self.assert_calm()

    def test_a_plane_curve_is_a_plan_with_its_comb(self):
        self.open("oval.html")
        self.assertGreater(self.summary()["inked"], 0.002)
        for layer, on in (("comb", None), ("whiskers", None), ("cloud", None), ("knots", None), ("net", None)):
            before = self.summary()["hash"]
            shown = self.browser.run("return document.querySelector('input[data-layer=' + arguments[0] + ']').checked", layer)
            self.browser.run("battenReport.setLayer(arguments[0], arguments[1])", layer, not shown)
            self.assertNotEqual(self.summary()["hash"], before, layer)
        self.assertIn("Deviation along the curve", self.browser.run("return document.querySelector('main').innerText"))
        self.browser.screenshot(os.path.join(self.work, "oval.png"))
        self.assert_calm()

    def test_a_curve_in_space_has_both_views(self):
        self.open("helix.html")
        space = self.summary()["hash"]
        self.assertTrue(self.browser.run("return battenReport.show('plan')"))
        self.assertNotEqual(self.summary()["hash"], space)
        self.assertTrue(self.browser.run("return battenReport.show('space')"))
        self.assertEqual(self.summary()["hash"], space)
        self.assertIn("Tolerance not reached", self.browser.run("return document.querySelector('.verdict').innerText"))
        self.assert_calm()

    def test_it_fits_a_phone(self):
        for name in ("panel.html", "oval.html", "compare.html"):
            self.open(name, 390, 844)
            self.assertGreater(self.summary()["inked"], 0.002)
            self.assert_within_the_page()
        self.open("panel.html", 1440, 900)
        self.assert_within_the_page()

    def test_it_prints_on_a4_with_the_drawing_and_without_buttons(self):
        self.open("panel.html")
        pdf = self.browser.print_page()
        with open(os.path.join(self.work, "panel.pdf"), "wb") as file:
            file.write(pdf)
        pages = len(re.findall(rb"/Type\s*/Page\b(?!s)", pdf))
        self.assertTrue(1 <= pages <= 4, f"{pages} pages")
        self.assertIn(b"/Subtype /Image", pdf, "the view is a picture")
        self.browser.devtools("Emulation.setEmulatedMedia", media="print")
        try:
            self.browser.resize(696, 986)
            shown = self.browser.run("""
              const seen = (s) => [...document.querySelectorAll(s)].filter((e) => e.getBoundingClientRect().height > 0).length;
              return { buttons: seen("button"), sliders: seen("input"), paper: seen(".paper"), legend: seen(".legend"),
                       bars: seen("rect.bar"), command: seen("pre"), table: seen("table.numbers") };""")
        finally:
            self.browser.devtools("Emulation.setEmulatedMedia", media="")
        self.assertEqual((shown["buttons"], shown["sliders"]), (0, 0))
        for part in ("paper", "legend", "bars", "command", "table"):
            self.assertGreater(shown[part], 0, part)

    def test_the_png_button_saves_the_view_with_axes_scale_and_legend(self):
        # How many pixels of a part of the picture are not white.
        inked = """
          const image = new Image();
          image.src = arguments[0];
          await image.decode();
          const canvas = document.createElement("canvas"), c = canvas.getContext("2d", { willReadFrequently: true });
          canvas.width = image.width;
          canvas.height = image.height;
          c.drawImage(image, 0, 0);
          const count = (x, y, w, h) => {
            const p = c.getImageData(x, y, w, h).data;
            let n = 0;
            for (let i = 0; i < p.length; i += 4) n += p[i] < 250 || p[i + 1] < 250 || p[i + 2] < 250;
            return n / (w * h);
          };
          return { width: image.width, height: image.height, all: count(0, 0, image.width, image.height),
                   axes: count(20, image.height - 170, 150, 150), scale: count(image.width - 340, image.height - 80, 320, 70),
                   legend: count(image.width - 220, 30, 200, 300) };"""
        for name, overlay in (("panel.html", True), ("oval.html", False)):
            self.open(name)
            before = self.summary()
            picture = self.browser.run("return battenReport.picture()")
            seen = self.browser.run("return (async function () {" + inked + "}).apply(null, arguments)", picture)
            self.assertEqual((seen["width"], seen["height"]), (1920, 1152))
            self.assertGreater(seen["all"], 0.005, name)
            self.assertLess(seen["all"], 0.95, name)
            for part in ("axes", "scale") if overlay else ():
                self.assertGreater(seen[part], 0.003, f"{name}: {part}")
            if self.browser.run("return document.querySelector('.legend').style.display !== 'none'"):
                self.assertGreater(seen["legend"], 0.05, f"{name}: legend")
            self.assertEqual(self.summary(), before, "the view is as it was")
            self.assert_calm()
        self.browser.devtools("Browser.setDownloadBehavior", behavior="allow", downloadPath=os.path.abspath(self.work))
        saved = os.path.join(self.work, "oval.png")
        if os.path.exists(saved):
            os.remove(saved)
        self.browser.run("[...document.querySelectorAll('button')].find((b) => b.textContent === 'PNG').click()")
        end = time.time() + 20
        while not os.path.exists(saved) and time.time() < end:
            time.sleep(0.1)
        with open(saved, "rb") as file:
            self.assertEqual(file.read(8), b"\x89PNG\r\n\x1a\n")

    def test_without_webgl_it_says_so_and_keeps_its_figures(self):
        with webdriver.Browser(flags=webdriver.NO_GL) as browser:
            self.open("panel.html", browser=browser)
            text = browser.run("return document.querySelector('main').innerText")
            self.assertIn("does not offer WebGL", text)
            self.assertIn("Tolerance reached", text)
            self.assertGreater(browser.run("return document.querySelectorAll('rect.bar').length"), 5)
            self.assertEqual([m for level, m in browser.console() if level == "SEVERE"], [])
            # A plan needs none.
            self.open("oval.html", browser=browser)
            self.assertGreater(browser.run(SUMMARY)["inked"], 0.002)

    def test_damaged_data_are_said_so(self):
        with open(os.path.join(self.work, "panel.html"), encoding="utf-8") as file:
            page = file.read()
        start = page.index('id="batten-data">') + len('id="batten-data">')
        with open(os.path.join(self.work, "damaged.html"), "w", encoding="utf-8") as file:
            file.write(page[:start] + "{" + page[start + 300:])
        self.browser.open(os.path.join(self.work, "damaged.html"))
        self.browser.wait_for("document.querySelector('main').innerText.includes('damaged')")

    def test_it_asks_nothing_of_the_network(self):
        self.open("panel.html")
        asked = self.browser.run("return performance.getEntriesByType('resource').map((e) => e.name).filter((n) => !n.startsWith('data:'))")
        self.assertEqual(asked, [])


if __name__ == "__main__":
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    lacking = webdriver.missing()
    if lacking:
        print("skipped: install " + " and ".join(lacking) + " to test reports in a browser")
        sys.exit(SKIPPED)
    ARGUMENTS = [os.path.abspath(a) for a in sys.argv[1:4]]
    unittest.main(argv=sys.argv[:1] + sys.argv[4:], verbosity=2)
