"""The command ``floquet-charts``: one word chooses what is done; what follows it belongs to that command."""

from __future__ import annotations

import sys
from importlib import import_module

from floquet_charts import __version__

COMMANDS = {
    "validate": "judge theory against integration, for the paper's figures or a system of yours; a report",
    "explore": "draw the chart of a plate or a system in any window, trace its regions, look at it in a browser",
    "modes": "show how a system moves at one point: frequencies, growth, damping, harmonics",
    "gallery": "compute twenty-one charts that are published or exactly known, and compare their numbers",
    "certify": "prove that one point is stable or unstable, in ball arithmetic",
}
HELP = f"""\
usage: floquet-charts COMMAND [options]

Stability charts of periodically excited systems, by theory and by integration, laid one over the other.

commands:
{"".join(f"  {name:<10}{what}" + chr(10) for name, what in COMMANDS.items())}
  floquet-charts COMMAND --help   the options of a command, with examples
  floquet-charts --version        {__version__}

first steps:
  floquet-charts explore --no-regions           a plate under a pulsating load: its chart, in the folder output/
  floquet-charts validate --case fig2 --quick   a figure of the paper, with a verdict for each of its regions
  floquet-charts modes --at 18.6,0.3            how that plate moves at Omega = 18.6, eps = 0.3
  floquet-charts explore --system mine.npz      a system of yours, from its matrices M, C, K and K1c

In Python: import floquet_charts as fc; help(fc) shows ten lines that run.
"""


def main(arguments: list[str] | None = None) -> int:
    """Run a command and return its exit status: 2 if there is no such command, otherwise the command's own."""
    command, *rest = (sys.argv[1:] if arguments is None else arguments) or ["--help"]
    if command in ("-h", "--help"):
        print(HELP, end="")
        return 0
    if command == "--version":
        print(f"floquet-charts {__version__}")
        return 0
    if command in COMMANDS:
        return int(import_module(f"floquet_scripts.{command}").main(rest))
    from compare.files import did_you_mean

    suggestion = did_you_mean(command, COMMANDS)
    print(f"floquet-charts: no command {command!r}; give one of {', '.join(COMMANDS)}{suggestion}", file=sys.stderr)
    return 2


if __name__ == "__main__":
    sys.exit(main())
