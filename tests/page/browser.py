"""Chromium, driven by the DevTools protocol over a pipe."""
import base64
import fcntl
import json
import os
import select
import subprocess
import time

FLAGS = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--hide-scrollbars", "--no-first-run",
         "--force-color-profile=srgb", "--disable-background-networking", "--disable-component-update",
         "--remote-debugging-pipe", "about:blank"]
SECONDS_MAX = 120


class Browser:
    def __init__(self, program, folder):
        command_end, self.commands = os.pipe()
        self.replies, reply_end = os.pipe()
        # Chromium reads commands from 3 and writes to 4; numbers from 10 on keep the redirections apart.
        ends = [fcntl.fcntl(end, fcntl.F_DUPFD, 10) for end in (command_end, reply_end)]
        self.log = open(os.path.join(folder, "chromium.log"), "wb")
        self.process = subprocess.Popen(
            ["bash", "-c", f'exec "$0" "$@" 3<&{ends[0]} 4>&{ends[1]}', program, f"--user-data-dir={folder}/profile", *FLAGS],
            pass_fds=ends, stdin=subprocess.DEVNULL, stdout=self.log, stderr=self.log)
        for end in (command_end, reply_end, *ends):
            os.close(end)
        self.last, self.unread, self.events = 0, b"", []

    def read(self):
        """The next message."""
        deadline = time.monotonic() + SECONDS_MAX
        while b"\0" not in self.unread:
            if not select.select([self.replies], [], [], max(0, deadline - time.monotonic()))[0]:
                raise RuntimeError(f"Chromium has said nothing for {SECONDS_MAX} s")
            part = os.read(self.replies, 1 << 16)
            if not part:
                raise RuntimeError(f"Chromium has ended; {self.log.name} may say why")
            self.unread += part
        message, self.unread = self.unread.split(b"\0", 1)
        return json.loads(message)

    def call(self, method, session=None, **parameters):
        self.last += 1
        request = {"id": self.last, "method": method, "params": parameters}
        if session:
            request["sessionId"] = session
        data = json.dumps(request).encode() + b"\0"
        while data:
            data = data[os.write(self.commands, data):]
        while True:
            message = self.read()
            if message.get("id") == self.last:
                if "error" in message:
                    raise RuntimeError(f"{method}: {message['error']['message']}")
                return message["result"]
            self.events.append(message)

    def tab(self):
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        return Tab(self, self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"])

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.process.wait()
        self.log.close()


class Tab:
    def __init__(self, browser, session):
        self.browser, self.session = browser, session
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(f"{domain}.enable")

    def call(self, method, **parameters):
        return self.browser.call(method, self.session, **parameters)

    def take_events(self):
        events = [e for e in self.browser.events if e.get("sessionId") == self.session]
        self.browser.events = [e for e in self.browser.events if e.get("sessionId") != self.session]
        return events

    def load(self, url, width, height, scheme):
        """Loads the page and returns the errors that it causes."""
        self.call("Page.bringToFront")  # pictures of a hidden page are not decoded
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=width < 600)
        self.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])
        self.take_events()
        self.call("Page.navigate", url=url)
        events = []
        while not any(e["method"] == "Page.loadEventFired" for e in events):
            self.browser.events.append(self.browser.read())
            events += self.take_events()
        self.run("Promise.all([...document.images].map(i => i.decode().catch(() => {})))")
        return [text for text in map(error_of, events + self.take_events()) if text]

    def run(self, script):
        """The value of an expression, awaited."""
        result = self.call("Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in result:
            raise RuntimeError(result["exceptionDetails"].get("exception", {}).get("description", "an exception"))
        return result["result"].get("value")

    def screenshot(self, x, y, width, height):
        """PNG of a part of the document, also beyond the screen."""
        clip = {"x": x, "y": y, "width": width, "height": height, "scale": 1}
        return base64.b64decode(self.call("Page.captureScreenshot", format="png", clip=clip, captureBeyondViewport=True)["data"])


def error_of(event):
    method, parameters = event["method"], event["params"]
    if method == "Log.entryAdded" and parameters["entry"]["level"] == "error":
        return parameters["entry"]["text"]
    if method == "Runtime.consoleAPICalled" and parameters["type"] in ("error", "assert"):
        return "console: " + " ".join(str(a.get("value", "")) for a in parameters["args"])
    if method == "Runtime.exceptionThrown":
        return parameters["exceptionDetails"]["text"]
    if method == "Network.loadingFailed" and not parameters.get("canceled"):
        return parameters["errorText"]
    return None
