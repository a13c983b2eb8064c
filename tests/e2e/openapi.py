"""The OpenAPI file of the HTTP paths, and what it says of an answer."""

import json
import urllib.error
import urllib.parse
import urllib.request

from harness import SOURCE

try:
    import jsonschema
    import yaml
except ImportError as error:
    raise ImportError(
        f"{error.name} is missing: install python3-jsonschema and python3-yaml, or run ./dev setup"
    ) from error

FILE = SOURCE / "docs" / "reference" / "openapi.yaml"


class Answer:
    """What came back: status, the content type as it stands in the header, the body as text."""

    def __init__(self, status, headers, body):
        self.status = status
        self.content_type = headers["Content-Type"]
        self.allow = headers["Allow"]
        self.body = body

    def json(self):
        return json.loads(self.body)


def request(server, target, method="GET", headers=None):
    asked = urllib.request.Request(f"http://{server.http}{target}", method=method, headers=headers or {})
    try:
        with urllib.request.urlopen(asked, timeout=120) as answer:
            return Answer(answer.status, answer.headers, answer.read().decode("utf-8"))
    except urllib.error.HTTPError as answer:
        with answer:
            return Answer(answer.code, answer.headers, answer.read().decode("utf-8"))


class OnceLoader(yaml.SafeLoader):
    """YAML in which no name stands twice in a mapping: PyYAML takes the last one without a word."""

    def construct_mapping(self, node, deep=False):
        names = set()
        for key, _ in node.value:
            name = self.construct_object(key, deep=True)
            if name in names:
                raise ValueError(f"line {key.start_mark.line + 1}: {name!r} twice")
            names.add(name)
        return super().construct_mapping(node, deep)


def read_document(path):
    with path.open(encoding="utf-8") as file:
        return yaml.load(file, Loader=OnceLoader)


class Document:
    """The parsed file, with its references resolved where they are looked up."""

    def __init__(self):
        self.root = read_document(FILE)

    def look_up(self, item):
        while "$ref" in item:
            found = self.root
            for name in item["$ref"].removeprefix("#/").split("/"):
                found = found[name]
            item = found
        return item

    def operations(self):
        """Path to its GET; each path has that or a POST."""
        return {path: methods["get"] for path, methods in self.root["paths"].items() if "get" in methods}

    def commands(self):
        """Path to its POST."""
        return {path: methods["post"] for path, methods in self.root["paths"].items() if "post" in methods}

    def parameters(self, operation, where):
        found = [self.look_up(item) for item in operation.get("parameters", [])]
        return {item["name"]: self.look_up(item["schema"]) for item in found if item["in"] == where}

    def response(self, operation, status):
        return self.look_up(operation["responses"][str(status)])

    def problems(self, schema, value):
        """What is wrong with a value, as texts; empty if nothing is."""
        whole = {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}
        whole["components"] = self.root["components"]
        found = jsonschema.Draft202012Validator(whole).iter_errors(value)
        return [f"{'/'.join(map(str, error.absolute_path))}: {error.message}" for error in found]

    def named(self, name, value):
        return self.problems({"$ref": f"#/components/schemas/{name}"}, value)

    def answer_problems(self, response, answer):
        """What is wrong with an answer that this response object describes."""
        media = response["content"].get(answer.content_type)
        if media is None:
            return [f"content type {answer.content_type}, not one of {list(response['content'])}"]
        if answer.content_type != "application/json":
            return []
        return self.problems(media["schema"], answer.json())

    def schemas(self):
        """Every schema of the file and of its schemas, with where it stands."""
        for name, schema in self.root["components"]["schemas"].items():
            yield from schemas_within(f"schemas/{name}", schema)
        for kind in ("parameters", "responses"):
            for name, item in self.root["components"][kind].items():
                for media in (item, *item.get("content", {}).values(), *item.get("headers", {}).values()):
                    if "schema" in media:
                        yield from schemas_within(f"{kind}/{name}", media["schema"])


def schemas_within(where, schema):
    yield where, schema
    for keyword, value in schema.items():
        if keyword == "properties":
            for name, each in value.items():
                yield from schemas_within(f"{where}/{name}", each)
        elif keyword in ("anyOf", "oneOf", "prefixItems"):
            for at, each in enumerate(value):
                yield from schemas_within(f"{where}/{keyword}/{at}", each)
        elif keyword in ("items", "additionalProperties", "propertyNames") and isinstance(value, dict):
            yield from schemas_within(f"{where}/{keyword}", value)


def names_one(path):
    """Whether the answer is about one robot."""
    return "{ruri}" in path or path in ("/api/v1/robot", "/api/v1/robot/story")


def target(path, ruri, parameters=None):
    parameters = dict(parameters or {})
    if names_one(path) and "{ruri}" not in path:
        parameters.setdefault("ruri", ruri)
    query = urllib.parse.urlencode(parameters)
    return path.replace("{ruri}", urllib.parse.quote(ruri, safe="")) + ("?" + query if query else "")
