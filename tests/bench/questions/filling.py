"""Rows of a fleet's months, written into a migrated store by SQL alone: the same in SQLite and PostgreSQL."""

import re
import sqlite3
import time

DAY_MS = 86_400_000
# Days that the rows spread over, and the most that one call makes of PostgreSQL's partitions.
DAYS = 90
DAYS_A_CALL = 30
FLEETS = 20
# Rows of each table, of a million in all histories.
SHARES = {
    "events": 350_000,
    "connections": 40_000,
    "scope_updates": 10_000,
    "messages": 200_000,
    "mission_reports": 120_000,
    "faults_history": 100_000,
    "presence_changes": 100_000,
    "quarantine": 40_000,
    "gaps": 20_000,
    "mission_runs": 12_000,
    "faults_active": 2_000,
}  # fmt: skip
# Columns by table, each with its value in row `i`; {at} is when it arrived, in the store's form.
COLUMNS = {
    "events": "received_at={at} session={id} seq=i sampled_ms=0 kind='kind'||(i%40) detail='{{}}'",
    "messages": "received_at={at} session={id} seq=i sampled_ms=0 level=(CASE WHEN i%50=0 THEN 1+i/50%2 ELSE 0 END) "
    "message='the_wheel_slipped_on_a_wet_floor' detail=''",
    "mission_reports": "received_at={at} session={id} seq=i mission_id='mission'||(i%500) run_id='run'||(i/10) "
    "status=i%6 report='{{}}'",
    "faults_history": "received_at={at} session={id} seq=i sampled_ms=0 fault_id='fault'||(i%300) source='drive'||(i%30) "
    "severity=(CASE WHEN i%1000=0 THEN 3 ELSE i%3 END) active={true} category='drive' description='slip' "
    "suggested_action=''",
    "presence_changes": "changed_at={at} presence=1+i%2",
    "connections": "id={number} began_at={at} source=i%2 process={id} server='bench' address='192.0.2.1:5000' gateway='' "
    "agent_version='1.0' certificate_serial='01' certificate_sha256='' certificate_key_sha256='' "
    "certificate_not_after=NULL messages=i bytes=i takeovers=0 held_back_ms=0 held_back_why='' is_open={false} "
    "ended_at={at} ended_why=i%10 ended_code='' ended_detail=''",
    "scope_updates": "received_at={at} session={id} seq=i sampled_ms=0 scope=1+i%2 id='00000000-0000-4000-8000-00000000000'||(i%10) type='kind' "
    "detail='{{}}'",
    "quarantine": "received_at={at} session={id} seq=i reason=(CASE WHEN i%1000=0 THEN 3 ELSE 1+i%2 END) field='speed' "
    "detail='is_not_finite' payload_bytes=3 payload=NULL source=0 topic=''",
    "gaps": "seen_at={at} session={id} first=i last=i+2",
    "mission_runs": "first_at={at} last_at={at} mission_id='mission'||(i%500) run_id='run'||i name='clean' status=i%6 "
    "is_open={open} updates=3 latest='{{}}' last_entry=i closed_why=0 closed_at={never}",
    "faults_active": "raised_at={at} received_at={at} fault_id='fault'||(i%300) source='drive'||i sampled_ms=0 "
    "severity=(CASE WHEN i%1000=0 THEN 3 ELSE i%3 END) category='drive' description='slip' suggested_action=''",
}  # fmt: skip
# What differs between the stores.
SQLITE = {
    "id": "x'00112233445566778899aabbccddeeff'",
    "number": "CAST(printf('%016d',i) AS BLOB)",
    "true": "1",
    "false": "0",
    "open": "i%100=0",
    "never": "0",
}
POSTGRES = {
    "id": "'00112233-4455-6677-8899-aabbccddeeff'::uuid",
    "number": "lpad(i::text,32,'0')::uuid",
    "true": "true",
    "false": "false",
    "open": "i%100=0",
    "never": "'epoch'::timestamptz",
}
RURI = "'rcan://bench.example/acme/rover/r'||{number}"


def ruri(number):
    return f"rcan://bench.example/acme/rover/r{number}"


def inserts(rows, robots, now_ms, form, at, series):
    """The statements, each with its table; `rows` in all."""
    first = 1
    for table, share in SHARES.items():
        count = max(share * rows // 1_000_000, 1)
        when = at.format(ms=f"({now_ms} - {DAYS * DAY_MS} + i * {DAYS * DAY_MS // count})")
        values = COLUMNS[table].format(at=when.replace(" ", ""), **form)
        # A column begins with its name; its value may have spaces.
        pairs = [pair.split("=", 1) for pair in re.split(r" (?=\w+=)", values)]
        names = ["ruri", "fleet", "entry", *(name for name, _ in pairs)]
        who = RURI.format(number=f"(i % {robots})")
        what = [who, f"'fleet'||(i % {robots} % {FLEETS})", f"{first} + i", *(value for _, value in pairs)]
        yield table, f"INSERT INTO {table} ({','.join(names)}) SELECT {','.join(what)} FROM {series(count)}"
        first += count + 1
    yield "next", first


def fill_sqlite(path, rows, robots):
    """While no server runs."""
    now_ms = time.time_ns() // 1_000_000

    def series(count):
        return f"(WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < {count}) SELECT i FROM n)"

    store = sqlite3.connect(path, isolation_level=None)
    try:
        store.execute("PRAGMA synchronous = OFF")
        store.execute("BEGIN")
        for table, text in inserts(rows, robots, now_ms, SQLITE, "{ms}", series):
            if table == "next":
                store.execute("UPDATE entries SET next_entry = ?", (text + 1,))
            else:
                store.execute(text)
        store.execute(
            f"INSERT INTO robots SELECT {RURI.format(number='(i - 1)')}, 'fleet'||((i - 1) % {FLEETS}), i, i,"
            f" x'00', {now_ms}, {now_ms}, 1 FROM {series(robots)}"
        )
        store.execute(f"UPDATE epochs SET last = {robots + 1}")
        store.execute(
            "INSERT INTO presence_latest (ruri, presence, changed_at)"
            f" SELECT {RURI.format(number='(i - 1)')}, 2, {now_ms} FROM {series(robots)}"
        )
        store.execute("COMMIT")
        store.execute("ANALYZE")
    finally:
        store.close()


def fill_postgres(cluster, rows, robots):
    """While no server runs."""
    now_ms = time.time_ns() // 1_000_000

    def series(count):
        return f"generate_series(1, {count}::bigint) AS n(i)"

    def run(text):
        cluster.sql("SET search_path = uplinkd; SET synchronous_commit = off; " + text)

    for day in range(-DAYS, 1, DAYS_A_CALL):
        run(f"SELECT make_partitions((now() AT TIME ZONE 'UTC')::date + {day}, {DAYS_A_CALL})")
    for table, text in inserts(rows, robots, now_ms, POSTGRES, "to_timestamp({ms}/1000.0)", series):
        if table == "next":
            # Entries come from numbers of batches.
            run(f"SELECT setval('batches', {text + 1})")
        else:
            run(text)
    run(
        f"INSERT INTO robots SELECT {RURI.format(number='(i - 1)')}, 'fleet'||((i - 1) % {FLEETS}), i, i,"
        f" gen_random_uuid(), now(), now(), true FROM {series(robots)}"
    )
    run(f"SELECT setval('epochs', {robots + 1})")
    run(
        "INSERT INTO presence_latest (ruri, presence, changed_at)"
        f" SELECT {RURI.format(number='(i - 1)')}, 2, now() FROM {series(robots)}"
    )
    run("ANALYZE")
