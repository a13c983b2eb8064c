"""The log of a real uplinkd: a reader that stalls, systemd's journal, and the level debug."""

import contextlib
import http.client
import os
import re
import signal
import socket
import subprocess
import unittest
import urllib.error
import urllib.request

from harness import BIN, LISTENING, START_SECONDS, EndToEnd, Server, wait_until

ROUND_SECONDS = 30
DRAIN_SECONDS = 10
# From SIGTERM to the exit: the drain, and what the log waits for its reader (kFlushWait).
END_SECONDS = DRAIN_SECONDS + 5
# More than wait for the reader (LineQueue::kLinesMax) and fit into the pipe.
REQUESTS_MAX = 20_000
LINE = re.compile(r"(<\d>)?\d{4}-\d\d-\d\dT[^ ]+Z (debug|info|warn|error) ")
LOST = re.compile(r" warn log_lines_lost lines=(\d+)\n")


class PipedServer(Server):
    """An uplinkd whose log goes into a pipe, which is read when the test wants it."""

    def start(self):
        self.reader, self.writer = os.pipe()
        os.set_blocking(self.reader, False)
        self.came = b""
        self.process = subprocess.Popen(
            [str(self.program), "--config", str(self.configuration())],
            stdout=self.writer, stderr=self.writer, env={**os.environ, **self.environment},
        )  # fmt: skip
        found = wait_until(self.process, lambda: LISTENING.search(self.text()), START_SECONDS, "uplinkd listens")
        self.relay, self.http = found.group(1), found.group(2)
        return self

    def text(self):
        with contextlib.suppress(BlockingIOError):
            while part := os.read(self.reader, 65536):
                self.came += part
        return self.came.decode(errors="replace")

    def fill(self):
        """Nothing more fits into the pipe."""
        # Of its own: O_NONBLOCK holds for all who share one.
        filler = os.open(f"/proc/self/fd/{self.writer}", os.O_WRONLY | os.O_NONBLOCK)
        with contextlib.suppress(BlockingIOError):
            while True:
                os.write(filler, b"." * 4096)
        with contextlib.suppress(BlockingIOError):
            while True:
                os.write(filler, b".")
        os.close(filler)

    def close(self):
        super().close()
        os.close(self.reader)
        os.close(self.writer)


class StalledReader(EndToEnd):
    def piped(self, settings=""):
        server = PipedServer(self.folder, settings)
        self.open_things.append(server)
        return server.start()

    def stored(self, server):
        return int((server.get("/api/v1/status") or {"uplinks": {"stored": 0}})["uplinks"]["stored"])

    def make_lines(self, server):
        """Of the thread of HTTP, signals and timers, and of those of the relay."""
        server.process.send_signal(signal.SIGHUP)
        host, port = server.relay.rsplit(":", 1)
        for _ in range(4):
            with contextlib.suppress(OSError), socket.create_connection((host, int(port)), timeout=5) as peer:
                peer.sendall(b"no TLS at all\r\n\r\n")
                peer.recv(100)

    def test_a_log_that_nobody_reads_stops_neither_acks_nor_livez_nor_the_end(self):
        server = self.piped(f'[drain]\ntimeout = "{DRAIN_SECONDS}s"')
        self.fleet(server, "--robots", 4, "--rate", 20)
        wait_until(server.process, lambda: self.stored(server) > 20, ROUND_SECONDS, "the fleet is at work")
        server.fill()
        self.make_lines(server)
        before = self.stored(server)
        server.wait_for_status(
            lambda status: int(status["uplinks"]["stored"]) > before + 100, ROUND_SECONDS, "acks go on"
        )
        livez = http.client.HTTPConnection(server.http, timeout=5)
        self.addCleanup(livez.close)
        livez.request("GET", "/livez")
        self.assertEqual(livez.getresponse().status, 200)
        self.assertGreaterEqual(server.metric("uplinkd_log_lines_waiting"), 2)
        self.assertEqual(server.terminate(END_SECONDS), 0)

    def test_a_reader_that_comes_back_gets_what_waited_and_how_much_was_lost(self):
        server = self.piped('[log]\nlevel = "debug"')
        server.fill()
        filled = len(server.came)
        client = http.client.HTTPConnection(server.http, timeout=30)
        self.addCleanup(client.close)
        for request in range(REQUESTS_MAX):
            client.request("GET", "/livez")
            client.getresponse().read()
            if request % 500 == 0 and server.metric("uplinkd_log_lines_dropped_total") > 0:
                break
        self.assertGreater(server.metric("uplinkd_log_lines_dropped_total"), 0)
        wait_until(server.process, lambda: LOST.search(server.text()), ROUND_SECONDS, "the loss is told")
        wait_until(
            server.process, lambda: server.text() and server.metric("uplinkd_log_lines_waiting") < 100,
            ROUND_SECONDS, "what waited was written",
        )  # fmt: skip
        told = sum(map(int, LOST.findall(server.text())))
        self.assertEqual(told, server.metric("uplinkd_log_lines_dropped_total"))
        written = server.came[filled:].decode().lstrip(".").splitlines()
        for line in written[:-1]:
            self.assertRegex(line, LINE)
        # Of one thread: two may hand over their lines in another order than they stamped them.
        self.assertGreater(len(written), 1000)
        times = [line.split(" ")[0] for line in written if " route=livez " in line]
        self.assertEqual(times, sorted(times))
        self.assertEqual(server.terminate(30), 0)
        self.assertIn(" info stopped\n", server.text())

    def test_a_start_that_fails_says_why(self):
        server = self.piped()
        second = PipedServer(self.folder)
        self.open_things.append(second)
        with self.assertRaisesRegex(AssertionError, "ended with 1"):
            second.start()
        self.assertIn(" error start_failed ", second.text())


class Journal(EndToEnd):
    """Standard error is what JOURNAL_STREAM names, or is not."""

    def lines(self, inode_off):
        server = self.server()
        # The file of its first start, whose inode stays.
        path = self.folder / "uplinkd-1.log"
        path.touch()
        found = path.stat()
        server.environment = {"JOURNAL_STREAM": f"{found.st_dev}:{found.st_ino + inode_off}"}
        server.start()
        server.process.send_signal(signal.SIGHUP)
        wait_until(server.process, lambda: " reloaded " in server.text(), ROUND_SECONDS, "a reload")
        self.assertEqual(server.terminate(30), 0)
        return server.text().splitlines()

    def test_lines_begin_with_their_priority(self):
        lines = self.lines(0)
        self.assertGreater(len(lines), 4)
        for line in lines:
            priority = {"info": "<6>", "warn": "<4>", "error": "<3>"}[LINE.match(line).group(2)]
            self.assertEqual(LINE.match(line).group(1), priority, line)

    def test_another_stream_gets_no_priorities(self):
        lines = self.lines(1)
        self.assertGreater(len(lines), 4)
        for line in lines:
            self.assertIsNone(LINE.match(line).group(1), line)


    def test_what_keeps_a_server_from_starting_has_its_priority(self):
        wrong = self.folder / "wrong.toml"
        wrong.write_text("[log]\nlevel = 7\nformat = 7\n")
        path = self.folder / "stderr"
        for arguments in (["--config", wrong], ["--config", wrong, "--check-config"],
                          ["--config", wrong, "--print-config"], ["--nonsense"]):  # fmt: skip
            for inode_off, begin in ((0, "<3>"), (1, "")):
                with self.subTest(arguments=arguments, inode_off=inode_off), path.open("wb") as stream:
                    found = path.stat()
                    environment = {"JOURNAL_STREAM": f"{found.st_dev}:{found.st_ino + inode_off}"}
                    done = subprocess.run([BIN / "uplinkd", *arguments], stdout=subprocess.DEVNULL, stderr=stream,
                                          env={**os.environ, **environment}, check=False, timeout=ROUND_SECONDS)  # fmt: skip
                    self.assertEqual(done.returncode, 2)
                    lines = path.read_text().splitlines()
                    # The configuration has several problems, the flags one.
                    self.assertGreaterEqual(len(lines), 1 if "--nonsense" in arguments else 2)
                    for line in lines:
                        self.assertEqual(line.startswith("<3>"), begin == "<3>", line)


class Debug(EndToEnd):
    def test_each_connection_stream_and_answer_is_a_line(self):
        server = self.server('[log]\nlevel = "debug"').start()
        fleet = self.fleet(server, "--robots", 2, "--rate", 10)
        server.wait_for_status(
            lambda status: int(status["streams"]) == 2 and int(status["uplinks"]["stored"]) > 2,
            ROUND_SECONDS, "the fleet is at work",
        )  # fmt: skip
        host, port = server.relay.rsplit(":", 1)
        with socket.create_connection((host, int(port)), timeout=ROUND_SECONDS) as peer:
            peer.sendall(b"no TLS at all\r\n\r\n")
            with contextlib.suppress(OSError):
                peer.recv(100)
        fleet.finish()
        with contextlib.suppress(urllib.error.HTTPError):
            urllib.request.urlopen(f"http://{server.http}/nothing", timeout=ROUND_SECONDS)
        for line in (
            r" debug connection_opened connection=\d+ peer=\S+ robot=\S*rcan://",
            r" debug connection_closed connection=\d+ ",
            r" debug handshake_failed connection=\d+ .* why=no_tls",
            r" debug stream_opened stream=\d+ peer=\S+ robot=\S*rcan://",
            r" debug stream_(ended|broken) stream=\d+ ",
            r" debug http_answered route=status status=200 ms=\d+",
            r" debug http_answered route=other status=404 ms=\d+",
        ):
            wait_until(server.process, lambda: re.search(line, server.text()), ROUND_SECONDS, line)


if __name__ == "__main__":
    unittest.main()
