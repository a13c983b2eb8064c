"""Alerts are read on a telephone at night: their texts are short."""

import re

from tree import Finding

FOLDER = "deploy/prometheus/"
# A text has fewer words than that.
WORDS_MAX = {"summary": 12, "description": 40}
TEXT = re.compile(r'^ +(summary|description): "(.*)"$')
PLACE = re.compile(r"\{\{.*?\}\}")
ALERT = re.compile(r"^ +- alert: ")


def short(tree):
    """Each alert has a summary and a description, on one line each and within their words."""
    for path in tree.files:
        if not path.startswith(FOLDER) or not path.endswith(".yml"):
            continue
        alerts = texts = 0
        for number, line in enumerate(tree.lines(path), 1):
            alerts += bool(ALERT.match(line))
            found = TEXT.match(line)
            if not found:
                continue
            texts += 1
            # What Prometheus fills in is one word.
            words, most = len(PLACE.sub("x", found[2]).split()), WORDS_MAX[found[1]]
            if words >= most:
                yield Finding(path, number, "alert-text", f"{words} words; write fewer than {most}")
        if texts != 2 * alerts:
            text = f"{alerts} alerts have {texts} texts; give each a summary and a description on one line"
            yield Finding(path, 1, "alert-text", text)
