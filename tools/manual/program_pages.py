"""The manual pages of the programs and of each verb."""

import re

from roff import Page, bold, italic, plain

EXIT_ROW = re.compile(r"^\| `([\w-]+)` \| (\d) \| (.*) \|$", re.MULTILINE)
HANDBOOK = "The handbook lies in /usr/share/doc/uplinkd/; its map is docs/README.md."

DESCRIPTIONS = {
    "uplinkd": (
        "uplinkd takes in what robots report, acks what must last once it is on disk, and knows which "
        "robots are there. Its settings are in a TOML file, see uplinkd.toml(5). It needs at least a "
        "certificate, its key and the authority of the robots' certificates.",
        "It logs to standard error. The package's unit is uplinkd.service; the package neither enables "
        "nor starts it.",
    ),
    "uplinkctl": (
        "uplinkctl looks after a server and its store. Each verb has a page of its own.",
    ),
    "uplink-fleet": (
        "uplink-fleet plays robots against a running server, then compares counters, rows and states "
        "over HTTP with what its robots know. It makes their certificates from a development authority "
        "(uplinkctl pki init). Use it on a test server.",
    ),
}
SIGNALS = (
    ("SIGTERM, SIGINT", "Drain and stop; a second one ends the process at once."),
    ("SIGHUP", "Read the configuration again and take over what needs no restart."),
)
FILES = (
    ("/etc/uplinkd/uplinkd.toml", "The settings."),
    ("/etc/uplinkd/keys/", "Certificates, keys and passwords: root's, readable for the group uplinkd."),
    ("/var/lib/uplinkd/", "The embedded store."),
)


def first_lower(text):
    """A sentence as the NAME section has it, without what follows a semicolon. TLS stays as it is."""
    text = re.split("[;\n]", text)[0].rstrip(".")
    return text[:1].lower() + text[1:] if re.match("[A-Z][a-z ]", text) else text


def synopsis(command):
    grouped = {option.names for group in command.exactly_one_of for option in group}
    parts = [bold(" ".join(command.words))]
    for group in command.exactly_one_of:
        choices = [f"{bold(each.names[-1])} {italic(each.value)}" for each in group]
        parts.append("{" + " | ".join(choices) + "}")
    for option in command.options:
        if option.required and option.names not in grouped:
            parts.append(f"{bold(option.names[-1])} {italic(option.value)}")
    parts.append("[" + italic("OPTIONS") + "]")
    for option in command.positions:
        parts.append(italic(option.value) if option.required else f"[{italic(option.value)}]")
    if command.commands:
        parts.append(italic("COMMAND"))
    return " ".join(parts)


def notes(option):
    """What the flag's sentence does not say."""
    if option.required:
        yield "Required."
    if option.choices:
        yield "One of " + ", ".join(option.choices) + "."
    if option.bounds:
        low, high = (bound.rstrip("0").rstrip(".") if "." in bound else bound for bound in option.bounds)
        yield f"From {low} to {high}."
    if option.default:
        yield f"Default: {option.default}."
    if option.several and option.names:
        yield "May be given several times."
    if option.excludes:
        yield "Not together with " + ", ".join(option.excludes) + "."


def add_options(page, command):
    page.head("OPTIONS")
    for option in (*command.positions, *command.options):
        name = italic(option.value) if option.position else ", ".join(bold(each) for each in option.names)
        head = f"{name} {italic(option.value)}" if option.names and option.value else name
        page.entry(head, *option.about.split("\n"), " ".join(notes(option)))
    for group in command.exactly_one_of:
        page.paragraph("Exactly one of " + " and ".join(each.names[-1] for each in group) + " is required.")


def add_footer(page, command):
    """Its first line is a heading, as in "Examples:"; the others are shown as they are."""
    head, *lines = command.footer.strip("\n").split("\n")
    if head:
        page.head(head.rstrip(":").upper())
        page.example("\n".join(each.strip() for each in lines))


def add_exits(page, program, exit_codes):
    page.head("EXIT STATUS")
    for name, code, text in EXIT_ROW.findall(exit_codes):
        if name == program:
            page.entry(bold(code), plain(text))


def verb_page(command, make):
    page = make(command.page, 1)
    page.head("NAME").raw(f"{bold(command.page)} \\- {plain(first_lower(command.about))}")
    page.head("SYNOPSIS").raw(synopsis(command))
    page.head("DESCRIPTION").paragraph(command.about.rstrip(".") + ".")
    add_options(page, command)
    add_footer(page, command)
    return page


def program_page(program, section, make, exit_codes):
    name = program.words[0]
    page = make(name, section)
    page.head("NAME").raw(f"{bold(name)} \\- {plain(first_lower(program.about))}")
    page.head("SYNOPSIS").raw(synopsis(program)).head("DESCRIPTION")
    for text in (*DESCRIPTIONS[name], HANDBOOK):
        page.paragraph(text)
    if program.commands:
        page.head("COMMANDS")
        for leaf in program.leaves():
            page.entry(f"{bold(leaf.page)}(1)", leaf.about)
    add_options(page, program)
    add_footer(page, program)
    if name == "uplinkd":
        for title, rows in (("SIGNALS", SIGNALS), ("FILES", FILES)):
            page.head(title)
            for head, text in rows:
                page.entry(bold(head), text)
    add_exits(page, name, exit_codes)
    return page


def pages(programs, version, date, exit_codes):
    """The pages of {"uplinkd": Command, ...}; what a page refers to is one of them."""

    def make(name, section):
        return Page(name, section, version, date)

    sections = {"uplinkd": 8, "uplinkctl": 1, "uplink-fleet": 1}
    for name, program in programs.items():
        others = [(other, sections[other]) for other in programs if other != name]
        page = program_page(program, sections[name], make, exit_codes)
        yield page.see(*others, ("uplinkd.toml", 5))
        for leaf in program.leaves():
            page = verb_page(leaf, make)
            add_exits(page, name, exit_codes)
            yield page.see((name, sections[name]), ("uplinkd.toml", 5))
