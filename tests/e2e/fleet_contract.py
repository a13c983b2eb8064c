"""The contract of fleet.proto as protoc reads it."""

import pathlib
import subprocess
import tempfile

from google.protobuf import descriptor_pb2, descriptor_pool
from harness import SOURCE


def contract(service="FleetView"):
    """A service of fleet.proto or admin.proto, and what makes its messages."""
    with tempfile.TemporaryDirectory(prefix="uplink-contract-") as folder:
        file = pathlib.Path(folder) / "fleet.bin"
        subprocess.run(["protoc", f"--proto_path={SOURCE / 'proto'}", "--include_imports",
                        f"--descriptor_set_out={file}", "uplink/v1/fleet.proto"], check=True)  # fmt: skip
        files = descriptor_pb2.FileDescriptorSet.FromString(file.read_bytes())
    pool = descriptor_pool.DescriptorPool()
    for each in files.file:
        pool.Add(each)
    return pool.FindServiceByName(f"uplink.v1.{service}")
