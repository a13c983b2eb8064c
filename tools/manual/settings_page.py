"""The manual page uplinkd.toml(5), made from the example file, which the settings table generates."""

import re

from roff import Page, bold, escaped

SECTION = re.compile(r"^\[([a-z0-9_]+)\]$")
KEY = re.compile(r"^# ([a-z0-9_.]+) = (.*)$")
# What a person would take for a key.
LIKE_KEY = re.compile(r"^#\s*[\w.-]+\s*=")


def parts(example):
    """(section, key, default, comment): without a section the opening text, without a key a section's text."""
    section, comment = "", []
    for line in example.splitlines():
        head, key = SECTION.match(line), KEY.match(line)
        if head:
            section = head.group(1)
            yield section, None, None, comment
            comment = []
        elif key and section:
            yield section, key.group(1), key.group(2), comment
            comment = []
        elif LIKE_KEY.match(line):
            raise ValueError(f"the example file has a line that is like a key and is none: {line}")
        elif line.startswith("# "):
            comment.append(line[2:])
        elif not section and comment:
            yield None, None, None, comment
            comment = []
    if comment:
        raise ValueError(f"the example file ends in a comment: {comment}")


def texts_of(comment):
    """The sentences, and the lines that begin with what it takes and when it counts."""
    texts, rest = [], []
    for line in comment:
        if line.startswith(("Takes ", "Taken over ")):
            rest.append(line)
        elif rest:
            rest[-1] += " " + line
        else:
            texts.append(line)
    # "Takes" comes last and may go on over lines.
    return ["\n".join(texts), *rest]


def settings_page(example, version, date):
    page = Page("uplinkd.toml", 5, version, date)
    page.head("NAME").raw(f"{bold('uplinkd.toml')} \\- configuration of uplinkd")
    page.head("SYNOPSIS").raw(escaped("/etc/uplinkd/uplinkd.toml"))
    page.head("DESCRIPTION")
    found = 0
    for section, key, default, comment in parts(example):
        if section is None:
            # In the file each key is a comment; here none is.
            page.paragraph("\n".join(comment).replace(" commented,", ""))
        elif key is None:
            page.head(f'"[{section}]"')
            if comment:
                page.paragraph("\n".join(comment))
        else:
            page.entry(f"{bold(f'{section}.{key}')} = {escaped(default)}", *texts_of(comment))
            found += 1
    if not found:
        raise ValueError("the example file has no key: the pattern is out of date")
    return page.see(("uplinkd", 8), ("uplinkctl", 1))
