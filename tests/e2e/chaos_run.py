"""Runs a crash campaign (chaos.py; with two servers chaos_pair.py).

    chaos_run.py [--kills N] [--store sqlite|postgres] [--seed S] [--canary acks_early|unsynced]
    chaos_run.py --store postgres --servers 2 [--kills N] [--seed S]

It prints `kills, acked, stored, lost, doubled`, for two servers also what is wrong in the histories of
presence, and ends with 1 if anything is. With a canary it ends with 0 only if it reports loss.
"""

import argparse
import pathlib
import shutil
import sys
import tempfile
import time

from chaos import CANARIES, Campaign
from chaos_pair import PairCampaign


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--kills", type=int, default=25)
    parser.add_argument("--store", choices=("sqlite", "postgres"), default="sqlite")
    parser.add_argument("--servers", type=int, choices=(1, 2), default=1)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--canary", choices=sorted(CANARIES))
    arguments = parser.parse_args()
    if arguments.servers == 2 and (arguments.store != "postgres" or arguments.canary):
        parser.error("two servers need --store postgres, and take no canary")
    folder = pathlib.Path(tempfile.mkdtemp(prefix="uplink-chaos."))
    began = time.monotonic()
    if arguments.servers == 2:
        campaign = PairCampaign(folder, arguments.seed)
    else:
        campaign = Campaign(folder, arguments.store, arguments.seed, arguments.canary)
    try:
        clean = campaign.run(arguments.kills, sys.stderr)
    finally:
        campaign.close()
    print(campaign.line())
    print(f"{arguments.store}, seed {arguments.seed}, {time.monotonic() - began:.0f} s", file=sys.stderr)
    for line in campaign.wrong[:20]:
        print(line)
    if arguments.canary:
        print("the canary was found" if campaign.lost else "the canary was NOT found")
        clean = campaign.lost > 0
    if clean:
        shutil.rmtree(folder)
    else:
        print(f"kept: {folder}", file=sys.stderr)
    return 0 if clean else 1


if __name__ == "__main__":
    sys.exit(main())
