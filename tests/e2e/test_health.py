"""`uplinkctl health` against a real server, and against what is none."""

import os
import socket
import threading
import unittest

from harness import BIN, EndToEnd, run, uplinkctl
from ports import free_port

# Longer than the program waits for an answer.
PROBE_SECONDS = 30


class Answering:
    """Accepts connections and answers each with the same bytes; without any it stays silent."""

    def __init__(self, answer=None, family=socket.AF_INET):
        self.answer = answer
        self.listener = socket.socket(family)
        self.listener.bind(("::1" if family == socket.AF_INET6 else "127.0.0.1", 0))
        self.listener.listen()
        self.port = self.listener.getsockname()[1]
        self.held = []
        self.asked = []
        self.thread = threading.Thread(target=self.serve)
        self.thread.start()

    def serve(self):
        while True:
            try:
                connection, _ = self.listener.accept()
            except OSError:
                return
            self.held.append(connection)
            if self.answer is not None:
                self.asked.append(connection.recv(4096))
                connection.sendall(self.answer)
                connection.shutdown(socket.SHUT_WR)

    def close(self):
        self.listener.shutdown(socket.SHUT_RDWR)
        self.thread.join(PROBE_SECONDS)
        self.listener.close()
        for connection in self.held:
            connection.close()


class Health(EndToEnd):
    def answering(self, answer=None, family=socket.AF_INET):
        program = Answering(answer, family)
        self.open_things.append(program)
        return program

    def failing(self, *arguments):
        """The one line of a probe that failed."""
        done = uplinkctl("health", *arguments, code=1)
        self.assertEqual(done.stdout, "")
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        return done.stderr

    def test_a_pipe_as_the_configuration_is_not_waited_for(self):
        pipe = self.folder / "pipe.toml"
        os.mkfifo(pipe)
        done = uplinkctl("health", "--config", pipe, code=2)
        self.assertIn(f"{pipe}: is not a regular file; name one", done.stderr)
        self.assertIn("is not a regular file; name one", uplinkctl("doctor", "--config", pipe, code=2).stdout)

    def test_a_running_server_is_alive_and_ready(self):
        server = self.server().start()
        path = server.configuration()
        self.assertIn("alive: ", uplinkctl("health", "--config", path).stdout)
        self.assertIn('ready: {"degraded":', uplinkctl("health", "--ready", "--config", path).stdout)
        self.assertIn("alive: ", uplinkctl("health", "--url", f"http://{server.http}/").stdout)
        server.terminate(60)
        line = self.failing("--config", path)
        self.assertIn(f"http://{server.http}/livez: connect: Connection refused", line)
        self.assertIn(f"the address is listen.http of {path}\n", line)

    def test_without_flags_the_line_says_whom_it_asked(self):
        closed = f"127.0.0.1:{free_port()}"
        environment = {**os.environ, "UPLINKD_LISTEN_HTTP": closed}
        done = run(BIN / "uplinkctl", "health", code=1, env=environment)
        self.assertIn(f"http://{closed}/livez: connect: Connection refused; the address is that of the "
                      "variable UPLINKD_LISTEN_HTTP\n", done.stderr)  # fmt: skip

    def test_a_server_that_cannot_serve_says_why(self):
        program = self.answering(b'HTTP/1.1 503 x\r\ncontent-length: 24\r\n\r\n{"refuses":["starting"]}')
        line = self.failing("--ready", "--url", f"http://127.0.0.1:{program.port}")
        self.assertEqual(line, 'not ready: {"refuses":["starting"]}\n')

    def test_a_silent_server_is_given_up(self):
        program = self.answering()
        self.assertIn("not done within 5000 ms", self.failing("--url", f"http://127.0.0.1:{program.port}"))

    def test_garbage_is_not_healthy(self):
        program = self.answering(b"220 mail.example.org ESMTP\r\n")
        self.assertIn("read: ", self.failing("--url", f"http://127.0.0.1:{program.port}"))
        page = self.answering(b"HTTP/1.1 200 OK\r\ncontent-length: 6\r\n\r\n<html>")
        line = self.failing("--url", f"http://127.0.0.1:{page.port}")
        self.assertIn("answers 200, and not as uplinkd does: <html>", line)
        endless = self.answering(b"HTTP/1.1 200 OK\r\ncontent-length: 99999\r\n\r\n" + b"a" * 99999)
        self.assertIn("body limit", self.failing("--url", f"http://127.0.0.1:{endless.port}"))

    def test_ipv6_is_asked(self):
        body = b'{"relayLastHandshakeSeconds":0}'
        answer = b"HTTP/1.1 200 OK\r\ncontent-length: %d\r\n\r\n%s" % (len(body), body)
        program = self.answering(answer, socket.AF_INET6)
        self.assertIn("alive: ", uplinkctl("health", "--url", f"http://[::1]:{program.port}").stdout)
        self.assertIn(b"\r\nHost: [::1]:%d\r\n" % program.port, program.asked[0])

    def test_wrong_use_ends_with_2(self):
        for arguments in (
            ["--url", "ftp://127.0.0.1:1"], ["--url", "127.0.0.1:1"], ["--url", "http://a:1", "--config", "b"],
            ["--config", self.folder / "nowhere.toml"], ["--config", self.server().configuration()],
        ):  # fmt: skip
            with self.subTest(arguments):
                uplinkctl("health", *arguments, code=2)


if __name__ == "__main__":
    unittest.main()
