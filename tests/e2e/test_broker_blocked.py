"""Twins that an operator blocked, or did not add: a real broker's messages of them are acked, counted and dropped."""

import unittest

from broker_messages import A, B, SECONDS, MessageTest, event, numbers_of, position, topic, twin
from harness import uplinkctl, wait_until

CLOSED = "\n[identity]\nregistration = \"closed\"\n"


class Blocked(MessageTest):
    def ctl(self, server, *arguments):
        return uplinkctl(*arguments, "--server", f"http://{server.http}").stdout

    def wait_for_block(self, server, ruri, blocked):
        def look():
            return any(row["ruri"] == ruri and row["blocked"] == blocked for row in server.get("/api/v1/robots")["robots"])

        wait_until(server.process, look, SECONDS, "the word of the operator")

    def test_messages_of_a_blocked_twin_are_dropped_until_it_is_unblocked(self):
        server = self.serve()
        client = self.client("publisher")
        client.publish(topic(A, "event"), event(1), qos=1)
        self.assertEqual(self.outcomes(server, 1), {"stored": 1})
        self.ctl(server, "robots", "block", twin(A))
        self.wait_for_block(server, twin(A), True)
        client.publish(topic(A, "event"), event(2), qos=1)
        client.publish(topic(A, "position"), position(2))
        client.publish(topic(A, "position"), "no json")
        client.publish(topic(B, "event"), event(3), qos=1)
        self.assertEqual(self.outcomes(server, 5), {"stored": 2, "blocked": 3})
        self.ctl(server, "robots", "unblock", twin(A))
        self.wait_for_block(server, twin(A), False)
        client.publish(topic(A, "event"), event(4), qos=1)
        self.assertEqual(self.outcomes(server, 6), {"stored": 3, "blocked": 3})
        self.assertEqual(sorted(numbers_of(self.history(server, twin(A), "events"))), [1, 4])

    def test_where_registration_is_closed_a_new_twin_is_a_candidate(self):
        server = self.serve(more=CLOSED)
        client = self.client("publisher")
        client.publish(topic(A, "event"), event(1), qos=1)
        self.assertEqual(self.outcomes(server, 1), {"blocked": 1})
        [candidate] = server.get("/api/v1/candidates")["candidates"]
        self.assertEqual(candidate["ruri"], twin(A))


if __name__ == "__main__":
    unittest.main()
