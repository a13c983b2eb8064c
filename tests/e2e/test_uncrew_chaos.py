"""The crash campaign with drones in short, its canaries, and that its comparison finds what it is there for."""

import unittest

from drone_book import Book, rows_due
from drone_samples import STORED, UNSTORED, WRONG, alerts_of, requests_of
from drones import ROOT
from harness import EndToEnd
from uncrew_chaos import UAVS, PairCampaign, UncrewCampaign, dealt, shown_sets, standing_sets, stored_rows

KILLS = 12
# A run ends with the first loss or the first row too many, mostly within 10.
CANARY_KILLS = 100


class UncrewChaos(EndToEnd):
    def keep(self, campaign):
        self.open_things.append(campaign)
        return campaign

    def expect_clean(self, campaign):
        self.assertTrue(campaign.run(KILLS), "\n".join([campaign.line(), *campaign.wrong]))
        self.assertEqual(campaign.done, KILLS)
        self.assertGreater(campaign.acked, 100 * KILLS)

    def expect_found(self, canary):
        campaign = self.keep(UncrewCampaign(self.folder, "sqlite", 2, canary))
        campaign.run(CANARY_KILLS)
        self.assertTrue(campaign.canary_found(), campaign.line())

    def test_kills_on_sqlite_lose_and_double_no_sample(self):
        self.expect_clean(self.keep(UncrewCampaign(self.folder, "sqlite", 2)))

    def test_kills_on_postgres_lose_and_double_no_sample(self):
        self.expect_clean(self.keep(UncrewCampaign(self.folder, "postgres", 2)))

    def test_kills_of_two_servers_in_turn_lose_and_double_no_sample(self):
        self.expect_clean(self.keep(PairCampaign(self.folder, 2)))

    def test_a_server_that_answers_before_the_commit_is_found(self):
        self.expect_found("answers_early")

    def test_a_server_that_forgets_samples_is_found(self):
        self.expect_found("forgets_samples")


def table_of(uav, name, rows):
    """Rows of the campaign's query, made of what rows_due gives."""
    ruri = ROOT + uav
    if name == WRONG:
        return [("rejected", ruri, f'"wrong-{number}" stands twice in its list', "0") for _, number in rows]
    if name == "StatusText":
        return [("message", ruri, f"number {number}.", "0") for _, number in rows]
    if name == "Alert":
        return [("fault", ruri, each, str(int(is_raised))) for each, is_raised in rows]
    closed = [each for each, is_open in rows if not is_open]
    return [("request", ruri, each, str(int(each not in closed))) for each, is_open in rows if is_open]


class Comparison(unittest.TestCase):
    NUMBERS = range(1, 10)
    NAMES = ("StatusText", "Alert", "OperatorActionRequests", WRONG)

    def setUp(self):
        self.book = Book()
        for name in self.NAMES:
            for number in self.NUMBERS:
                self.book.publish(name, number)
                self.book.answer(name, number, "REJECTED" if name == WRONG else "STORED")
        self.table = [row for name in self.NAMES for row in table_of("d1", name, rows_due(name, self.NUMBERS))]

    def account(self):
        """Lost and doubled."""
        rows = stored_rows(self.table)["d1"]
        account = self.book.account(rows)
        self.assertEqual(bool(self.book.problems(rows)), account.lost + account.doubled > 0)
        return account.lost, account.doubled

    def test_all_that_was_answered_and_is_stored_once_is_well(self):
        self.assertEqual(self.account(), (0, 0))
        self.assertEqual({uav for uav, rows in stored_rows(self.table).items() if any(rows.values())}, {"d1"})

    def test_a_row_that_is_missing_is_lost(self):
        for place, row in enumerate(list(self.table)):
            # A closed request stands for two rows: its opening and its end.
            due = 2 if row[0] == "request" and row[3] == "0" else 1
            self.table.pop(place)
            self.assertEqual(self.account(), (due, 0), row)
            self.table.insert(place, row)

    def test_a_row_too_many_is_doubled(self):
        for place, row in enumerate(list(self.table)):
            due = 2 if row[0] == "request" and row[3] == "0" else 1
            self.table.insert(place, row)
            self.assertEqual(self.account(), (0, due), row)
            self.table.pop(place)

    def test_a_request_that_is_still_open_is_lost_once(self):
        place = next(place for place, row in enumerate(self.table) if row[0] == "request")
        self.table[place] = (*self.table[place][:3], "1")
        self.assertEqual(self.account(), (1, 0))

    def test_what_holds_in_the_store_is_read_by_drone(self):
        found = standing_sets([("alert", ROOT + "d1", "low-1"), ("request", ROOT + "d2", "ask-3")])
        self.assertEqual((found["d1"], found["d2"]), (({"low-1"}, set()), (set(), {"ask-3"})))
        self.assertEqual(set(found), set(UAVS))

    def test_what_holds_is_the_sets_that_were_answered_last(self):
        self.assertEqual(self.book.sets(), (alerts_of(9), requests_of(9)))
        for name in ("Alert", "OperatorActionRequests"):
            self.book.publish(name, 10)
            self.book.answer(name, 10, "UNAVAILABLE")
        self.assertEqual(self.book.sets(), (alerts_of(9), requests_of(9)))

    def test_what_a_server_shows_is_read_with_its_counts(self):
        robot = {"uncrew": {"alerts": {"low-0": {}}}, "activeFaults": 2, "operatorRequestsOpen": 0}
        self.assertEqual(shown_sets(robot), (({"low-0"}, set()), (2, 0)))

    def test_the_flights_of_a_drone_publish_each_type_once(self):
        names = [name for types in dealt() for name in types]
        self.assertEqual(sorted(names), sorted((*STORED, WRONG, *UNSTORED)))
        self.assertTrue(all(set(types) & set(STORED) for types in dealt()))


if __name__ == "__main__":
    unittest.main()
