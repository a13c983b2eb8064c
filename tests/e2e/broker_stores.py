"""The stores of the crash campaign with a broker (broker_chaos.py): what they hold of what twins said,
and what of them is killed."""

import chaos_stores
from broker_script import ROWS, UNBALANCED, key_of_row


class Sqlite(chaos_stores.Sqlite):
    kills = {"server": 6, "connection": 3, "broker": 1, "absence": 0.5}

    def table(self, sql):
        return self.read(sql)


class Postgres(chaos_stores.Postgres):
    kills = {"server": 6, "connection": 3, "broker": 1, "absence": 0.5, "cluster": 3, "backend": 1, "backend crash": 1}

    def table(self, sql):
        lines = self.sql(f"SET search_path = uplinkd;{sql}").splitlines()
        return [line.split("|") for line in lines]


def keys(store):
    """The key of each row, in the order of the writing."""
    return [key_of_row(*row) for row in store.table(ROWS)]


def unbalanced(store):
    """Faults that lack a raise or a clear, or have one twice."""
    return [f"{ruri}: {fault}" for ruri, fault in store.table(UNBALANCED)]
