"""The rules of OpenAPI 3.1.0 that tie parts of a document together, which no schema of a part can say."""

import collections
import re

METHODS = ("get", "put", "post", "delete", "options", "head", "patch", "trace")
STATUS = re.compile(r"[1-5][0-9]{2}|[1-5]XX|default")
BRACES = re.compile(r"\{([^{}]*)\}")


def flaws(root):
    """What is wrong with a document, as texts that begin with the place; empty if nothing is."""
    found = [f"{where}: {ref} leads nowhere" for where, ref in references(root) if look_up(root, ref) is None]
    # What is said below of what stands behind a reference needs it.
    return found or [*flaws_of_names(root), *flaws_of_operations(root)]


def references(value, where=""):
    """Place and text of every reference, those of discriminators too."""
    if isinstance(value, list):
        for at, each in enumerate(value):
            yield from references(each, f"{where}/{at}")
    if not isinstance(value, dict):
        return
    if isinstance(value.get("$ref"), str):
        yield where, value["$ref"]
    discriminator = value.get("discriminator")
    if isinstance(discriminator, dict):
        for name, ref in discriminator.get("mapping", {}).items():
            yield f"{where}/discriminator/mapping/{name}", ref
    for name, each in value.items():
        yield from references(each, f"{where}/{name}")


def look_up(root, ref):
    """What a reference within the document leads to; None if there is nothing."""
    if not ref.startswith("#/"):
        return None
    found = root
    for name in ref.removeprefix("#/").split("/"):
        name = name.replace("~1", "/").replace("~0", "~")
        if not isinstance(found, dict) or name not in found:
            return None
        found = found[name]
    return found


def resolved(root, item):
    seen = set()
    while "$ref" in item and item["$ref"] not in seen:
        seen.add(item["$ref"])
        item = look_up(root, item["$ref"])
    return item


def operations(root):
    """Path, method, the path's own members and the operation's, for each of them."""
    for path, item in root["paths"].items():
        for method in METHODS:
            if method in item:
                yield path, method, item, item[method]


def more_than_once(values):
    return [value for value, count in collections.Counter(values).items() if count > 1]


def flaws_of_names(root):
    ids = [operation.get("operationId") for _, _, _, operation in operations(root)]
    for name in more_than_once(one for one in ids if one is not None):
        yield f"paths: more than one operationId {name}"
    for shape in more_than_once(BRACES.sub("{}", path) for path in root["paths"]):
        yield f"paths: more than one path {shape}"


def flaws_of_operations(root):
    for path, method, item, operation in operations(root):
        where = f"{method} {path}"
        if not path.startswith("/"):
            yield f"{where}: begins without a slash"
        if "operationId" not in operation:
            yield f"{where}: no operationId"
        yield from flaws_of_parameters(root, where, item, operation)
        if not operation.get("responses"):
            yield f"{where}: no response"
        for status, response in operation.get("responses", {}).items():
            if not isinstance(status, str) or not STATUS.fullmatch(status):
                yield f"{where}: {status!r} is no status"
            if not resolved(root, response).get("description"):
                yield f"{where}: response {status} has no description"


def flaws_of_parameters(root, where, item, operation):
    lists = [[resolved(root, each) for each in one.get("parameters", [])] for one in (item, operation)]
    for each in lists:
        for name, place in more_than_once((one["name"], one["in"]) for one in each):
            yield f"{where}: more than one parameter {name} in {place}"
    # An operation's parameter overrides the one that its path has for all operations.
    declared = {(one["name"], one["in"]): one for each in lists for one in each}
    in_path = BRACES.findall(where)
    for name in more_than_once(in_path):
        yield f"{where}: {{{name}}} more than once"
    for name in dict.fromkeys(in_path):
        if (name, "path") not in declared:
            yield f"{where}: {{{name}}} is not declared"
    for (name, place), one in declared.items():
        if place == "path" and name not in in_path:
            yield f"{where}: parameter {name} is not in the path"
        if place == "path" and one.get("required") is not True:
            yield f"{where}: parameter {name} is not required"
        if ("schema" in one) == ("content" in one):
            yield f"{where}: parameter {name} has no schema"
