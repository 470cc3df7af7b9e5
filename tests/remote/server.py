"""A web server for tests, on loopback. The first part of a path says how it behaves; what follows is a file in its folder.

plain    answers range requests
rough    the same, but up to twice for each range it first sends an error, half of the bytes, or resets the connection
stalled  the first answer for a range that begins at a multiple of 4096 stops half-way, and nothing more comes
whole    ignores ranges
other    sends other bytes than were asked for
broken   always an error of the server
refused  403
moved    a redirection to plain
crumbs   ten bytes of each range
open-ended  does not say how long an answer is, and leaves the connection open
bottomless  the file, and zeros behind it up to 2^62 bytes
LIES, STREAMS, REDIRECTIONS: what no honest server does
"""
import functools
import http.server
import pathlib
import random
import re
import socket
import struct
import sys
import threading
import time


# Answers to a range that are wrong in one way: what differs from the right one. `right`: first, last, size, body.
LIES = {
    "impossible-size": lambda right: {"size": 2**63},
    "overflowing-size": lambda right: {"size": 2**64 - 1},
    "negative-size": lambda right: {"size": -5},
    "unknown-size": lambda right: {"size": "*"},
    "no-range": lambda right: {"range": None},
    "longer-range": lambda right: {"last": right["last"] + 1, "size": right["size"] + 1, "body": right["body"] + b"x"},
    "more": lambda right: {"body": right["body"] + bytes(5000)},
    "fewer": lambda right: {"body": right["body"][:100]},
    "none": lambda right: {"body": b""},
    "compressed": lambda right: {"headers": {"Content-Encoding": "gzip"}},
    "status-204": lambda right: {"status": 204, "body": b""},
    "status-304": lambda right: {"status": 304, "body": b""},
    "status-999": lambda right: {"status": 999, "body": b""},
    "no-such-range": lambda right: {"status": 416, "range": f"*/{right['size']}", "body": b""},
    "later": lambda right: {"status": 503, "headers": {"Retry-After": "100000"}, "body": b""},
    "shrinking": lambda right: {"size": right["size"] - right["first"] // 2},
    "changing": lambda right: {"headers": {"Last-Modified": f"Thu, 01 Jan 1970 00:{right['first'] // 65536:02}:00 GMT"}},
}
RANGE = "HTTP/1.1 206 x\r\nContent-Range: bytes {first}-{last}/{size}\r\n"
# Answers that never end: how they begin, what then comes again and again, and after how many seconds each time.
STREAMS = {
    "endless-page": ("HTTP/1.1 500 x\r\n\r\n", bytes(65536), 0),
    "endless-404": ("HTTP/1.1 404 x\r\n\r\n", bytes(65536), 0),
    "endless-redirection": ("HTTP/1.1 302 x\r\nLocation: /plain/none\r\n\r\n", bytes(65536), 0),
    "endless-bytes": (RANGE + "\r\n", bytes(65536), 0),
    "endless-header": ("HTTP/1.1 206 x\r\n", (b"X: " + b"y" * 1000 + b"\r\n") * 64, 0),
    "endless-line": ("HTTP/1.1 206 x\r\nX: ", b"y" * 65536, 0),
    "endless-continue": ("", b"HTTP/1.1 100 Continue\r\n\r\n" * 1000, 0),
    "endless-extension": (RANGE + "Transfer-Encoding: chunked\r\n\r\n5;", b"x" * 65536, 0),
    "endless-size": (RANGE + "Transfer-Encoding: chunked\r\n\r\n", b"f" * 64, 0),
    "drip": (RANGE + "Content-Length: {length}\r\n\r\n", b"x", 0.2),
    "silent": ("", b"", 0.2),
    "garbage": ("no HTTP\r\n\r\n", bytes(64), 0),
}
REDIRECTIONS = {
    "circle": "/circle/file",
    "local-file": "file:///etc/passwd",
    "gopher": "gopher://127.0.0.1/file",
}


class Server(http.server.ThreadingHTTPServer):
    daemon_threads = True
    request_queue_size = 128

    def __init__(self, folder, delay=0.0):
        self.folder, self.delay = pathlib.Path(folder), delay
        self.lock = threading.Lock()
        self.answers = {}  # (path, range) -> how many so far
        self.requests = self.sent = self.at_once = self.most_at_once = 0
        super().__init__(("127.0.0.1", 0), Handler)
        self.thread = threading.Thread(target=functools.partial(self.serve_forever, poll_interval=0.05), daemon=True)
        self.thread.start()

    def url(self, name, way="plain"):
        return f"http://127.0.0.1:{self.server_port}/{way}/{name}"

    def reset(self):
        with self.lock:
            self.requests = self.sent = self.most_at_once = 0

    def handle_error(self, request, client_address):
        pass  # a client that went away


class Handler(http.server.BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"

    def log_message(self, *_):
        pass

    def do_GET(self):
        server = self.server
        with server.lock:
            server.requests += 1
            server.at_once += 1
            server.most_at_once = max(server.most_at_once, server.at_once)
            key = (self.path, self.headers.get("Range"))
            before = server.answers.get(key, 0)
            server.answers[key] = before + 1
        try:
            time.sleep(server.delay)
            self.answer(*self.path.split("?")[0].lstrip("/").split("/", 1), before)
        finally:
            with server.lock:
                server.at_once -= 1

    def fail(self, status, **headers):
        body = b"sorry\n"
        self.send_response(status)
        for name, value in headers.items():
            self.send_header(name.replace("_", "-"), value)
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def lie(self, wrong, right):
        said = {"status": 206, "headers": {}, **right, **wrong}
        value = said.get("range", f"{said['first']}-{said['last']}/{said['size']}")
        self.send_response(said["status"])
        for header, text in said["headers"].items():
            self.send_header(header, text)
        if value is not None:
            self.send_header("Content-Range", f"bytes {value}")
        self.send_header("Content-Length", str(len(said["body"])))
        self.end_headers()
        self.wfile.write(said["body"])

    def stream(self, begin, piece, seconds, right):
        self.close_connection = True
        self.wfile.write(begin.format(length=len(right["body"]), **right).encode())
        try:
            while True:
                self.wfile.write(piece)
                time.sleep(seconds)
        except OSError:
            pass  # the client has had enough

    def answer(self, way, name, before):
        path = self.server.folder / name
        if way in ("broken", "refused"):
            return self.fail(500 if way == "broken" else 403)
        if way == "moved" or way in REDIRECTIONS:
            return self.fail(302, Location=REDIRECTIONS.get(way) or self.server.url(name))
        if not path.is_file():
            return self.fail(404)
        size = path.stat().st_size if way != "bottomless" else 1 << 62
        match = re.fullmatch(r"bytes=(\d+)-(\d+)", self.headers.get("Range", ""))
        if not match or way == "whole":
            first, end, status = 0, size, 200
        else:
            first, end, status = int(match[1]), min(int(match[2]) + 1, size), 206
            if way == "other":
                first += 1
            if first >= size:
                return self.fail(416, Content_Range=f"bytes */{size}")
        kind = "whole"
        if way == "rough" and before < 2:
            kind = random.Random(f"{self.path} {first} {before}").choice(["whole", "error", "busy", "short", "cut", "reset"])
        if way == "stalled" and before == 0 and first % 4096 == 0:
            kind = "stalled"
        if kind in ("error", "busy"):
            return self.fail(503 if kind == "error" else 429, Retry_After="0")
        if way == "crumbs":
            end = first + 10
        if kind == "short":  # a range that is shorter than was asked for
            end = (first + end + 1) // 2
        with path.open("rb") as file:
            file.seek(first)
            body = file.read(end - first)
            body += bytes(end - first - len(body))  # zeros behind a file that is said to be longer
        right = {"first": first, "last": end - 1, "size": size, "body": body}
        if way in STREAMS:
            return self.stream(*STREAMS[way], right)
        if way in LIES:
            return self.lie(LIES[way](right), right)
        self.send_response(status)
        if status == 206:
            self.send_header("Content-Range", f"bytes {first}-{end - 1}/{size}")
        if way != "open-ended":
            self.send_header("Content-Length", str(end - first))
        self.end_headers()
        part = body if kind in ("whole", "short") else body[:len(body) // 2 + 1]
        self.wfile.write(part)
        with self.server.lock:
            self.server.sent += len(part)
        if kind == "stalled" or way == "open-ended":
            self.wfile.flush()
            time.sleep(30)
        if kind == "reset":
            self.wfile.flush()
            self.connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        if kind in ("cut", "reset", "stalled") or way == "open-ended":
            self.close_connection = True


if __name__ == "__main__":  # server.py FOLDER PORTFILE: serves until it is killed
    served = Server(sys.argv[1])
    port_file = pathlib.Path(sys.argv[2])
    port_file.with_suffix(".new").write_text(str(served.server_port))
    port_file.with_suffix(".new").rename(port_file)
    served.thread.join()
