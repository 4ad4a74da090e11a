# SPDX-License-Identifier: MIT
"""The few WebDriver calls that the tests need, spoken to chromedriver with the standard library."""
import base64
import json
import shutil
import subprocess
import time
import urllib.error
import urllib.request

# WebGL by software, so that the tests need no graphics card: ANGLE over SwiftShader.
SOFTWARE_GL = ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
NO_GL = ["--disable-gpu", "--disable-3d-apis"]


def missing():
    """What is not installed of what a browser test needs, in words; empty when all is there."""
    needed = {"chromedriver": "chromium-driver", "chromium": "chromium"}
    return [package for program, package in needed.items() if not shutil.which(program)]


class Browser:
    """A headless Chromium of its own; use as `with Browser() as browser`."""

    def __init__(self, width=1440, height=900, flags=SOFTWARE_GL):
        self.driver = subprocess.Popen(["chromedriver", "--port=0"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        self.session = None
        try:
            self.base = f"http://127.0.0.1:{self._port()}"
            options = {"args": ["--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--hide-scrollbars",
                                "--no-first-run", f"--window-size={width},{height}", *flags],
                       "binary": shutil.which("chromium")}
            answer = self._call("POST", "/session", {"capabilities": {"alwaysMatch": {
                "browserName": "chrome", "goog:chromeOptions": options, "goog:loggingPrefs": {"browser": "ALL"}}}})
            self.session = "/session/" + answer["sessionId"]
        except BaseException:
            self.driver.kill()
            raise

    def __enter__(self):
        return self

    def __exit__(self, *_):
        try:
            self._call("DELETE", self.session)
        finally:
            self.driver.terminate()
            self.driver.wait(10)
            self.driver.stdout.close()

    def _port(self):
        for line in self.driver.stdout:
            if "started successfully on port" in line:
                return int(line.split("port")[-1].strip().rstrip("."))
        raise RuntimeError("chromedriver did not start")

    def _call(self, method, path, body=None):
        data = json.dumps(body).encode() if body is not None else None
        request = urllib.request.Request(self.base + path, data, {"Content-Type": "application/json"}, method=method)
        try:
            with urllib.request.urlopen(request, timeout=120) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as error:
            raise RuntimeError(json.load(error)["value"]["message"].split("\n")[0]) from None

    def open(self, path):
        self._call("POST", self.session + "/url", {"url": "file://" + urllib.request.pathname2url(str(path))})

    def run(self, script, *arguments):
        """The value of `return …` in the page."""
        return self._call("POST", self.session + "/execute/sync", {"script": script, "args": list(arguments)})

    def wait_for(self, script, limit=20):
        end = time.time() + limit
        while time.time() < end:
            value = self.run("return " + script)
            if value:
                return value
            time.sleep(0.05)
        raise AssertionError(f"{script} did not come true in {limit} s")

    def resize(self, width, height):
        """The page itself gets this size, phones included."""
        self._call("POST", self.session + "/goog/cdp/execute", {"cmd": "Emulation.setDeviceMetricsOverride", "params": {
            "width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}})

    def devtools(self, command, **parameters):
        return self._call("POST", self.session + "/goog/cdp/execute", {"cmd": command, "params": parameters})

    def screenshot(self, path, full=False):
        """What the window shows as PNG, or all of the page."""
        if full:
            shot = self.devtools("Page.captureScreenshot", format="png", captureBeyondViewport=True)["data"]
        else:
            shot = self._call("GET", self.session + "/screenshot")
        with open(path, "wb") as file:
            file.write(base64.b64decode(shot))

    def print_page(self):
        """The page as PDF on A4."""
        return base64.b64decode(self._call("POST", self.session + "/print", {
            "background": True, "page": {"width": 21.0, "height": 29.7},
            "margin": {"top": 1.3, "bottom": 1.3, "left": 1.3, "right": 1.3}}))

    def console(self):
        """What the console has said since the last call: [(level, message)]."""
        return [(entry["level"], entry["message"]) for entry in self._call("POST", self.session + "/se/log", {"type": "browser"})]

    def pointer(self, *steps):
        """Mouse actions in the page: ("move", x, y), ("down",), ("up",)."""
        kinds = {"move": "pointerMove", "down": "pointerDown", "up": "pointerUp"}
        actions = []
        for kind, *place in steps:
            action = {"type": kinds[kind], "button": 0}
            if place:
                action = {"type": "pointerMove", "duration": 0, "x": int(place[0]), "y": int(place[1])}
            actions.append(action)
        self._call("POST", self.session + "/actions", {"actions": [
            {"type": "pointer", "id": "mouse", "parameters": {"pointerType": "mouse"}, "actions": actions}]})
        self._call("DELETE", self.session + "/actions")

    def touch(self, *frames):
        """Fingers on the page: each frame is the list of places (x, y) where they are; all leave at the end."""
        down = 0
        for frame in frames:
            points = [{"x": x, "y": y, "id": i} for i, (x, y) in enumerate(frame)]
            self.devtools("Input.dispatchTouchEvent", type="touchMove" if len(frame) == down else "touchStart", touchPoints=points)
            down = len(frame)
        self.devtools("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])
