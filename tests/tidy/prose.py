"""Words that our prose does not use, because a stranger reads their sentences twice."""

import re

from tree import NOT_CODE, Finding

# (phrase, what to write instead), in pages and in the comments and texts of code
AVOIDED = (
    ("whoever|whomever", "name the one who acts"),
    ("nobody", '"no one", or say who does not: "no robot"'),
    ("what of it|of it that", "name the part"),
    ("of which", "begin a second sentence"),
    ("as far as", "say where the bound is"),
    # "nothing else." is plain; "would gather there else." is not.
    (r"(?<!thing )(?<!body )(?<!one )(?<!where )else(?=[.;](?:\s|$))", '"otherwise", at the beginning'),
    ("(?:is|are) to be", '"must", or let the subject act'),
    ("told of", "say what the log or the page shows"),
    ("(?:for )?want of", '"lack of"'),
    ("nothing but", '"only"'),
    ("in order to", '"to"'),
    ("ought|shall", '"must" or "should"'),
    ("lest|hitherto|henceforth|hereby|insofar|notwithstanding|albeit", "a plain word"),
    ("(?:where|there|here)(?:of|upon|unto)", "a plain word"),
    ("whilst|amongst", '"while", "among"'),
    ("utili[sz]e[sd]?|leverag(?:e|es|ed|ing)", '"use"'),
    ("obviously|simply|needless to say", "leave it out"),
)
# A phrase may go on in the next line, behind the mark of a comment.
GAP = r"(?:[ ]|[ ]*\n[ \t]*(?:///?|#|--|\*)?[ \t]*)"


def _compiled(phrase):
    """A space that ends a group stands in one line: what looks behind must have a fixed width."""
    return re.compile(rf"\b(?:{re.sub(r' (?![)])', lambda _: GAP, phrase)})(?!\w)", re.IGNORECASE)


PATTERNS = tuple((_compiled(phrase), instead) for phrase, instead in AVOIDED)
ANY = re.compile("|".join(pattern.pattern for pattern, _ in PATTERNS), re.IGNORECASE)
# The first lists these words. The others stay as released: their check sums are in databases.
EXEMPT = ("CONTRIBUTING.md", "storage/migrations/postgres/", "storage/migrations/sqlite/")
CODE_SUFFIXES = (".h", ".cc", ".py", ".sh", ".proto", ".capnp", ".toml", ".sql", ".yml", ".yaml",
                 ".c", ".js", ".cmake", "CMakeLists.txt", ".service", ".conf")  # fmt: skip
OURS = "tests/tidy/"
# What a program prints is quoted as it is.
QUOTED = re.compile(r"`[^`]*`|\]\([^)]*\)")


def _page(tree, path):
    """The lines of a page that are our prose; others are blank."""
    fenced = False
    for line in tree.lines(path):
        fence = line.lstrip().startswith("```")
        fenced ^= fence
        yield "" if fence or fenced else QUOTED.sub("`", line)


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
    """Neither pages nor the comments and texts of code use a word of AVOIDED."""
    for path in tree.files:
        page = path.endswith(".md")
        if not page and not path.endswith(CODE_SUFFIXES):
            continue
        if path.startswith((OURS, *EXEMPT)) or not ANY.search(tree.text(path)):
            continue
        prose = "\n".join(_page(tree, path) if page else _code(tree, path))
        for pattern, instead in PATTERNS:
            for match in pattern.finditer(prose):
                phrase = re.sub(r"[\s/#*-]+", " ", match.group())
                yield Finding(path, prose.count("\n", 0, match.start()) + 1, "prose", f"{phrase!r}: {instead}")
