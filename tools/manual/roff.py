"""Text as manual pages write it (man(7))."""

import re

LINK = re.compile(r"\[([^\]]*)\]\([^)]*\)")


def escaped(text):
    return text.replace("\\", "\\e").replace("-", "\\-")


def line(text):
    """A line of text, which no leading dot or quote makes a request."""
    text = escaped(text)
    return "\\&" + text if text[:1] in (".", "'") else text


def plain(markdown):
    """A cell or sentence of a page without its marks."""
    return LINK.sub(r"\1", markdown).replace("`", "").replace("**", "")


def bold(text):
    return f"\\fB{escaped(text)}\\fR"


def italic(text):
    return f"\\fI{escaped(text)}\\fR"


class Page:
    """One page, line by line."""

    def __init__(self, name, section, version, date):
        self.name, self.section = name, section
        self.lines = [f'.TH "{escaped(name.upper())}" "{section}" "{date}" "uplinkd {version}"']

    def head(self, title):
        self.lines.append(f".SH {title}")
        return self

    def sub(self, title):
        self.lines.append(f".SS {line(title)}")
        return self

    def paragraph(self, text):
        self.lines += [".PP", *(line(each) for each in text.split("\n"))]
        return self

    def raw(self, text):
        self.lines.append(text)
        return self

    def entry(self, head, *texts):
        """An indented paragraph below `head`, which is escaped already."""
        self.lines += [".TP", head]
        for number, text in enumerate(each for each in texts if each):
            self.lines += [".br"] if number else []
            self.lines += [line(each) for each in text.split("\n")]
        return self

    def example(self, text):
        self.lines += [".PP", ".nf", *(line(each) for each in text.split("\n")), ".fi"]
        return self

    def see(self, *pages):
        parts = [f"{bold(name)}({section})" for name, section in pages]
        self.head("SEE ALSO").raw(",\n".join(parts))
        return self

    def write(self, folder):
        path = folder / f"man{self.section}" / f"{self.name}.{self.section}"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("\n".join(self.lines) + "\n", encoding="utf-8")
