"""A client of listen.fleet: Python's gRPC library, of Debian.

Run by test_fleet_rpc.py with the system's Python, which has that library. Reads what to do as JSON, and
prints what came of each call; or, to follow one stream, each answer as a line, and its end.
"""

import json
import sys
import threading

import grpc
from google.protobuf import descriptor_pb2, descriptor_pool, json_format, message_factory

PATIENCE_SECONDS = 30
LARGEST = (("grpc.max_receive_message_length", 64 * 1024 * 1024),)


def read(path):
    with open(path, "rb") as file:
        return file.read()


def channel_of(task):
    pair = [read(task[name]) if task.get(name) else None for name in ("key", "certificate")]
    credentials = grpc.ssl_channel_credentials(read(task["ca"]), *pair)
    return grpc.secure_channel(task["target"], credentials, LARGEST)


def pool_of(files):
    pool = descriptor_pool.DescriptorPool()
    for each in descriptor_pb2.FileDescriptorSet.FromString(read(files)).file:
        pool.Add(each)
    return pool


def method_of(channel, pool, path):
    service, name = path.strip("/").split("/")
    method = pool.FindServiceByName(service).FindMethodByName(name)
    factory = message_factory.MessageFactory(pool)
    into, out = (factory.GetPrototype(each) for each in (method.input_type, method.output_type))
    return into, out


def many(factory, path, into, out, requests, metadata, take):
    """Answers of a stream until it ends, or until there are `take`."""
    call = factory(path, request_serializer=into.SerializeToString, response_deserializer=out.FromString)
    answers = []
    running = call(requests, metadata=metadata, timeout=PATIENCE_SECONDS)
    for answer in running:
        answers.append(json_format.MessageToDict(answer))
        if len(answers) == take:
            running.cancel()
            break
    return answers


def follow(channel, pool, path, request, metadata):
    into, out = method_of(channel, pool, path)
    call = channel.unary_stream(path, request_serializer=into.SerializeToString, response_deserializer=out.FromString)
    try:
        for answer in call(json_format.ParseDict(request, into()), metadata=metadata, timeout=PATIENCE_SECONDS):
            print(json.dumps(json_format.MessageToDict(answer)), flush=True)
        end = {"code": "OK"}
    except grpc.RpcError as error:
        end = {"code": error.code().name, "details": error.details()}
    print(json.dumps({"end": end}), flush=True)


def hold(task, path, count):
    """So many calls, 50 by a connection, whose requests never come; until this process is killed."""
    credentials = grpc.ssl_channel_credentials(read(task["ca"]))
    never = threading.Event()

    def nothing():
        never.wait()
        yield from ()

    held = []
    for at in range(count):
        if at % 50 == 0:
            options = (("grpc.use_local_subchannel_pool", 1),)
            channel = grpc.secure_channel(task["target"], credentials, options)
            grpc.channel_ready_future(channel).result(PATIENCE_SECONDS)
        call = channel.stream_stream(path, request_serializer=bytes, response_deserializer=bytes)
        held.append((channel, call(nothing())))
    # Calls are in order on a connection: once a whole one is answered, those before it are there.
    for channel in dict.fromkeys(channel for channel, _ in held):
        channel.unary_unary(path, request_serializer=bytes, response_deserializer=bytes)(b"", timeout=PATIENCE_SECONDS)
    print("held", flush=True)
    never.wait()


def ask(channel, pool, path, request, kind, metadata, take):
    into, out = method_of(channel, pool, path)
    try:
        if kind == "unary":
            call = channel.unary_unary(path, request_serializer=into.SerializeToString, response_deserializer=out.FromString)
            answer = call(json_format.ParseDict(request, into()), metadata=metadata, timeout=PATIENCE_SECONDS)
            return {"code": "OK", "answer": json_format.MessageToDict(answer, including_default_value_fields=True)}
        if kind == "watch":
            answers = many(channel.unary_stream, path, into, out, json_format.ParseDict(request, into()), metadata, take)
        else:
            requests = iter([json_format.ParseDict(each, into()) for each in request])
            answers = many(channel.stream_stream, path, into, out, requests, metadata, take)
        return {"code": "OK", "answers": answers}
    except grpc.RpcError as error:
        return {"code": error.code().name, "details": error.details()}


def main():
    task = json.load(sys.stdin)
    pool = pool_of(task["files"])
    metadata = (("authorization", f"Bearer {task['token']}"),) if task.get("token") else ()
    if "hold" in task:
        return hold(task, *task["hold"])
    with channel_of(task) as channel:
        if "follow" in task:
            return follow(channel, pool, *task["follow"], metadata)
        seen = [
            ask(channel, pool, path, request, kind, metadata, take)
            for path, request, kind, take in task["calls"]
        ]  # fmt: skip
    return json.dump(seen, sys.stdout)


main()
