"""The crash campaign with a broker and two servers on one PostgreSQL, which share a client id: one of them
reads the broker, and the other one once it is over."""

import signal

from broker_chaos import BrokerCampaign
from broker_watch import scrape
from servers_in_turn import ServersInTurn

# Longer than its lease lasts (30 s), on a busy machine.
STALL_SECONDS = 120


class PairCampaign(ServersInTurn, BrokerCampaign):
    def __init__(self, folder, seed):
        super().__init__(folder, "postgres", seed)
        self.add_server(folder, self.new_server)
        self.kinds |= {"leave": 2, "stall": 0.25}

    def kill(self, kind):
        match kind:
            case "leave":
                self.leave()
            case "stall":
                self.stall()
            case _:
                return super().kill(kind)
        return True

    def holder(self):
        """The one that reads the broker; nothing while none does."""
        for server in self.servers:
            if server is not self.down and (sums := scrape(server)) and sums["lease_held"] == 1:
                return server
        return None

    def leave(self):
        """The one that reads the broker ends in order."""
        self.raise_server()
        server = self.wait(self.holder, "one of them reads the broker")
        self.end(server)
        self.start_server(server)

    def stall(self):
        """It stands still until the other one has taken over, and goes on."""
        self.raise_server()
        server = self.wait(self.holder, "one of them reads the broker")
        other = next(each for each in self.servers if each is not server)
        server.process.send_signal(signal.SIGSTOP)
        try:
            self.wait(lambda: (scrape(other) or {}).get("lease_held") == 1, "the other one takes over",
                      STALL_SECONDS)  # fmt: skip
        finally:
            server.process.send_signal(signal.SIGCONT)

    def compare(self):
        self.raise_server()
        super().compare()
