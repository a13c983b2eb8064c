"""docs/questions.tsv: what operators and authors of agents ask, and the sentence that answers it."""

import posixpath
import re

from tree import Finding

QUESTIONS = "docs/questions.tsv"
MAP = "docs/README.md"
COLUMNS = ["who", "question", "page", "anchor", "quote"]
LEAST = {"operator": 25, "agent": 15}
QUOTE_MAX = 200
LINKS_MAX = 2
HEADING = re.compile(r"^(#+) +(.*?) *$")
LINK = re.compile(r"\[[^\]]*\]\(([^)\s#]+)(?:#[^)]*)?\)")


def distances(tree):
    """Pages by the number of links from the map."""
    found, edge = {MAP: 0}, [MAP]
    for distance in range(1, LINKS_MAX + 1):
        following = []
        for page in edge:
            for name in LINK.findall(tree.text(page)):
                target = posixpath.normpath(posixpath.join(posixpath.dirname(page), name))
                if target.endswith(".md") and target not in found and tree.has(target):
                    found[target] = distance
                    following.append(target)
        edge = following
    return found


def anchor_of(heading):
    """The anchor that GitHub gives a heading."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def section(tree, page, anchor):
    """The lines below a heading, up to the next of its level or above; None without such a heading."""
    kept, level, fenced = None, 0, False
    for line in tree.lines(page):
        fenced ^= line.startswith("```")
        heading = None if fenced else HEADING.match(line)
        if heading and kept is not None and len(heading.group(1)) <= level:
            break
        if heading and kept is None and anchor_of(heading.group(2)) == anchor:
            kept, level = [], len(heading.group(1))
        elif kept is not None:
            kept.append(line)
    return kept


def _wrong(tree, near, page, anchor, quote):
    if page not in near:
        return f"{page} is not within {LINKS_MAX} links of {MAP}"
    lines = section(tree, page, anchor)
    if lines is None:
        return f"{page} has no #{anchor}"
    if not 0 < len(quote) <= QUOTE_MAX:
        return f"a quote has at most {QUOTE_MAX} characters"
    if not any(quote in line for line in lines):
        return f"{page}#{anchor} does not say: {quote}"
    return None


def answered(tree, least=None):
    """Each question has its answer where the list says, close to the map of the documents."""
    if not tree.has(QUESTIONS) or not tree.has(MAP):
        yield Finding(QUESTIONS if tree.has(MAP) else MAP, 1, "question", "the file is not there")
        return
    least = dict(LEAST if least is None else least)
    near, seen = distances(tree), set()
    head, *rows = tree.lines(QUESTIONS)
    if head.split("\t") != COLUMNS:
        yield Finding(QUESTIONS, 1, "question", f"columns are {', '.join(COLUMNS)}")
    for number, row in enumerate(rows, 2):
        cells = row.split("\t")
        if len(cells) != len(COLUMNS) or cells[0] not in least:
            text = f"a row has {len(COLUMNS)} columns and begins with {' or '.join(least)}"
            yield Finding(QUESTIONS, number, "question", text)
            continue
        who, question, *answer = cells
        least[who] -= 1
        wrong = "asked twice" if question in seen else _wrong(tree, near, *answer)
        seen.add(question)
        if wrong:
            yield Finding(QUESTIONS, number, "question", wrong)
    for who, missing in least.items():
        if missing > 0:
            yield Finding(QUESTIONS, 1, "question", f"{missing} questions of {who} too few")
