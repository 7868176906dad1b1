#!/usr/bin/python3
"""`posefusion web`: it serves the page and nothing else, to whom it should, and ends when told.

usage: server_test.py PROGRAM [unittest options]
"""
import http.client
import json
import re
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path
from urllib.parse import urlsplit

sys.dont_write_bytecode = True
from browser import Browser, chromium
from small_map import write_wall

PROGRAM = Path(sys.argv[1]).resolve()
PATIENCE = 60  # seconds


class Server:
    """`posefusion web` on a free port. Use it in a `with` statement."""

    def __init__(self, source, *options):
        command = [PROGRAM, "web", source, "--port", "0", *options]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.url = self.process.stdout.readline().strip()
        self.address = urlsplit(self.url)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.kill()
        self.process.communicate()

    def ask(self, path, method="GET", **headers):
        """The status, headers and body of an answer. The path goes out as it is."""
        connection = http.client.HTTPConnection("127.0.0.1", self.address.port, timeout=PATIENCE)
        connection.putrequest(method, path, skip_host="Host" in headers)
        for name, value in headers.items():
            connection.putheader(name, value)
        connection.endheaders()
        answer = connection.getresponse()
        body = answer.read()
        connection.close()
        return answer.status, dict(answer.getheaders()), body

    def end(self, number):
        """Its exit code after a signal."""
        self.process.send_signal(number)
        return self.process.wait(PATIENCE)


class ServerTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.map = Path(cls.scratch.name) / "map.ply"
        write_wall(cls.map, 300)

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    def test_serves_the_page_and_its_parts(self):
        with Server(self.map) as server:
            self.assertTrue(server.url.startswith("http://127.0.0.1:"))
            status, headers, page = server.ask("/")
            self.assertEqual((status, headers["Content-Type"]), (200, "text/html; charset=utf-8"))
            text = page.decode()
            scene = json.loads(re.search(r'id="scene">(.*?)</script>', text).group(1))
            imports = json.loads(re.search(r'importmap">(.*?)</script>', text).group(1))["imports"]
            urls = [url.removeprefix(".") for url in imports.values()]
            urls += ["/style.css"] + ["/" + piece["url"] for piece in scene["map"]["pieces"]]
            self.assertGreater(len(scene["map"]["pieces"]), 2)
            for url in urls:
                status, headers, body = server.ask(url)
                self.assertEqual(status, 200, url)
                self.assertEqual(len(body), int(headers["Content-Length"]), url)
                self.assertEqual(headers["X-Content-Type-Options"], "nosniff")
            self.assertEqual(server.ask("/", "HEAD")[2], b"")

    def test_nothing_else_can_be_had(self):
        with Server(self.map) as server:
            paths = ["/map.ply", "/../map.ply", "/../../etc/passwd", "/..%2f..%2fetc/passwd", "/%2e%2e/etc/passwd"]
            paths += ["//etc/passwd", "/scripts/../../map.ply", "/scripts/", "/map/", "/map/99", "/index.html", "/%00"]
            paths += [str(self.map), "/" + "a" * 4000]
            for path in paths:
                self.assertIn(server.ask(path)[0], (400, 404, 414), path)
            for method in ("POST", "PUT", "DELETE", "OPTIONS", "PATCH"):
                self.assertEqual(server.ask("/", method)[0], 405, method)
            self.assertEqual(server.ask("/")[0], 200)

    def test_answers_this_machine_by_its_own_names_only(self):
        with Server(self.map) as server:
            for host in ("localhost", f"127.0.0.1:{server.address.port}", "[::1]:80"):
                self.assertEqual(server.ask("/", Host=host)[0], 200, host)
            for host in ("evil.example", f"evil.example:{server.address.port}", "127.0.0.1.evil.example", ""):
                self.assertEqual(server.ask("/", Host=host)[0], 403, host)

    def test_others_need_the_secret(self):
        with Server(self.map, "--bind", "0.0.0.0") as server, Server(self.map, "--bind", "0.0.0.0") as other:
            secret = server.address.path
            self.assertRegex(secret, r"^/[0-9a-f]{32}/$")
            self.assertNotEqual(secret, other.address.path)
            self.assertEqual(server.ask(secret, Host="any.name.will.do")[0], 200)
            status, headers, _ = server.ask(secret.rstrip("/"))
            self.assertEqual((status, headers["Location"]), (301, secret))
            for path in ("/", "/style.css", "/map/0", other.address.path, secret[:-2] + "/"):
                self.assertEqual(server.ask(path)[0], 404, path)

    def test_a_port_in_use_is_one_clear_line(self):
        with socket.socket() as taken:
            taken.bind(("127.0.0.1", 0))
            taken.listen()
            port = str(taken.getsockname()[1])
            done = subprocess.run([PROGRAM, "web", self.map, "--port", port], capture_output=True, text=True)
        self.assertEqual(done.returncode, 1)
        errors = [line for line in done.stderr.splitlines() if line.startswith("posefusion: ")]
        self.assertEqual(len(errors), 1)
        self.assertIn("port is in use", errors[0])
        self.assertIn(port, errors[0])

    def test_two_servers_do_not_share_a_port(self):
        with Server(self.map) as server:
            command = [PROGRAM, "web", self.map, "--port", str(server.address.port)]
            done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE)
            self.assertEqual(done.returncode, 1)
            self.assertIn("port is in use", done.stderr)

    def test_an_address_of_another_machine_is_refused(self):
        command = [PROGRAM, "web", self.map, "--port", "0", "--bind", "192.0.2.1"]  # TEST-NET-1
        done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE)
        self.assertEqual(done.returncode, 1)
        self.assertIn("address of this machine", done.stderr)

    def test_ends_when_told_even_with_an_idle_connection(self):
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            with Server(self.map) as server:
                idle = socket.create_connection(("127.0.0.1", server.address.port))
                self.assertEqual(server.ask("/")[0], 200)
                begin = time.monotonic()
                self.assertEqual(server.end(number), 0)
                self.assertLess(time.monotonic() - begin, 20)
                idle.close()

    @unittest.skipIf(chromium() is None, "Chromium is not installed")
    def test_a_browser_shows_it(self):
        for options in ((), ("--bind", "0.0.0.0")):
            with Server(self.map, *options) as server, Browser(800, 560) as browser:
                local = f"http://127.0.0.1:{server.address.port}{server.address.path}"
                browser.open(local)
                browser.wait_for("document.documentElement.dataset.state === 'complete'")
                browser.wait_for("document.documentElement.dataset.drawn === '90000'")
                self.assertEqual(browser.messages, [])
                outside = [u for u in browser.requests if not u.startswith((local, "data:", "blob:"))]
                self.assertEqual(outside, [])


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]])
