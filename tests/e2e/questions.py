"""Every question of a fleet's day and bad night: one request, one command. Printed, it is docs/operate/questions.md.

What stands in braces is a fact of the fleet that is asked; EXAMPLES has it in the page, a test has its own.
"""

import dataclasses

EXAMPLES = {
    "server": "http://127.0.0.1:7480",
    "name": "r17",
    "ruri": "rcan%3A%2F%2Facme.example%2Famr%2Fhauler%2Fr17",
    "fleet": "north",
    "percent": "20",
    "box": "8.1,47.2,8.2,47.3",
    "fault": "brake.worn",
    "status": "error",
    "run": "run-4711",
    "reason": "out_of_range",
    "software": "2.1.0",
    "since": "2026-05-01T22:00:00Z",
    "later": "2026-05-15T00:00:00Z",
    "within": "14d",
}
TITLE = "Questions of a day and a night"


@dataclasses.dataclass(frozen=True)
class Question:
    """`path` below /api/v1, `command` after uplinkctl. `note`: where the answer may be incomplete."""

    ask: str
    path: str
    command: str
    note: str = ""


GROUPS = {
    "Where is a robot, and how is it?": (
        Question("Where is the robot that people call {name}?", "robots?q={name}&parts=motion", "robots get {name}"),
        Question(
            "Which robots are in this area?", "robots?bbox={box}&parts=none", "robots list --bbox {box}",
            "Robots that say their place in a frame of their own (`position.frame` is `local`) match no area.",
        ),
        Question(
            "Whose battery is below {percent} %?",
            "robots?batteryBelow={percent}&orderBy=battery&parts=none",
            "robots list --battery-below {percent} --order-by battery",
            "`unjudged` counts robots at other servers whose value is not known here.",
        ),
        Question("Which robots run version {software}?", "robots?software={software}&parts=none", "robots list --software {software}"),
        Question("Which fleets are there, with which versions?", "fleets", "fleets list"),
    ),
    "Who is missing, and why?": (
        Question(
            "Who is offline, and since when?", "robots?presence=offline&parts=none", "robots list --presence offline",
            "After a start robots are `unknown` until they are heard, or `presence.timeout` has passed.",
        ),
        Question("Why did {name} drop?", "robot/story?ruri={ruri}&from={since}", "robots story {name} --since {since}"),
        Question(
            "Who came and went since then?", "presence?fleet={fleet}&from={since}",
            "presence list --fleet {fleet} --since {since}",
            "`why` is empty where the connection still stood, or ended at another server.",
        ),
        Question(
            "Who is connected, from where, with which certificate?", "connections?open=true&fleet={fleet}",
            "connections list --open --fleet {fleet}",
        ),
        Question(
            "Whose certificate expires soon?", "robots?certificateExpiresBefore={later}&parts=none",
            "robots list --certificate-expires-within {within}",
            "Robots that are connected to this server; `unjudged` counts those of others.",
        ),
    ),
    "What is wrong?": (
        Question(
            "Which critical faults are active now?", "faults?active=true&severity=critical",
            "faults list --severity critical",
        ),
        Question(
            "What is the history of one fault?", "faults?faultId={fault}&ruri={ruri}",
            "faults list --history --robot {name} --fault-id {fault}",
        ),
        Question(
            "Which missions that began since then are or ended {status}?", "missions?status={status}&from={since}",
            "missions list --status {status} --since {since}",
        ),
        Question("What did one run report?", "mission-reports?runId={run}", "missions show {run}"),
        Question(
            "What was rejected as {reason}?", "quarantine?reason={reason}", "quarantine list --reason {reason}",
            "Each robot keeps 10,000 rows; `droppedByReason` counts what is gone.",
        ),
        Question(
            "What happened in the fleet since then?", "events?fleet={fleet}&from={since}",
            "events list --fleet {fleet} --since {since}",
        ),
    ),
    "Who is behind, who is loud?": (
        Question(
            "How far behind are agents, and are their clocks right?", "robots?orderBy=-backlog&parts=none",
            "robots list --order-by=-backlog",
            "`backlog` is absent where the agent does not say it; `clockSkewMs` is in the JSON.",
        ),
        Question("Who sends most?", "top?by=messages", "robots top --by messages", "Only robots that send to this server."),
        Question("Whom does the server not read now, and why?", "robots?heldBack=true&parts=none", "robots list --held-back"),
    ),
}  # fmt: skip


def page():
    """The page that operators read."""
    lines = [
        f"# {TITLE}", "",
        "Each is one request and one command. `uplinkctl` asks the server of your context, and prints JSON or CSV with"
        " `-o`. Every list pages ([HTTP](../reference/http.md#how-do-i-page-through-a-list)).", "",
    ]  # fmt: skip
    for group, questions in GROUPS.items():
        lines += [f"## {group}", ""]
        for question in questions:
            lines += [question.ask.format(**EXAMPLES), "", "```"]
            lines += [f"uplinkctl {question.command}".format(**EXAMPLES)]
            lines += [f"curl -s '{{server}}/api/v1/{question.path}'".format(**EXAMPLES), "```", ""]
            lines += [question.note, ""] if question.note else []
    return "\n".join(lines)


if __name__ == "__main__":
    print(page(), end="")
