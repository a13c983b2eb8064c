"""Runs a crash campaign (chaos.py; with two servers chaos_pair.py; with a broker broker_chaos.py and
broker_chaos_pair.py; with drones uncrew_chaos.py).

    chaos_run.py [--kills N] [--store sqlite|postgres] [--seed S] [--canary acks_early|unsynced]
    chaos_run.py --store postgres --servers 2 [--kills N] [--seed S]
    chaos_run.py --cyberwave [--kills N] [--store sqlite|postgres] [--servers 1|2] [--seed S]
                 [--canary acks_on_arrival|forgets_deliveries]
    chaos_run.py --uncrew [--kills N] [--store sqlite|postgres] [--servers 1|2] [--seed S]
                 [--canary answers_early|forgets_samples]
    chaos_run.py --failovers N [--seed S] [--canary trusts_reconnect]

With --failovers (failovers.py) it kills a PostgreSQL primary each time, and promotes a standby that lags.

It prints `kills, acked, stored, lost, doubled`, for two servers also what is wrong in the histories of
presence, and ends with 1 if anything is. With a broker also what is out of order; with a broker and with drones
how long each kind of kill took until messages were stored again. With a canary it ends with 0 only if it finds it.
"""

import argparse
import pathlib
import shutil
import sys
import tempfile
import time

import broker_chaos
import broker_chaos_pair
import chaos
import chaos_pair
import failovers
import uncrew_chaos

ONE = {None: chaos.Campaign, "cyberwave": broker_chaos.BrokerCampaign, "uncrew": uncrew_chaos.UncrewCampaign}
TWO = {None: chaos_pair.PairCampaign, "cyberwave": broker_chaos_pair.PairCampaign, "uncrew": uncrew_chaos.PairCampaign}
CANARIES = {None: chaos.CANARIES, "cyberwave": broker_chaos.CANARIES, "uncrew": uncrew_chaos.CANARIES}


def parse():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    source = parser.add_mutually_exclusive_group()
    for name in filter(None, ONE):
        source.add_argument(f"--{name}", dest="source", action="store_const", const=name)
    parser.add_argument("--kills", type=int, default=25)
    parser.add_argument("--store", choices=("sqlite", "postgres"))
    parser.add_argument("--servers", type=int, choices=(1, 2), default=1)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--failovers", type=int)
    parser.add_argument("--canary", choices=sorted({failovers.CANARY}.union(*CANARIES.values())))
    arguments = parser.parse_args()
    canaries = CANARIES[arguments.source]
    if arguments.failovers:
        canaries = [failovers.CANARY]
        arguments.store = "postgres"
    if arguments.canary not in (None, *canaries):
        parser.error(f"the canaries of this campaign are {', '.join(sorted(canaries))}")
    if arguments.servers == 2 and (arguments.store != "postgres" or arguments.canary):
        parser.error("two servers need --store postgres, and take no canary")
    arguments.store = arguments.store or "sqlite"
    return arguments


def campaign_of(arguments, folder):
    if arguments.failovers:
        return failovers.FailoverCampaign(folder, arguments.seed, arguments.canary)
    if arguments.servers == 2:
        return TWO[arguments.source](folder, arguments.seed)
    return ONE[arguments.source](folder, arguments.store, arguments.seed, arguments.canary)


def main():
    arguments = parse()
    folder = pathlib.Path(tempfile.mkdtemp(prefix="uplink-chaos."))
    began = time.monotonic()
    campaign = campaign_of(arguments, folder)
    try:
        clean = campaign.run(arguments.failovers or arguments.kills, sys.stderr)
    except AssertionError:
        print(f"kept: {folder}", file=sys.stderr)
        raise
    finally:
        campaign.close()
    print(campaign.line())
    print(f"{arguments.store}, seed {arguments.seed}, {time.monotonic() - began:.0f} s", file=sys.stderr)
    for line in (*campaign.wrong[:20], *campaign.recovery_lines()):
        print(line)
    if arguments.canary:
        print("the canary was found" if campaign.canary_found() else "the canary was NOT found")
        clean = campaign.canary_found()
    if clean:
        shutil.rmtree(folder)
    else:
        print(f"kept: {folder}", file=sys.stderr)
    return 0 if clean else 1


if __name__ == "__main__":
    sys.exit(main())
