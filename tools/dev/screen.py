"""A terminal without glass: takes what a program writes and holds what a person would see.

Knows what our programs use: text, carriage return, line feed, backspace, tab; cursor up and down;
erase in line and in screen; colours and bold. Other sequences are an error, so that none is shown
wrongly. Lines that scroll out at the top are kept.
"""

import codecs
import dataclasses
import re

SEQUENCE = re.compile(r"\x1b\[([0-9;]*)([A-Za-z])")
# A sequence that may still go on.
UNFINISHED = re.compile(r"\x1b(\[[0-9;]*)?\Z")
TAB = 8


@dataclasses.dataclass(frozen=True)
class Style:
    """`colour` is 1 to 7 as in red to white, or 0: the terminal's own."""

    colour: int = 0
    bold: bool = False


PLAIN = Style()


class Screen:
    """Confined to one thread."""

    def __init__(self, columns, rows):
        self.columns = columns
        self.rows = rows
        # Each a list of (character, Style); the last `rows` of them are on the screen.
        self.lines = [[]]
        self.row = self.column = 0
        self.style = PLAIN
        self.decoder = codecs.getincrementaldecoder("utf-8")("replace")
        self.kept = ""

    def take(self, data):
        """The next bytes that the program wrote; a sequence may be cut anywhere."""
        text = self.kept + self.decoder.decode(data)
        unfinished = UNFINISHED.search(text)
        self.kept = unfinished.group() if unfinished else ""
        text = text[: len(text) - len(self.kept)]
        at = 0
        for sequence in SEQUENCE.finditer(text):
            self._write(text[at : sequence.start()])
            self._obey(sequence.group(1), sequence.group(2))
            at = sequence.end()
        self._write(text[at:])

    def text(self):
        """Its lines without colours and without blanks at their ends."""
        return ["".join(character for character, _ in line).rstrip() for line in self.lines]

    def _top(self):
        return max(len(self.lines) - self.rows, 0)

    def _write(self, text):
        for character in text:
            if character == "\n":
                self._next_line()
            elif character == "\r":
                self.column = 0
            elif character == "\b":
                self.column = max(self.column - 1, 0)
            elif character == "\t":
                self.column = min(self.column + TAB - self.column % TAB, self.columns - 1)
            elif character == "\x1b":
                raise ValueError("an escape sequence that this screen does not know")
            elif character >= " ":
                self._put(character)

    def _put(self, character):
        if self.column == self.columns:
            self.column = 0
            self._next_line()
        line = self.lines[self.row]
        line.extend([(" ", PLAIN)] * (self.column + 1 - len(line)))
        line[self.column] = (character, self.style)
        self.column += 1

    def _next_line(self):
        """As a terminal does with onlcr off: the column stays."""
        self.row += 1
        if self.row == len(self.lines):
            self.lines.append([])

    def _obey(self, parameters, command):
        numbers = [int(each or 0) for each in parameters.split(";")]
        if command == "A":
            self.row = max(self.row - max(numbers[0], 1), self._top())
        elif command == "B":
            self.row = min(self.row + max(numbers[0], 1), len(self.lines) - 1)
        elif command == "K" and numbers == [0]:
            del self.lines[self.row][self.column :]
        elif command == "J" and numbers == [0]:
            del self.lines[self.row][self.column :]
            for line in self.lines[self.row + 1 :]:
                line.clear()
        elif command == "m":
            self._paint(numbers)
        else:
            raise ValueError(f"ESC [ {parameters} {command} is not known to this screen")

    def _paint(self, numbers):
        for number in numbers:
            if number == 0:
                self.style = PLAIN
            elif number == 1:
                self.style = dataclasses.replace(self.style, bold=True)
            elif 31 <= number <= 37:
                self.style = dataclasses.replace(self.style, colour=number - 30)
            elif number == 39:
                self.style = dataclasses.replace(self.style, colour=0)
            else:
                raise ValueError(f"colour {number} is not known to this screen")
