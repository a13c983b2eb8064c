"""A port for a program that cannot take port 0 and say which one it got."""

import contextlib
import secrets
import socket

# Below the range from which Linux takes ports for connections (32768 to 60999). A port of that range may belong
# to a connection of another test, or to one that just ended, from an address that was not tried.
FIRST, LAST = 20000, 32767
TRIES = 100


def free_port():
    """For TCP; free on every address of this machine when it was tried."""
    if socket.has_dualstack_ipv6():
        every_address = {"family": socket.AF_INET6, "dualstack_ipv6": True}
    else:
        every_address = {}
    for _ in range(TRIES):
        port = FIRST + secrets.randbelow(LAST - FIRST + 1)
        with contextlib.suppress(OSError), socket.create_server(("", port), **every_address):
            return port
    raise AssertionError(f"no free port between {FIRST} and {LAST}")
