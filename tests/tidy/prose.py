"""Words that our prose does not use, because a stranger reads their sentences twice."""

import re

from tree import NOT_CODE, Finding

# (phrase, what to write instead, whether code keeps to it as well: its comments and texts)
AVOIDED = (
    ("whoever|whomever", "name the one who acts", False),
    ("nobody", '"no one", or say who does not: "no robot"', False),
    ("what of it|of it that", "name the part", False),
    ("of which", "begin a second sentence", False),
    ("as far as", "say where the bound is", False),
    # "nothing else." is plain; "would gather there else." is not.
    (r"(?<!thing )(?<!body )(?<!one )(?<!where )else(?=[.;](?:\s|$))", '"otherwise", at the beginning', False),
    ("(?:is|are) to be", '"must", or let the subject act', False),
    ("told of", "say what the log or the page shows", False),
    ("(?:for )?want of", '"lack of"', False),
    ("nothing but", '"only"', False),
    ("in order to", '"to"', False),
    ("ought|shall", '"must" or "should"', False),
    ("lest|hitherto|henceforth|hereby|insofar|notwithstanding|albeit", "a plain word", True),
    ("(?:where|there|here)(?:of|upon|unto)", "a plain word", True),
    ("whilst|amongst", '"while", "among"', True),
    ("utili[sz]e[sd]?|leverag(?:e|es|ed|ing)", '"use"', True),
    ("obviously|simply|needless to say", "leave it out", True),
)
PATTERNS = tuple(
    (re.compile(rf"\b(?:{phrase})(?!\w)", re.IGNORECASE), instead, code) for phrase, instead, code in AVOIDED
)
IN_CODE = re.compile("|".join(pattern.pattern for pattern, _, code in PATTERNS if code), re.IGNORECASE)
# The first lists these words. The second is generated from texts in code.
EXEMPT = ("CONTRIBUTING.md", "docs/reference/metrics.md")
GENERATED_ROWS = {"docs/operate/configuration.md": "| `"}
CODE_SUFFIXES = (".h", ".cc", ".py", ".sh", ".proto", ".capnp", ".toml", ".sql", ".yml", ".yaml")
OURS = "tests/tidy/"
# What a program prints is quoted as it is.
QUOTED = re.compile(r"`[^`]*`|\]\([^)]*\)")


def _page(tree, path):
    """The lines of a page that are our prose; others are blank."""
    fenced = False
    for line in tree.lines(path):
        fence = line.lstrip().startswith("```")
        fenced ^= fence
        generated = path in GENERATED_ROWS and line.startswith(GENERATED_ROWS[path])
        yield "" if fence or fenced or generated else QUOTED.sub("`", line)


def _code(tree, path):
    """The lines of a source; of C++ only the comments and literals."""
    if not path.endswith((".h", ".cc")):
        return tree.lines(path)
    text, kept, end = tree.text(path), [], 0
    for match in NOT_CODE.finditer(text):
        kept += ["\n" * text.count("\n", end, match.start()), " ", match.group()]
        end = match.end()
    return "".join(kept).split("\n")


def avoided(tree):
    """Pages use no word of AVOIDED. Code uses none of those that it has been rid of."""
    for path in tree.files:
        page = path.endswith(".md")
        if path.startswith(OURS) or path in EXEMPT:
            continue
        if not page and not (path.endswith(CODE_SUFFIXES) and IN_CODE.search(tree.text(path))):
            continue
        for number, line in enumerate(_page(tree, path) if page else _code(tree, path), 1):
            for pattern, instead, code in PATTERNS:
                match = pattern.search(line) if page or code else None
                if match:
                    yield Finding(path, number, "prose", f"{match.group()!r}: {instead}")
