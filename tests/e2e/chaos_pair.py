"""The crash campaign with two servers on one PostgreSQL, each killed in turn.

Robots connect to either server alternately, and to the one that serves if the other does not. A server
that was killed comes back at once, or only before the next one is killed: the other one then has its
robots, and those that do not come at once it adopts. All robots stream all the time, so no history
of presence may say `offline`, and no row may repeat the one before.
"""

from chaos import Campaign
from harness import Server
from servers_in_turn import ServersInTurn
from tcp_proxy import TcpProxy

# A robot that waits for an Ack says nothing while a killed cluster recovers. A server that judged
# robots of the other one would do so soon after its start.
SETTINGS = """[presence]
timeout = "30s"
startup_grace = "5s"
"""
# Robots whose history is wrong: rows that say offline, rows that change nothing, and all of them.
WRONG = """WITH changes AS (
  SELECT ruri, presence, changed_at, entry, lag(presence) OVER (PARTITION BY ruri ORDER BY entry) AS before
  FROM uplinkd.presence_changes)
SELECT ruri, count(*) FILTER (WHERE presence = 2), count(*) FILTER (WHERE presence = before),
  string_agg(to_char(changed_at, 'HH24:MI:SS.MS ') || (ARRAY['unknown', 'online', 'offline'])[presence + 1],
             ', ' ORDER BY entry)
FROM changes GROUP BY ruri HAVING count(*) FILTER (WHERE presence IN (2, before)) > 0 ORDER BY ruri"""


class PairCampaign(ServersInTurn, Campaign):
    def __init__(self, folder, seed):
        super().__init__(folder, "postgres", seed)
        self.add_server(folder, lambda other: Server(other, store_url=self.store.url))
        for server in self.servers:
            server.settings = SETTINGS
        self.road = None
        self.offline = self.repeated = 0

    def port(self):
        if self.road is None:
            self.road = TcpProxy(*(server.relay for server in self.servers), any_other=True, in_turn=True)
        return self.road.port

    def compare(self):
        super().compare()
        self.offline = self.repeated = 0
        for line in self.store.sql(WRONG).splitlines():
            _, offline, repeated, _ = line.split("|")
            self.offline += int(offline)
            self.repeated += int(repeated)
            self.wrong.append(line)

    def finish(self):
        self.raise_server()
        super().finish()

    def line(self):
        return f"{super().line()}, offline {self.offline}, repeated {self.repeated}"

    def close(self):
        super().close()
        if self.road is not None:
            self.road.close()
