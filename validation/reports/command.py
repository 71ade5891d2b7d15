# SPDX-License-Identifier: GPL-3.0-or-later
"""validation/report: which of the reports, with how much work."""

from dataclasses import replace
from pathlib import Path

from leaflight._core import LeaflightError
from leaflight.progress_bar import run_with_progress
from leaflight_command.shared_options import Parser, threads_options
from .against_cycles import QUICK_CYCLES, CyclesEffort
from .experiments import QUICK, Effort
from .report import QUICK_REPORT, ReportEffort, report, report_cycles, report_tables


def make_parser():
    parser = Parser(
        prog="report",
        parents=[threads_options()],
        description="Measures errors and seconds, and writes a report of them.",
    )
    alone = parser.add_mutually_exclusive_group()
    alone.add_argument(
        "--tables", action="store_true", help="Tables 3.1 and 4.2 and Fig. 4.9 of the thesis alone"
    )
    alone.add_argument("--cycles", action="store_true", help="bakes against Cycles alone")
    parser.add_argument(
        "--quick", action="store_true", help="less of everything: ten minutes, not hours"
    )
    parser.add_argument(
        "--out", default="report", metavar="DIR", help="folder to write into (report)"
    )
    parser.add_argument(
        "--data", metavar="DIR", help="folder of real data sets, which are left out without it"
    )
    parser.finish()
    return parser


def run_report(options, run=run_with_progress):
    """Runs the report that the options describe; returns its result and the sentences about it.

    run: called as run(work, label), which returns work(progress). Raises LeaflightError, Cancelled.
    """
    work = {"seed": options.seed, "threads": options.threads}
    if options.tables:
        if options.data is not None:
            raise LeaflightError("report: --data has no meaning with --tables; leave one out.")
        effort = replace(QUICK if options.quick else Effort(), **work)
        result = report_tables(options.out, effort, run)
        written = "tables.md"
    elif options.cycles:
        _check_folder(options.data)
        effort = QUICK_CYCLES if options.quick else CyclesEffort()
        result = report_cycles(options.out, effort, run, options.data, **work)
        written = "cycles.md"
    else:
        _check_folder(options.data)
        chosen = QUICK_REPORT if options.quick else ReportEffort()
        chosen = replace(chosen, tables=replace(chosen.tables, **work))
        result = report(options.out, chosen, run, options.data)
        written = "report.md"
    return result, [
        *(
            f"{row['data set']}: {row['RMS %']:.2f} %, {row['bake s']:.1f} s"
            for row in result.get("data_sets", [])
        ),
        *(
            f"{row['bake']} at {row['isovalue']:g} against Cycles: {row['RMS %']:.2f} %"
            + (f": {row['verdict']}" if row["verdict"] else "")
            for row in result.get("against_cycles", [])
        ),
        *(
            f"{row['table']}, {row['strategy']}: {row['ours']:.2f} %"
            + (f", thesis {row['printed']:g} %" if row["printed"] else "")
            + f" ({row['verdict']})"
            for row in result["rows"]
        ),
        f"{Path(options.out) / written}: "
        + ("all as it must be" if result["passed"] else "some errors are not what they must be"),
    ]


def _check_folder(data):
    if data is not None and not Path(data).is_dir():
        raise LeaflightError(f"{data}: there is no such folder; give that of the data sets.")
