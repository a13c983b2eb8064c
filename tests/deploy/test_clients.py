"""Clients that are generated from openapi.yaml, in Python and TypeScript: each calls every operation of a real server,
and its types take what comes back."""

import json
import os
import pathlib
import subprocess

# Makes tests/e2e importable.
import images  # noqa: F401
from openapi import FILE
from openapi_server import LISTS, Served

PYTHON = pathlib.Path(os.environ["UPLINK_CLIENTS_VENV"]) / "bin"
NPM = pathlib.Path(os.environ["UPLINK_CLIENTS_NPM"]) / "node_modules"
SECONDS = 300
# The generator knows no media type for YAML.
SETTINGS = "post_hooks: []\ncontent_type_overrides: {application/yaml: text/plain}\n"
PYTHON_CALLS = '''
import importlib, json, sys
from uplinkd_client import Client

client, told = Client(base_url=sys.argv[1]), {}
for name, tag, parameters in json.loads(sys.argv[2]):
    operation = importlib.import_module(f"uplinkd_client.api.{tag}.{name}")
    answer = operation.sync_detailed(client=client, **parameters)
    told[name] = [int(answer.status_code), type(answer.parsed).__name__]
print(json.dumps(told))
'''
TYPESCRIPT_HEAD = """
import createClient from "openapi-fetch";
import type { paths } from "./api.js";
declare const process: { argv: string[] };
const json = createClient<paths, "application/json">({ baseUrl: process.argv[2]! });
const text = createClient<paths>({ baseUrl: process.argv[2]! });
const told: Record<string, unknown> = {};
"""
TYPESCRIPT_OPTIONS = {"strict": True, "noUncheckedIndexedAccess": True, "skipLibCheck": True, "types": [],
                      "lib": ["es2022", "dom"], "target": "es2022", "module": "nodenext",
                      "moduleResolution": "nodenext"}  # fmt: skip


def run(*command, folder, code=0):
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=SECONDS, check=False)
    assert done.returncode == code, f"{command}: {done.returncode}\n{done.stdout}\n{done.stderr}"
    return done.stdout


class Clients(Served):
    def needed(self, operation, ruri, *places):
        """The parameters without which the operation is not asked."""
        found = (self.document.look_up(item) for item in operation.get("parameters", []))
        return {
            each["name"]: ruri if each["name"] == "ruri" else self.document.look_up(each["schema"])["enum"][0]
            for each in found
            if each.get("required") and each["in"] in places
        }

    def assert_told(self, told):
        """Each operation was called once, and answered."""
        self.assertEqual(set(told), {operation["operationId"] for operation in self.operations.values()})
        for name, (status, what) in told.items():
            with self.subTest(name):
                self.assertEqual(status, 200)
                self.assertNotIn(what, ("NoneType", "undefined", "Error"))

    def test_python_calls_every_operation(self):
        (self.folder / "settings.yaml").write_text(SETTINGS, encoding="utf-8")
        out = run(PYTHON / "openapi-python-client", "generate", "--path", FILE, "--meta", "none", "--output-path",
                  self.folder / "uplinkd_client", "--config", "settings.yaml", folder=self.folder)  # fmt: skip
        self.assertNotIn("WARNING", out)
        server, fleet = self.play()
        fleet.finish()
        ruri = self.ruri(server)
        calls = [
            (operation["operationId"], operation["tags"][0], self.needed(operation, ruri, "path", "query"))
            for operation in self.operations.values()
        ]
        (self.folder / "calls.py").write_text(PYTHON_CALLS, encoding="utf-8")
        told = run(PYTHON / "python", "calls.py", f"http://{server.http}", json.dumps(calls), folder=self.folder)
        self.assert_told(json.loads(told))

    def typescript(self, ruri):
        """A program that calls each operation, and uses the rows of each list by their types."""
        lines = [TYPESCRIPT_HEAD]
        for path, operation in self.operations.items():
            name = operation["operationId"]
            params = {place: self.needed(operation, ruri, place) for place in ("path", "query")}
            init = {"params": {place: given for place, given in params.items() if given}}
            is_json = "application/json" in self.document.response(operation, 200)["content"]
            client = "json" if is_json else "text"
            if not is_json:
                init["parseAs"] = "text"
            lines.append(f"{{ const answer = await {client}.GET({json.dumps(path)}, {json.dumps(init)} as const);")
            if name in LISTS:
                lines.append(f"  if (answer.data) for (const row of answer.data.{LISTS[name]}) void row;")
            lines.append(f"  told[{json.dumps(name)}] = [answer.response.status, typeof answer.data]; }}")
        return "\n".join([*lines, "console.log(JSON.stringify(told));\n"])

    def test_typescript_calls_every_operation(self):
        (self.folder / "node_modules").symlink_to(NPM)
        (self.folder / "package.json").write_text('{"type": "module"}', encoding="utf-8")
        options = {"compilerOptions": TYPESCRIPT_OPTIONS, "files": ["calls.ts"]}
        (self.folder / "tsconfig.json").write_text(json.dumps(options), encoding="utf-8")
        run(NPM / ".bin/openapi-typescript", FILE, "-o", "api.ts", folder=self.folder)
        server, fleet = self.play()
        fleet.finish()
        program = self.typescript(self.ruri(server))
        (self.folder / "calls.ts").write_text(program, encoding="utf-8")
        run(NPM / ".bin/tsc", "-p", ".", folder=self.folder)
        self.assert_told(json.loads(run("node", "calls.js", f"http://{server.http}", folder=self.folder)))
        # The types know the members: another name is an error.
        self.assertIn(".events)", program)
        (self.folder / "calls.ts").write_text(program.replace(".events)", ".happenings)"), encoding="utf-8")
        self.assertIn("happenings", run(NPM / ".bin/tsc", "-p", ".", folder=self.folder, code=2))
