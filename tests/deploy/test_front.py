"""What the front of the cluster's test reads of its pods."""

import pathlib
import socket
import tempfile
import unittest

import front

WAIT_SECONDS = 10


class Pods(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.file = pathlib.Path(folder.name) / "pods"

    def test_a_line_names_a_pod(self):
        self.file.write_text("10.0.0.1 12\n10.0.0.2 13\n", encoding="utf-8")
        self.assertEqual(front.pods_in(self.file), [("10.0.0.1", "12"), ("10.0.0.2", "13")])

    def test_an_empty_line_or_half_of_one_names_none(self):
        self.file.write_text("\n10.0.0.1 12\n10.0.0.2\n", encoding="utf-8")
        self.assertEqual(front.pods_in(self.file), [("10.0.0.1", "12")])

    def test_without_a_pod_a_connection_is_closed(self):
        for text in ("", "\n", "10.0.0.1\n"):
            self.file.write_text(text, encoding="utf-8")
            for kind in ("relay", "http"):
                with self.subTest(text=text, kind=kind):
                    mine, theirs = socket.socketpair()
                    self.addCleanup(mine.close)
                    mine.settimeout(WAIT_SECONDS)
                    front.serve(theirs, kind, self.file)
                    self.assertEqual(mine.recv(1), b"")


if __name__ == "__main__":
    unittest.main()
