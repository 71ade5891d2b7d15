# SPDX-License-Identifier: GPL-3.0-or-later
"""`leaflight report`: which of the reports, with how much work."""

from dataclasses import replace
from pathlib import Path

from .._core import LeaflightError
from .against_cycles import QUICK_CYCLES, CyclesEffort
from .experiments import QUICK, Effort
from .report import QUICK_REPORT, ReportEffort, report, report_cycles, report_tables


def run_report(options, run):
    """What the options ask for, as the result and the sentences about it.

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
        effort = QUICK_REPORT if options.quick else ReportEffort()
        effort = replace(effort, tables=replace(effort.tables, **work))
        result = report(options.out, effort, run, options.data)
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
