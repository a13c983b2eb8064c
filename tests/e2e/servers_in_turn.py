"""Two servers of a crash campaign, each killed in turn."""


class ServersInTurn:
    """Part of a campaign with a second server beside `self.servers[0]`. One that was killed comes back at
    once, or only before the next one goes."""

    turn = 0
    down = None

    def add_server(self, folder, new_server):
        """It has the first one's certificates."""
        other = folder / "other"
        other.mkdir()
        (other / "pki").symlink_to(folder / "pki")
        self.servers.append(new_server(other))

    def kill_server(self):
        self.raise_server()
        victim = self.servers[self.turn]
        self.turn = 1 - self.turn
        victim.kill()
        self.down = victim
        if self.random.random() < 0.5:
            self.raise_server()

    def raise_server(self):
        if self.down is not None:
            self.start_server(self.down)
            self.down = None
