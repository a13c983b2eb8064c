"""front.py RELAY_PORT HTTP_PORT FILE: one address for pods that come and go. FILE holds a line `IP PID` for each
pod of now: connections to RELAY_PORT go to their relays in turn, those to HTTP_PORT to the loopback of the first
one's network, where the API answers. Without a pod a connection is closed."""

import ctypes
import itertools
import os
import pathlib
import socket
import sys
import threading

RELAY, API = 7443, 7480
CLONE_NEWNET = 0x40000000
TURN = itertools.count()
LIBC = ctypes.CDLL(None, use_errno=True)


def enter(path):
    """Takes this thread, alone, into a network."""
    descriptor = os.open(path, os.O_RDONLY)
    try:
        if LIBC.setns(descriptor, CLONE_NEWNET) != 0:
            raise OSError(ctypes.get_errno(), "setns")
    finally:
        os.close(descriptor)


def dial(kind, address, pid):
    if kind == "relay":
        return socket.create_connection((address, RELAY), 5)
    # A socket stays in the network in which it was made.
    enter(f"/proc/{pid}/ns/net")
    made = socket.socket()
    made.settimeout(5)
    made.connect(("127.0.0.1", API))
    return made


def pump(source, target):
    try:
        while data := source.recv(65536):
            target.sendall(data)
    except OSError:
        pass
    for end in (source, target):
        try:
            end.shutdown(socket.SHUT_RDWR)
        except OSError:
            pass


def pods_in(file):
    """Address and process of each pod; lines that are empty, or written only in part, name none."""
    words = (line.split() for line in file.read_text(encoding="utf-8").splitlines())
    return [tuple(each) for each in words if len(each) == 2]


def serve(client, kind, file):
    try:
        pods = pods_in(file)
        server = dial(kind, *pods[next(TURN) % len(pods) if kind == "relay" else 0]) if pods else None
    except OSError:
        server = None
    if server is None:
        client.close()
        return
    server.settimeout(None)
    back = threading.Thread(target=pump, args=(server, client), daemon=True)
    back.start()
    pump(client, server)
    back.join()
    client.close()
    server.close()


def listen(kind, port, file):
    with socket.create_server(("127.0.0.1", port), backlog=512) as listener:
        while True:
            client, _ = listener.accept()
            threading.Thread(target=serve, args=(client, kind, file), daemon=True).start()


def main():
    file = pathlib.Path(sys.argv[3])
    threading.Thread(target=listen, args=("http", int(sys.argv[2]), file), daemon=True).start()
    listen("relay", int(sys.argv[1]), file)


if __name__ == "__main__":
    main()
