# SPDX-License-Identifier: GPL-3.0-or-later
"""Bakes a volume by workers that Slurm starts, by dask-jobqueue.

    python examples/bake_on_slurm.py head.nii.gz --out head.vdb --jobs 8 --queue normal

Run it where sbatch is. All machines need the same Leaflight. --show prints the script of a job.
"""

import argparse

import leaflight
from dask_jobqueue import SLURMCluster
from leaflight.cluster.workers import Workers

WAIT_SECONDS = 24 * 3600  # for the first job to start


def main():
    options = parsed()
    # A worker has one thread for Dask, and Leaflight uses all processors of the job.
    with SLURMCluster(
        cores=1,
        job_cpu=options.cores,
        memory=options.memory,
        queue=options.queue,
        walltime=options.walltime,
    ) as cluster:
        if options.show:
            print(cluster.job_script())
            return
        cluster.scale(jobs=options.jobs)
        volume = leaflight.read_volume(options.volume)
        with Workers(None, cluster.scheduler_address, WAIT_SECONDS) as workers:
            leaflight.bake(volume, error=options.error, workers=workers).save(options.out)
    print("Wrote", options.out)


def parsed():
    parser = argparse.ArgumentParser(prog="bake_on_slurm.py")
    parser.add_argument("volume", help="file of a volume")
    parser.add_argument("--out", default="bake.vdb", help="bake to write (bake.vdb)")
    parser.add_argument("--error", type=float, default=1.5, help="target error in percent (1.5)")
    parser.add_argument("--jobs", type=int, default=4, help="number of jobs, a worker each (4)")
    parser.add_argument("--cores", type=int, default=8, help="processors of a job (8)")
    parser.add_argument("--memory", default="16GB", help="memory of a job (16GB)")
    parser.add_argument("--queue", help="partition of Slurm (its default)")
    parser.add_argument("--walltime", default="04:00:00", help="time limit of a job (04:00:00)")
    parser.add_argument("--show", action="store_true", help="print the script of a job only")
    return parser.parse_args()


if __name__ == "__main__":
    main()
