# SPDX-License-Identifier: GPL-3.0-or-later
"""Bakes a volume by workers in Kubernetes, by the operator of dask-kubernetes.

    python examples/bake_on_kubernetes.py head.nii.gz --out head.vdb --image IMAGE --workers 8

IMAGE is a container image with this Leaflight and Dask. --show prints the cluster's specification.
"""

import argparse
import json

import leaflight
from dask_kubernetes.operator import KubeCluster, make_cluster_spec
from leaflight.cluster.workers import Workers

WAIT_SECONDS = 3600  # for the first worker to start


def main():
    options = parsed()
    size = {"cpu": str(options.cores), "memory": options.memory}
    # A worker has one thread for Dask, and Leaflight uses all processors of the container.
    specification = make_cluster_spec(
        name="leaflight",
        image=options.image,
        n_workers=options.workers,
        resources={"requests": size, "limits": size},
        worker_command=["dask", "worker", "--nthreads", "1"],
    )
    if options.show:
        print(json.dumps(specification, indent=2))
        return
    volume = leaflight.read_volume(options.volume)
    with (
        KubeCluster(custom_cluster_spec=specification) as cluster,
        Workers(None, cluster.scheduler_address, WAIT_SECONDS) as workers,
    ):
        leaflight.bake(volume, error=options.error, workers=workers).save(options.out)
    print("Wrote", options.out)


def parsed():
    parser = argparse.ArgumentParser(prog="bake_on_kubernetes.py")
    parser.add_argument("volume", help="file of a volume")
    parser.add_argument("--out", default="bake.vdb", help="bake to write (bake.vdb)")
    parser.add_argument("--error", type=float, default=1.5, help="target error in percent (1.5)")
    parser.add_argument("--image", required=True, help="image of the containers")
    parser.add_argument("--workers", type=int, default=4, help="number of workers (4)")
    parser.add_argument("--cores", type=int, default=8, help="processors of a worker (8)")
    parser.add_argument("--memory", default="16Gi", help="memory of a worker (16Gi)")
    parser.add_argument("--show", action="store_true", help="print the specification only")
    return parser.parse_args()


if __name__ == "__main__":
    main()
