"""Everything of /api/v1 that a client may rely on, a line each, from fleet.proto and openapi.yaml.

    UPLINK_BIN_DIR=. python3 api_surface.py           prints what tests/fixtures/api/frozen.txt lacks
    UPLINK_BIN_DIR=. python3 api_surface.py --write   adds it there

A line never goes: what is promised only grows.
"""

import sys

from fleet_contract import contract
from harness import SOURCE
from openapi import Document

FILE = SOURCE / "tests/fixtures/api/frozen.txt"
HEAD = """\
# What clients of /api/v1 and of FleetView rely on. test_api_frozen.py fails when a line is no longer true;
# tests/e2e/api_surface.py adds what is new. Lines never go; of a bound that widens the number is edited.
"""


def kind(schema):
    """The type of a schema as one word, such as string:date-time or array<Robot>."""
    if "$ref" in schema:
        return schema["$ref"].rpartition("/")[2]
    for keyword in ("anyOf", "oneOf"):
        if keyword in schema:
            return "|".join(sorted(map(kind, schema[keyword])))
    if schema.get("type") == "array" and "items" in schema:
        return f"array<{kind(schema['items'])}>"
    if isinstance(schema.get("additionalProperties"), dict):
        return f"map<{kind(schema['additionalProperties'])}>"
    return ":".join(filter(None, [schema.get("type", "any"), schema.get("format")]))


def of_schema(where, schema):
    """What a reader of this value relies on: type, words, members, and which are always there."""
    yield f"{where} is {kind(schema)}"
    for word in schema.get("enum", []):
        yield f"{where} may be {word!r}"
    for keyword in ("anyOf", "oneOf"):
        for each in schema.get(keyword, []):
            if "$ref" not in each:
                yield from (line for line in of_schema(where, each) if not line.startswith(f"{where} is "))
    for name in schema.get("required", []):
        yield f"{where} always has {name}"
    for name, member in schema.get("properties", {}).items():
        yield from of_schema(f"{where}.{name}", member)
    for name in ("items", "additionalProperties", "propertyNames"):
        if isinstance(schema.get(name), dict) and "$ref" not in schema[name]:
            yield from of_schema(f"{where}[]" if name != "propertyNames" else f"{where}<name>", schema[name])


def of_operation(document, path, operation):
    for item in operation.get("parameters", []):
        parameter = document.look_up(item)
        where = f"{path} ?{parameter['name']}"
        needed = "needed" if parameter.get("required") else "not needed"
        yield f"{where} in {parameter['in']}, {needed}"
        schema = document.look_up(parameter["schema"])
        yield from of_schema(where, schema)
        for keyword in ("minimum", "maximum", "minLength", "default"):
            if keyword in schema:
                yield f"{where} {keyword} {schema[keyword]}"
    for status in operation["responses"]:
        response = document.response(operation, status)
        yield f"{path} answers {status}"
        for name in response.get("headers", {}):
            yield f"{path} answers {status} with header {name}"
        for media, content in response.get("content", {}).items():
            yield f"{path} answers {status} as {media}: {kind(content['schema'])}"


def of_command(document, path, operation):
    body = operation["requestBody"]["content"]["application/json"]["schema"]
    yield f"{path} takes POST of {kind(body)}"
    yield from of_operation(document, path, operation)


def of_document(document):
    for path, operation in document.operations().items():
        if path.startswith("/api/"):
            yield from of_operation(document, path, operation)
    for path, operation in document.commands().items():
        yield from of_command(document, path, operation)
    for name, schema in document.root["components"]["schemas"].items():
        yield from of_schema(name, schema)


def of_message(descriptor, seen):
    if descriptor.full_name in seen or descriptor.full_name.startswith("google."):
        return
    seen.add(descriptor.full_name)
    for field in descriptor.fields:
        type_name = field.message_type.full_name if field.message_type else f"type {field.type}"
        repeated = "repeated " if field.label == field.LABEL_REPEATED else ""
        yield f"{descriptor.full_name} {field.number} {field.name}: {repeated}{type_name}"
        if field.message_type is not None:
            yield from of_message(field.message_type, seen)


def of_service(service):
    seen = set()
    for method in service.methods:
        yield f"{service.full_name} {method.name}({method.input_type.name}) returns {method.output_type.name}"
        yield from of_message(method.input_type, seen)
        yield from of_message(method.output_type, seen)


def surface(document, service):
    return sorted({*of_document(document), *of_service(service)})


def frozen():
    lines = FILE.read_text(encoding="utf-8").splitlines() if FILE.exists() else []
    return [line for line in lines if line and not line.startswith("#")]


def main():
    new = sorted(set(surface(Document(), contract())) - set(frozen()))
    if sys.argv[1:] == ["--write"]:
        FILE.write_text(HEAD + "".join(f"{line}\n" for line in sorted({*frozen(), *new})), encoding="utf-8")
    print("\n".join(new))


if __name__ == "__main__":
    main()
