#!/usr/bin/env python3
"""Opens the browser version in Chromium and compares it with the program: web/try.py PAGE PROGRAM PICTURES

PAGE is the folder that web/build.sh has made, PROGRAM the program `slump`. Screenshots are written into the folder
PICTURES; look at them. Needs Debian's chromium and chromium-driver, and Python's standard library only. states.mjs
compares more runs with the program.
"""
import base64
import functools
import http.server
import json
import pathlib
import socket
import subprocess
import sys
import tempfile
import threading
import time
import urllib.request

PAGE, PROGRAM, PICTURES = (pathlib.Path(word).resolve() for word in sys.argv[1:4])
SCENES = ["pile", "drum"]
STEPPERS = ["moreau", "range"]
TIME_STEP_SECS = 5e-4
STEPS = 200
PATIENCE_SECS = 90


class Files(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_):
        pass


class Browser:
    """Headless Chromium with a software rasteriser, controlled by WebDriver."""

    def __init__(self, size):
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.port = free.getsockname()[1]
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        self.driver = subprocess.Popen(["chromedriver", f"--port={self.port}"], **quiet)
        self.downloads = tempfile.mkdtemp()
        arguments = [
            "--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
            "--ignore-gpu-blocklist", f"--window-size={size[0]},{size[1]}",
        ]
        options = {
            "browserName": "chrome",
            "goog:loggingPrefs": {"browser": "ALL"},
            "goog:chromeOptions": {
                "args": arguments,
                "prefs": {"download.default_directory": self.downloads},
            },
        }
        answer = None
        for _ in range(100):
            try:
                answer = self.ask("POST", "/session", {"capabilities": {"alwaysMatch": options}})
                break
            except OSError:
                time.sleep(0.1)
        self.session = "/session/" + answer["sessionId"]

    def ask(self, method, path, body=None):
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(f"http://127.0.0.1:{self.port}{path}", data, method=method)
        return json.load(urllib.request.urlopen(request, timeout=120))["value"]

    def command(self, path, **body):
        return self.ask("POST", self.session + path, body)

    def open(self, url):
        self.command("/url", url=url)

    def run(self, script):
        return self.command("/execute/sync", script=script, args=[])

    def told(self):
        """Return the state of the page, or None before the page runs."""
        text = self.run("return globalThis.slump ? slump.told() : ''")
        return json.loads(text) if text else None

    def until(self, what, wanted):
        end = time.time() + PATIENCE_SECS
        told = None
        while time.time() < end:
            told = self.told()
            if told and wanted(told):
                return told
            time.sleep(0.1)
        brief = told and {name: told[name] for name in ("scene", "step", "playing", "worlds", "frames")}
        sys.exit(f"not so within {PATIENCE_SECS} s: {what}; the page tells {brief}; {self.logs()}")

    def pointer(self, *actions):
        finger = {"type": "pointer", "id": "hand", "parameters": {"pointerType": "mouse"}}
        self.command("/actions", actions=[finger | {"actions": list(actions)}])

    def drag(self, start, end):
        move = lambda at: {"type": "pointerMove", "x": round(at[0]), "y": round(at[1]), "duration": 100}
        self.pointer(
            move(start), {"type": "pointerDown", "button": 0}, move(end), {"type": "pause", "duration": 200},
            {"type": "pointerUp", "button": 0})

    def click(self, at):
        self.drag(at, at)

    def press(self, name):
        """Click a control when it has stayed at its place for half a second: new text moves controls."""
        at = None
        for _ in range(60):
            told = self.told()
            now = middle(told, name) if name in told["controls"] else None
            if now and now == at:
                return self.click(at)
            at = now
            time.sleep(0.5)
        sys.exit(f"the control {name} does not stay at one place")

    def set_offline(self, is_offline):
        conditions = {"offline": is_offline, "latency": 0, "throughput": 0 if is_offline else -1}
        self.command("/chromium/network_conditions", network_conditions=conditions)

    def picture(self, name):
        PICTURES.mkdir(parents=True, exist_ok=True)
        image = self.ask("GET", self.session + "/screenshot")
        (PICTURES / f"{name}.png").write_bytes(base64.b64decode(image))

    def logs(self):
        return [entry["message"] for entry in self.command("/se/log", type="browser") if entry["level"] == "SEVERE"]

    def close(self):
        self.ask("DELETE", self.session)
        self.driver.terminate()
        self.driver.wait()


def middle(told, name):
    left, top, right, bottom = told["controls"][name]
    return (left + right) / 2, (top + bottom) / 2


def state_of_program(options, steps):
    """Return the hash of the program's last state, or None if the program refuses the run."""
    with tempfile.TemporaryDirectory() as folder:
        duration = str(steps * TIME_STEP_SECS)
        command = [str(PROGRAM), "--headless", "--frames", folder, "--size", "64x48", "--renderer", "cpu", "--fps", "1"]
        done = subprocess.run([*command, *options, "--duration", duration], capture_output=True)
        if done.returncode == 2:
            return None
        run = json.loads((pathlib.Path(folder) / "manifest.json").read_text())["runs"][0]
        assert run["step"] == steps or run["ended"] == "not-finite", run
        return run["last_state"]


def state_of_page(options, steps):
    query = "&".join(f"{name.lstrip('-')}={value}" for name, value in zip(options[::2], options[1::2]))
    browser.open(f"{address}?{query}&to={steps}")
    told = browser.until(f"{query} is there", lambda told: told["step"] == steps)
    return told["state_hash"]


server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Files, directory=str(PAGE)))
threading.Thread(target=server.serve_forever, daemon=True).start()
address = f"http://127.0.0.1:{server.server_port}/index.html"
browser = Browser((1280, 1000))
try:
    begun = time.time()
    browser.open(address)
    told = browser.until("the first lesson shows", lambda told: told["grains"] > 0 and told["lesson"] == 1)
    print(f"first picture after {time.time() - begun:.1f} s")
    browser.picture("lesson")

    browser.click(middle(told, "release"))
    browser.until("it moves", lambda told: told["step"] > 20)
    begun, first = time.time(), browser.told()["frames"]
    told = browser.until("it comes to its end", lambda told: not told["playing"] and told["step"] > 20)
    rate = (told["frames"] - first) / (time.time() - begun)
    print(f"lesson 1 to its end at {told['time_secs']:.3f} s, {rate:.0f} frames of the run a second")
    browser.picture("end")

    # During the deposition of a new pile the worker receives no messages. It must be able to cancel the deposition
    # nevertheless.
    browser.press("more")
    browser.press("new pile")
    rains = browser.until("it rains", lambda told: told["loading"] and "cancel" in told["controls"])
    begun = time.time()
    browser.click(middle(rains, "cancel"))
    given_up = browser.until("it is given up", lambda given_up: not given_up["loading"])
    print(f"a new pile is given up after {time.time() - begun:.1f} s")
    assert given_up["state_hash"] == told["state_hash"], "what was there before is gone"

    alike = {}
    for scene in SCENES:
        for stepper in STEPPERS:
            options = ["--scene", scene, "--stepper", stepper, "--dt", str(TIME_STEP_SECS)]
            expected = state_of_program(options, STEPS)
            if expected:
                alike[scene, stepper] = state_of_page(options, STEPS) == expected
    print(f"{sum(alike.values())} of {len(alike)} runs of {STEPS} steps have the program's state, bit for bit")
    others = [" by ".join(run) for run, is_alike in alike.items() if not is_alike]
    assert not others, f"other states: {', '.join(others)}"
    told = browser.told()
    browser.picture("link")

    opened = told["state_hash"]
    browser.command("/refresh")
    told = browser.until("the link's run is there again", lambda told: told["step"] == STEPS)
    assert told["state_hash"] == opened, "loaded anew, a link comes to another state"
    print("loaded anew, the page comes to the same state")

    # The page has loaded all its files. From now on it must work without the network.
    browser.set_offline(True)
    assert not browser.run("return navigator.onLine"), "the browser is not offline"
    left, top, right, bottom = told["controls"]["Δt"]
    before = told["parameters"]["time_step_secs"]
    at = (left + right) / 2, (top + bottom) / 2
    browser.drag(at, (left + 0.8 * (right - left), at[1]))
    told = browser.until("Δt is another", lambda told: told["parameters"]["time_step_secs"] != before)
    print(f"offline, Δt dragged from {before} s to {told['parameters']['time_step_secs']} s")
    browser.click(middle(told, "release"))
    step = told["step"]
    browser.until("it runs offline", lambda told: told["step"] > step + 20)
    browser.picture("offline")
    browser.set_offline(False)

    logs = browser.logs()
    assert not logs, f"the console has errors: {logs}"
finally:
    browser.close()
