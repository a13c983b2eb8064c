"""That the book of a drone finds what it is there for, and that its samples are what it takes them for."""

import json
import unittest

from drone_book import Book, rows_due, rows_of
from drone_samples import STORED, TELEMETRY, TYPES, UNSTORED, WRONG, call_of, request_of, sample_of, times

NUMBERS = range(1, 10)


def flown():
    """A book in which every sample was answered, and what a store has of that."""
    book = Book()
    for name in STORED:
        for number in NUMBERS:
            book.publish(name, number)
            book.answer(name, number, "STORED")
    return book, {name: rows_due(name, NUMBERS) for name in STORED}


class Books(unittest.TestCase):
    def setUp(self):
        self.book, self.stored = flown()

    def change(self, name, *rows):
        self.stored[name] = list(rows)
        return self.book.problems(self.stored)

    def leave_open(self, name, *words):
        self.book.publish(name, NUMBERS.stop)
        for word in words:
            self.book.answer(name, NUMBERS.stop, word)

    def test_what_was_answered_and_is_stored_once_is_well(self):
        self.assertEqual(self.book.problems(self.stored), [])
        self.assertEqual(self.book.open_samples(), [])

    def test_a_row_that_is_missing_is_found_for_every_type(self):
        for name in STORED:
            book, stored = flown()
            del stored[name][4]
            self.assertEqual(len(book.problems(stored)), 1, name)

    def test_a_second_row_is_found_for_every_type(self):
        for name in STORED:
            book, stored = flown()
            stored[name].insert(5, stored[name][4])
            self.assertEqual(len(book.problems(stored)), 1, name)

    def test_a_problem_says_what_is_where(self):
        first, second, *others = self.stored["StatusText"]
        self.assertEqual(self.change("StatusText", second, first, *others), ["StatusText: row 0 is 2, not 1"])
        self.assertEqual(self.change("StatusText", first), ["StatusText: row 1 is nothing, not 2"])
        self.assertEqual(
            self.change("StatusText", first, second, *others, ("", 77)), ["StatusText: row 9 is 77, not nothing"]
        )

    def test_a_row_of_an_alert_that_never_was_is_found(self):
        rows = self.stored["Alert"]
        self.assertEqual(self.change("Alert", *rows, ("low-9", True)), ["Alert low-9: row 0 is True, not nothing"])

    def test_what_was_not_answered_may_be_stored_once_or_not(self):
        for name in STORED:
            for words in ([], ["CANCELLED"], ["UNAVAILABLE", "DEADLINE_EXCEEDED"]):
                self.book, self.stored = flown()
                self.leave_open(name, *words)
                self.assertEqual(self.book.open_samples(), [(name, NUMBERS.stop)])
                self.assertEqual(self.book.problems(self.stored), [])
                rows = rows_due(name, [*NUMBERS, NUMBERS.stop])
                self.assertEqual(self.change(name, *rows), [], name)
                self.assertEqual(len(self.change(name, *rows, rows[-1])), 1, name)

    def test_what_was_a_duplicate_is_due_as_well(self):
        self.leave_open("Error", "DEADLINE_EXCEEDED", "DUPLICATE")
        self.assertEqual(self.book.open_samples(), [])
        self.assertEqual(self.book.problems(self.stored), ["Error: row 9 is nothing, not 10"])

    def test_a_good_sample_that_is_rejected_is_a_problem(self):
        self.leave_open("Error", "REJECTED")
        self.assertIn("Error 10: REJECTED", self.book.problems(self.stored))

    def test_a_wrong_sample_that_is_not_rejected_is_a_problem(self):
        self.leave_open(WRONG, "UNAVAILABLE", "REJECTED")
        self.assertEqual(self.change(WRONG, ("", 10)), [])
        self.book.publish(WRONG, 18)
        self.book.answer(WRONG, 18, "STORED")
        self.assertIn("Wrong 18: STORED", self.change(WRONG, ("", 10), ("", 18)))

    def test_a_change_that_was_answered_ok_and_is_not_stored_is_lost(self):
        for word in ("APPLIED", "SUPERSEDED"):
            self.book, self.stored = flown()
            self.leave_open("CurrentMissionItem", "CANCELLED", word)
            self.assertEqual(self.book.open_samples(), [])
            self.assertEqual(self.book.problems(self.stored), ["CurrentMissionItem: row 9 is nothing, not 10"])

    def test_an_account_counts_what_is_lost_and_what_is_doubled(self):
        rows = sum(map(len, self.stored.values()))
        self.assertEqual(self.book.account(self.stored), (rows, rows, 0, 0))
        self.stored["Error"] = [*self.stored["Error"][1:], ("", 5), ("", 5)]
        self.assertEqual(self.book.account(self.stored), (rows, rows + 1, 1, 2))

    def test_an_account_takes_what_is_open_for_stored_or_not(self):
        rows = sum(map(len, self.stored.values()))
        self.leave_open("Error", "UNAVAILABLE")
        self.assertEqual(self.book.account(self.stored), (rows, rows, 0, 0))
        self.stored["Error"].append(("", NUMBERS.stop))
        self.assertEqual(self.book.account(self.stored), (rows, rows + 1, 0, 0))
        self.stored["Error"].append(("", NUMBERS.stop))
        self.assertEqual(self.book.account(self.stored), (rows, rows + 2, 0, 1))

    def test_a_book_goes_on_with_a_later_one(self):
        later = Book()
        for name in ("Error", "Battery"):
            later.publish(name, 30)
            later.answer(name, 30, "STORED")
        self.book.add(later)
        self.assertEqual(self.book.last(), 30)
        self.assertEqual(self.change("Error", *self.stored["Error"], ("", 30)), [])

    def test_live_samples_are_due_nowhere(self):
        self.book.publish("Battery", 1)
        self.book.answer("Battery", 1, "APPLIED")
        self.assertEqual(self.book.problems(self.stored), [])
        self.assertEqual(self.book.words("Battery"), {"APPLIED": 1})

    def test_it_is_the_same_after_it_was_dumped(self):
        self.leave_open("Alert", "CANCELLED")
        again = Book.load(json.loads(json.dumps(self.book.dump())))
        self.assertEqual(again.samples, self.book.samples)
        self.assertEqual(again.open_samples(), [("Alert", NUMBERS.stop)])


class Rows(unittest.TestCase):
    def test_lists_of_a_server_are_read_by_type(self):
        stored = rows_of(
            events=[
                {"kind": "armed", "detail": {"to": True}},
                {"kind": "flightMode", "detail": {"from": "HOLD", "to": "returnToLaunch"}},
                {"kind": "missionItem", "detail": {"to": {"current": 3, "total": 9}}},
                {"kind": "commandResult", "detail": {"status": {"text": "number 12."}}},
                {"kind": "estopEngaged", "detail": {}},
            ],
            messages=[{"message": "number 5."}],
            faults=[{"faultId": "low-1", "active": True}, {"faultId": "low-1", "active": False}],
            requests=[
                {"requestId": "ask-0", "closedAt": "2026-11-21T12:00:00Z"},
                {"requestId": "ask-1"},
            ],
            quarantine=[{"detail": '"wrong-8" stands twice in its list'}],
        )
        self.assertEqual(
            stored,
            {
                "Armed": [("", True)],
                "FlightMode": [("", "RETURN_TO_LAUNCH")],
                "CurrentMissionItem": [("", 3)],
                "UAVCommandResult": [("", 12)],
                "StatusText": [("", 5)],
                "Alert": [("low-1", True), ("low-1", False)],
                "OperatorActionRequests": [("ask-0", True), ("ask-0", False), ("ask-1", True)],
                "Wrong": [("", 8)],
            },
        )


class Samples(unittest.TestCase):
    def test_there_are_the_23_types_of_telemetry_and_three_more(self):
        self.assertEqual((len(TELEMETRY), len(TYPES), len(UNSTORED)), (23, 26, 16))

    def test_two_numbers_make_two_samples_of_each_type(self):
        for name in TYPES:
            requests = [json.dumps(request_of(name, sample_of(name, number), times(number))) for number in NUMBERS]
            self.assertEqual(len(set(requests)), len(NUMBERS), name)

    def test_a_wrong_sample_names_its_number_and_is_a_call_of_a_type(self):
        kind, request = call_of(WRONG, 8)
        self.assertIn(kind, TYPES)
        self.assertIn("wrong-8", json.dumps(request))
        self.assertEqual(call_of("Error", 8), ("Error", request_of("Error", sample_of("Error", 8), times(8))))

    def test_each_number_of_a_type_that_is_stored_changes_something(self):
        for name in STORED:
            due = [len(rows_due(name, range(1, last + 1))) for last in NUMBERS]
            self.assertEqual(due, sorted(set(due)), name)


if __name__ == "__main__":
    unittest.main()
