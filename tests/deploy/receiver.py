"""receiver.py PORT FILE: takes every POST and appends its body to FILE, a line each: Alertmanager's webhook."""

import http.server
import sys


class Receiver(http.server.BaseHTTPRequestHandler):
    def do_POST(self):
        body = self.rfile.read(int(self.headers["Content-Length"]))
        with open(sys.argv[2], "ab") as file:
            file.write(body.replace(b"\n", b" ") + b"\n")
        self.send_response(200)
        self.end_headers()

    def log_message(self, *_):
        """Says nothing."""


http.server.HTTPServer(("0.0.0.0", int(sys.argv[1])), Receiver).serve_forever()
