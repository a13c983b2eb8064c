"""That the book of the crash campaign with a broker finds what it is there for."""

import unittest

from broker_book import Book
from broker_script import KINDS, Kind, message_of, numbers_of

A = (0, Kind.TELEMETRY, 1)
B = (0, Kind.TELEMETRY, 2)
C = (0, Kind.TELEMETRY, 3)
OTHER = (1, Kind.TELEMETRY, 1)


class Books(unittest.TestCase):
    def setUp(self):
        self.book = Book()
        for key in (A, B, C, OTHER):
            self.book.publish(key)
            self.book.ack(key)

    def found(self, *rows):
        return {what: keys for what, keys in self.book.check(rows).lists().items() if keys}

    def test_what_is_stored_once_and_in_order_is_well(self):
        self.assertEqual(self.found(A, OTHER, B, C), {})
        self.assertEqual(self.book.check((A, OTHER, B, C)).lines(), [])

    def test_what_was_acked_and_is_not_stored_is_missing(self):
        self.assertEqual(self.found(A, C, OTHER), {"missing": [B]})

    def test_a_second_row_is_doubled(self):
        self.assertEqual(self.found(A, B, B, C, OTHER), {"doubled": [B]})
        self.assertEqual(self.found(A, B, C, OTHER, A), {"doubled": [A]})

    def test_a_row_behind_a_later_one_is_out_of_order(self):
        self.assertEqual(self.found(A, C, B, OTHER), {"out of order": [B]})

    def test_a_row_of_nothing_is_strange(self):
        unknown = (7, Kind.EVENT, 1)
        self.assertEqual(self.found(A, B, C, OTHER, unknown), {"never published": [unknown]})

    def test_what_was_not_acked_may_be_stored_or_not(self):
        late = (0, Kind.TELEMETRY, 4)
        self.book.publish(late)
        self.assertEqual(self.found(A, B, C, OTHER), {})
        self.assertEqual(self.found(A, B, C, OTHER, late), {})
        self.assertEqual(self.found(A, B, C, OTHER, late, late), {"doubled": [late]})

    def test_what_was_published_again_counts_twice(self):
        self.book.publish(C)
        self.assertEqual(self.found(A, B, C, OTHER, C), {})
        self.assertEqual(self.found(A, B, C, OTHER, C, C), {"doubled": [C]})
        self.assertEqual(self.found(A, B, OTHER), {"missing": [C]})


class Scripts(unittest.TestCase):
    def test_each_kind_has_messages_of_its_own(self):
        said = {message_of(twin, kind, number) for twin in (0, 1) for kind in KINDS for number in (1, 2)}
        self.assertEqual(len(said), 4 * len(KINDS))

    def test_numbers_count_each_kind_by_itself(self):
        numbers = numbers_of(0)
        keys = [next(numbers) for _ in range(200)]
        for kind in KINDS:
            self.assertEqual(
                [number for _, k, number in keys if k is kind],
                list(range(1, 1 + sum(k is kind for _, k, _ in keys))),
            )
            self.assertIn(kind, {k for _, k, _ in keys})


if __name__ == "__main__":
    unittest.main()
