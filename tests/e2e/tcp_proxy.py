"""A TCP proxy on loopback that can be cut and mended, and that chooses where new connections go."""

import contextlib
import enum
import socket
import threading

CHUNK_BYTES = 1 << 16
CONNECT_SECONDS = 5
# More than the robots and the database sessions of a test together.
BACKLOG = 256


class Cut(enum.Enum):
    """How a way is cut."""

    # What was connected ends, what is new is turned away: a port that is blocked, a pooler that stopped.
    REFUSE = "refuse"
    # Connections stand, and not a byte passes until the way is mended: a cable that is pulled out.
    BLACK_HOLE = "black hole"


def close_both(sockets):
    """Also wakes the threads that wait in them."""
    for end in sockets:
        with contextlib.suppress(OSError):
            end.shutdown(socket.SHUT_RDWR)
        end.close()


class TcpProxy:
    """Leads from a free port of loopback to `targets`, each HOST:PORT.

    New connections go to the target that was chosen last; with `any_other`, to the next one that
    takes them if that one does not. `in_turn` chooses the next target for each connection.
    """

    def __init__(self, *targets, any_other=False, in_turn=False):
        self.targets = list(targets)
        self.any_other = any_other
        self.in_turn = in_turn
        self.chosen = 0
        self.connections = {}
        # Those whose server was not told that its client is gone.
        self.half_open = set()
        self.lock = threading.Lock()
        self.passing = threading.Event()
        self.passing.set()
        self.refusing = False
        self.listener = socket.create_server(("127.0.0.1", 0), backlog=BACKLOG)
        self.address = "%s:%d" % self.listener.getsockname()
        threading.Thread(target=self._accept, daemon=True).start()

    @property
    def port(self):
        return int(self.address.rsplit(":", 1)[1])

    def choose(self, target):
        """Where new connections go from now on, by its place in the list."""
        self.chosen = target

    def drop(self, target=None):
        """Ends the connections to this target, or all of them."""
        with self.lock:
            dropped = [ends for ends, to in self.connections.items() if target in (None, to)]
        for ends in dropped:
            close_both(ends)

    def part(self, target):
        """Ends the connections to this target at their clients alone: the target is told nothing, and what
        it says goes nowhere. So does a network that cuts off a client that leaves it."""
        with self.lock:
            parted = [ends for ends, to in self.connections.items() if to == target]
            self.half_open.update(parted)
        for client, _ in parted:
            close_both([client])

    def cut(self, how):
        if how is Cut.BLACK_HOLE:
            self.passing.clear()
        else:
            self.refusing = True
            self.drop()

    def mend(self):
        self.refusing = False
        self.passing.set()

    def close(self):
        close_both([self.listener])
        self.refusing = True
        self.passing.set()
        self.drop()

    def _accept(self):
        while True:
            try:
                client, _ = self.listener.accept()
            except OSError:
                return
            threading.Thread(target=self._serve, args=(client,), daemon=True).start()

    def _order(self):
        """The places of the targets in the order in which they are tried."""
        with self.lock:
            first = self.chosen
            if self.in_turn:
                self.chosen = (first + 1) % len(self.targets)
        count = len(self.targets) if self.any_other else 1
        return [(first + i) % len(self.targets) for i in range(count)]

    def _connect(self):
        """A connection to the first target that takes one, and its place; or nothing."""
        for place in self._order():
            host, port = self.targets[place].rsplit(":", 1)
            try:
                return socket.create_connection((host, int(port)), CONNECT_SECONDS), place
            except OSError:
                continue
        return None, None

    def _serve(self, client):
        self.passing.wait()
        server, place = (None, None) if self.refusing else self._connect()
        if server is None:
            close_both([client])
            return
        server.settimeout(None)
        ends = (client, server)
        for end in ends:
            end.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        with self.lock:
            self.connections[ends] = place
        if self.refusing:
            close_both(ends)
        back = threading.Thread(target=self._pass_on, args=(ends, server, client), daemon=True)
        back.start()
        self._pass_on(ends, client, server)
        back.join()
        with self.lock:
            del self.connections[ends]
            self.half_open.discard(ends)
        close_both(ends)

    def _take(self, _ends, _source, data):
        """The part of the data to pass on. `ends`: client and server."""
        return data

    def _pass_on(self, ends, source, sink):
        """Until the source ends, which the sink is told, or either breaks."""
        try:
            while data := source.recv(CHUNK_BYTES):
                self.passing.wait()
                sink.sendall(self._take(ends, source, data))
            self.passing.wait()
            if ends not in self.half_open:
                sink.shutdown(socket.SHUT_WR)
        except OSError:
            if ends not in self.half_open:
                close_both([source, sink])
            elif source is ends[1]:
                self._swallow(source)

    def _swallow(self, source):
        """Until the source ends."""
        with contextlib.suppress(OSError):
            while source.recv(CHUNK_BYTES):
                pass
